#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace sulcus {

/// Bytes as letters [RFC 4648], padded, without line breaks.
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace sulcus
