#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "app/report/chart_series.hpp"
#include "app/report/distribution.hpp"
#include "app/session/feed.hpp"

namespace sulcus {

/// What a summary and a chart need of all ticks; of a long run no more memory than of a short one.
struct RunStatistics {
  std::uint64_t ticks = 0;
  Distribution tick_us, late_us;
  std::array<Distribution, kStageCount> stage_us;
  Distribution force_N, torque_mNm;  // magnitudes
  double contacts_sum = 0.0;
  std::uint32_t contacts_max = 0;
  ChartSeries chart;
  double leaves_sum = 0.0, tested_sum = 0.0;
  std::uint32_t leaves_max = 0, tested_max = 0;
  double force_step_max_N = 0.0;
  double asked_force_sum_N = 0.0, asked_force_max_N = 0.0;  // before the device's limits
  double asked_step_max_N = 0.0;
  double evaluations_sum = 0.0;  // of the contact, in a tick
  std::uint64_t evaluations_max = 0;
  std::uint64_t removed = 0;
  std::array<std::uint64_t, 32> faults{};  // ticks with each bit
  std::uint64_t force_hash = 0;            // over all forces and torques, in order

  void add(const TickReport& report);
  /// Ticks with a fault.
  std::uint64_t fault_ticks(Fault fault) const { return faults[std::countr_zero(+fault)]; }

 private:
  double last_force_[3]{}, last_asked_[3]{};
};

}  // namespace sulcus
