#pragma once

#include <array>
#include <cstddef>

namespace sulcus {

/// N sums over a sequence, in a fixed order: term i goes to virtual lane i mod 16, and the lanes
/// are added pairwise at the end. A kernel of 4, 8 or 16 lanes adds in the same order, so the sums
/// have the same bits whichever was chosen.
template <std::size_t N>
class LaneSums {
 public:
  static constexpr std::size_t kLanes = 16;

  /// Starts the next term; its parts are then added with `add`.
  void next() noexcept { lane_ = (lane_ + 1) % kLanes; }
  void add(std::size_t quantity, double value) noexcept { sums_[lane_][quantity] += value; }

  std::array<double, N> total() const noexcept {
    auto lanes = sums_;
    for (std::size_t width = kLanes / 2; width > 0; width /= 2) {
      for (std::size_t lane = 0; lane < width; ++lane) {
        for (std::size_t q = 0; q < N; ++q) lanes[lane][q] += lanes[lane + width][q];
      }
    }
    return lanes[0];
  }

 private:
  std::array<std::array<double, N>, kLanes> sums_{};
  std::size_t lane_ = kLanes - 1;
};

}  // namespace sulcus
