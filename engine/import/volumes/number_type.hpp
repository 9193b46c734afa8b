#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace sulcus {

/// How a file stores a number.
struct NumberType {
  enum class Kind : std::uint8_t { kUnsigned, kSigned, kFloat };

  Kind kind = Kind::kUnsigned;
  std::size_t bytes = 1;  // 1, 2, 4 or 8; of a float 4 or 8

  bool operator==(const NumberType&) const = default;
};

/// Numbers of a file as grey values. `stored` holds `values.size() * type.bytes` bytes.
void to_floats(std::span<const std::byte> stored, NumberType type, bool big_endian,
               std::span<float> values);

}  // namespace sulcus
