#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "app/session/feed.hpp"

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

/// What a chart of a run shows of a tick, and where the tool was in it.
struct ChartPoint {
  double time_s = 0.0;
  std::array<float, 3> force_N{}, torque_mNm{};  // world axes
  float tick_us = 0.0f, spindle_krpm = 0.0f;
  std::uint32_t contacts = 0;
  std::array<float, 3> tip_m{}, axis{};  // world; the axis from tip to shank, unit
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

/// What a summary and a chart need of all ticks; of a long run no more memory than of a short one.
struct RunStatistics {
  std::uint64_t ticks = 0;
  Distribution tick_us, late_us;
  std::array<Distribution, kStageCount> stage_us;
  Distribution force_N, torque_mNm;  // magnitudes
  double force_in_contact_sum_N = 0.0;
  std::uint64_t ticks_in_contact = 0;
  double contacts_sum = 0.0;
  std::uint32_t contacts_max = 0;
  ChartSeries chart;
  double leaves_sum = 0.0, tested_sum = 0.0;
  std::uint32_t leaves_max = 0, tested_max = 0;
  double force_step_max_N = 0.0;
  double commanded_force_sum_N = 0.0, commanded_force_max_N = 0.0;  // before the device's limits
  double commanded_step_max_N = 0.0;
  double evaluations_sum = 0.0;  // of the contact, in a tick
  std::uint64_t evaluations_max = 0;
  std::uint64_t removed = 0;
  std::array<std::uint64_t, 32> faults{};  // ticks with each bit
  std::uint64_t force_hash = 0;            // over all forces and torques, in order

  void add(const TickReport& report);
  /// Ticks with a fault.
  std::uint64_t fault_ticks(Fault fault) const { return faults[std::countr_zero(+fault)]; }

 private:
  double last_force_[3]{}, last_commanded_[3]{};
};

}  // namespace sulcus
