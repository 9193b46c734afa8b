#pragma once

#include <string>
#include <vector>

namespace sulcus {

/// The slices of a folder, the first first.
struct SliceOrder {
  std::vector<std::string> files;
  std::vector<std::string> warnings;  // numbers that are absent; names that do not say an order
};

/// Puts `files` in the order of the number in which their names differ, which may be a decimal one:
/// slice_9 before slice_10, slice_0.25 before slice_0.5. Names that differ in no number go by their
/// letters.
/// @throws InputError: the same number twice, names that differ beside their numbers.
SliceOrder slice_order(const std::string& folder, std::vector<std::string> files);

}  // namespace sulcus
