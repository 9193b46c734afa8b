#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "app/feed.hpp"

namespace sulcus {

/// What a summary and a chart need of every tick.
struct RunStatistics {
  std::vector<float> tick_us, late_us;
  std::array<std::vector<float>, kStageCount> stage_us;
  std::vector<float> force_N, torque_mNm;  // magnitudes
  std::vector<std::uint32_t> contacts;
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

  void reserve(std::size_t ticks);
  void add(const TickReport& report);
  /// Ticks with a fault.
  std::uint64_t fault_ticks(Fault fault) const { return faults[std::countr_zero(+fault)]; }

 private:
  double last_force_[3]{}, last_asked_[3]{};
};

double mean(const std::vector<float>& values);
/// The value that a part (0 to 1) of the values does not exceed; 0 of none.
double quantile(std::vector<float> values, double part);

}  // namespace sulcus
