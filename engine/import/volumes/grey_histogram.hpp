#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sulcus {

/// How often grey values occur, in bins of one width. Bin i is [low + i width, low + (i + 1)
/// width); what lies beyond the first or the last bin is counted in it.
struct GreyHistogram {
  double low = 0.0, width = 1.0;
  std::vector<std::uint64_t> counts;

  double edge(std::size_t i) const { return low + static_cast<double>(i) * width; }
  std::uint64_t total() const;
  /// The value below which that part (0 to 1) of the voxels lies, to a bin.
  double quantile(double part) const;
  /// The variance that is left within the classes that `thresholds` (rising) part it into.
  double variance_within(std::span<const double> thresholds) const;
};

/// `bins` of the finite `values`, over the range that all but one in 2,000 at either end lie in: a
/// metal filling does not squeeze the teeth into three bins. Where all values are whole numbers the
/// bins hold as many of them each, so that none is empty for that alone. No values: no bins.
GreyHistogram grey_histogram(std::span<const float> values, int bins = 256);

/// The `count` values that part the histogram into classes of the least variance within
/// [Otsu 1979], by ITK, rising: a class begins at or above its value, and where bins between two
/// classes are empty, in their middle. Fewer, or none, where there
/// are not as many values to tell apart.
std::vector<double> otsu_thresholds(const GreyHistogram& histogram, int count);

/// Whether there are three classes, air, dentine and enamel, or only two, of which the third
/// threshold would split one: a normal distribution that is split has 36 % of its variance left (1
/// - 2 / pi), so three that are there leave less than that of what two leave.
bool has_three_classes(const GreyHistogram& histogram, std::span<const double> two,
                       std::span<const double> three);

/// Voxels of one whole-number value.
struct LabelCount {
  int value = 0;
  std::uint64_t voxels = 0;
  int low[3] = {0, 0, 0}, high[3] = {0, 0, 0};  // box of voxel indices, both inside
  double middle[3] = {0.0, 0.0, 0.0};           // mean of voxel indices
};

/// What a mask or a label map holds, by value; empty where the values are not whole, or are more
/// than `most` different ones: grey values then.
std::vector<LabelCount> label_counts(std::span<const float> values, const int (&sizes)[3],
                                     std::size_t most = 32);

}  // namespace sulcus
