#pragma once

#include <cstdint>
#include <vector>

namespace sulcus {

/// Values of 0 and above, counted in bins of 0.8 % of the value: however long a run is, it takes no
/// more memory. Sum and largest are exact.
class Distribution {
 public:
  Distribution() : bins_(kBins) {}

  /// A negative value counts as 0, one that is not finite as the largest float.
  void add(float value) noexcept;

  std::uint64_t count() const { return count_; }
  double sum() const { return sum_; }
  double largest() const { return largest_; }
  /// 0 of none.
  double mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : 0.0; }
  /// The value that a part (0 to 1) of the values does not exceed, to half a bin; 0 of none.
  double quantile(double part) const;

 private:
  static constexpr unsigned kShift = 16;  // of a float's bits: 7 of its fraction are left
  static constexpr std::size_t kBins = std::size_t{1} << (31 - kShift);

  std::vector<std::uint32_t> bins_;
  std::uint64_t count_ = 0;
  double sum_ = 0.0, largest_ = 0.0;
};

}  // namespace sulcus
