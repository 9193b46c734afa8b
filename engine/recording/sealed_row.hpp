#pragma once

#include <cstddef>

#include "engine/core/hash.hpp"

namespace sulcus {

/// A row of a recording whose last field, `check`, guards the bytes before it.
template <class Row>
concept SealedRow = requires(Row row) {
  row.check;
};

/// XXH3-64 of the bytes before `check`; the low half of it where `check` has 32 bits.
template <SealedRow Row>
auto check_of(const Row& row) {
  return static_cast<decltype(row.check)>(hash_bytes(&row, offsetof(Row, check)));
}

/// Sets `check`.
template <SealedRow Row>
void seal(Row& row) {
  row.check = check_of(row);
}

/// The row with its `check` set.
template <SealedRow Row>
Row sealed(Row row) {
  seal(row);
  return row;
}

/// Whether `check` fits the row.
template <SealedRow Row>
bool is_sealed(const Row& row) {
  return row.check == check_of(row);
}

}  // namespace sulcus
