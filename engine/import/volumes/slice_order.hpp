#pragma once

#include <span>
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
/// letters. v1.9 comes before v1.10 where both are of a row in even steps.
/// @throws InputError: the same number twice, names that differ beside their numbers, dots that may
/// mean two things.
SliceOrder slice_order(const std::string& folder, std::vector<std::string> files);

/// What a slice goes by: its number, how that is written, and its file.
struct SliceNumber {
  double value = 0.0;
  std::string text, name;
};

/// Warns of each step between `slices`, whose numbers rise, that is larger than the least.
void warn_of_gaps(std::span<const SliceNumber> slices, std::vector<std::string>& warnings);

}  // namespace sulcus
