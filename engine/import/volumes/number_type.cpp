#include "engine/import/volumes/number_type.hpp"

#include <bit>
#include <cstring>

namespace sulcus {
namespace {

template <class Word>
Word swapped(Word word) {
  if constexpr (sizeof(Word) == 2) return __builtin_bswap16(word);
  if constexpr (sizeof(Word) == 4) return __builtin_bswap32(word);
  if constexpr (sizeof(Word) == 8) return __builtin_bswap64(word);
  return word;
}

template <class Number, class Word>
void convert(std::span<const std::byte> stored, bool swap, std::span<float> values) {
  const std::byte* from = stored.data();
  for (float& value : values) {
    Word word;
    std::memcpy(&word, from, sizeof word);
    from += sizeof word;
    value = static_cast<float>(std::bit_cast<Number>(swap ? swapped(word) : word));
  }
}

}  // namespace

void to_floats(std::span<const std::byte> stored, NumberType type, bool big_endian,
               std::span<float> values) {
  static_assert(std::endian::native == std::endian::little);
  using Kind = NumberType::Kind;
  if (type.kind == Kind::kFloat) {
    return type.bytes == 4 ? convert<float, std::uint32_t>(stored, big_endian, values)
                           : convert<double, std::uint64_t>(stored, big_endian, values);
  }
  const bool is_signed = type.kind == Kind::kSigned;
  switch (type.bytes) {
    case 1:
      return is_signed ? convert<std::int8_t, std::uint8_t>(stored, false, values)
                       : convert<std::uint8_t, std::uint8_t>(stored, false, values);
    case 2:
      return is_signed ? convert<std::int16_t, std::uint16_t>(stored, big_endian, values)
                       : convert<std::uint16_t, std::uint16_t>(stored, big_endian, values);
    case 4:
      return is_signed ? convert<std::int32_t, std::uint32_t>(stored, big_endian, values)
                       : convert<std::uint32_t, std::uint32_t>(stored, big_endian, values);
    default:
      return is_signed ? convert<std::int64_t, std::uint64_t>(stored, big_endian, values)
                       : convert<std::uint64_t, std::uint64_t>(stored, big_endian, values);
  }
}

}  // namespace sulcus
