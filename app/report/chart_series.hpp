#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sulcus {

/// What a chart of a run shows of a tick.
struct ChartPoint {
  std::uint64_t tick = 0;
  float force_N = 0.0f, torque_mNm = 0.0f, tick_us = 0.0f;
  std::uint32_t contacts = 0;
};

/// Every n-th tick, n growing with the run, so that there are never more than a chart can show.
class ChartSeries {
 public:
  void add(const ChartPoint& point) {
    if (added_++ % stride_ != 0) return;
    points_.push_back(point);
    if (points_.size() < kMost) return;
    for (std::size_t i = 0; 2 * i < points_.size(); ++i) points_[i] = points_[2 * i];
    points_.resize(points_.size() / 2);
    stride_ *= 2;
  }
  const std::vector<ChartPoint>& points() const { return points_; }

 private:
  static constexpr std::size_t kMost = 40000;  // even; a chart is 1200 pixels wide

  std::vector<ChartPoint> points_;
  std::uint64_t added_ = 0, stride_ = 1;
};

}  // namespace sulcus
