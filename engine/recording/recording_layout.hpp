#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace sulcus {

// All that a recording holds, once: the types of its rows are made from here
// (recording_format.cpp), `sulcus help recording` prints it, and a test compares it with recordings
// that were written.

/// How a value is stored, little-endian.
enum class StoredType : std::uint8_t { kU8, kU16, kU32, kU64, kF32, kF64, kText };

struct StoredField {
  std::string_view name;  // of the column or the attribute; empty: the values of an array
  StoredType type;
  std::size_t count;      // of such values in it
  std::string_view unit;  // empty: none
  std::string_view what;
};

enum class StoredKind : std::uint8_t {
  kRows,   // a data set of one dimension, of packed compounds; each field is a column
  kRow,    // one such compound
  kArray,  // a data set of numbers, one field; of `count` > 1 each row has so many
  kGroup,  // a group; the fields are its attributes
};

struct StoredPart {
  std::string_view path;  // "/ticks"; "/bodies/0" stands for every one of /bodies
  StoredKind kind;
  std::string_view when;  // in which recordings; empty: in all
  std::string_view what;
  std::span<const StoredField> fields;
  std::string_view like;  // a group whose attributes and data sets it has as well
};

/// In the order in which it is explained; what lies in a group follows it.
std::span<const StoredPart> recording_layout() noexcept;

/// Null: there is none of that path.
const StoredPart* find_stored_part(std::string_view path) noexcept;

/// Bytes of one value.
std::size_t bytes_of(StoredType type) noexcept;

}  // namespace sulcus
