#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <xxhash.h>

namespace sulcus {

/// XXH3-64 of `bytes` bytes.
inline std::uint64_t hash_bytes(const void* data, std::size_t bytes, std::uint64_t seed = 0) {
  return XXH3_64bits_withSeed(data, bytes, seed);
}

/// 16 lower-case hexadecimal digits, as hashes stand in summaries.
std::string hex(std::uint64_t hash);

/// SHA-256 of a text, 64 hexadecimal digits: what `scene_sha256` holds.
std::string sha256_hex(const std::string& text);

}  // namespace sulcus
