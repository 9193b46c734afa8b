#include "app/session/run_statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/core/units.hpp"
#include "haptics/force_hash.hpp"

namespace sulcus {

namespace {

double length(const double (&v)[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace

void Distribution::add(float value) noexcept {
  constexpr float kMost = std::numeric_limits<float>::max();
  const float counted = std::isfinite(value) ? std::max(value, 0.0f) : kMost;
  // The sum of -0 and 0 is 0: no sign is left among the bits.
  ++bins_[std::bit_cast<std::uint32_t>(counted + 0.0f) >> kShift];
  ++count_;
  sum_ += static_cast<double>(counted);
  largest_ = std::max(largest_, static_cast<double>(counted));
}

double Distribution::quantile(double part) const {
  if (count_ == 0) return 0.0;
  const auto rank =
      static_cast<std::uint64_t>(std::llround(part * static_cast<double>(count_ - 1)));
  if (rank + 1 == count_) return largest_;
  std::uint64_t before = 0;
  std::uint32_t bin = 0;
  while (before + bins_[bin] <= rank) before += bins_[bin++];
  if (bin == 0) return 0.0;
  const auto at = [](std::uint32_t b) {
    return static_cast<double>(std::bit_cast<float>(b << kShift));
  };
  return std::min(0.5 * (at(bin) + at(bin + 1)), largest_);
}

void RunStatistics::add(const TickReport& report) {
  const TickRecord& r = report.record;
  const PortRecord& port = report.port;
  double force[3], torque[3], step[3], commanded_step[3];
  for (int a = 0; a < 3; ++a) {
    force[a] = r.force_N[a];
    torque[a] = r.torque_Nm[a];
    step[a] = ticks == 0 ? 0.0 : force[a] - last_force_[a];
    last_force_[a] = force[a];
    commanded_step[a] = ticks == 0 ? 0.0 : port.asked_force_N[a] - last_commanded_[a];
    last_commanded_[a] = port.asked_force_N[a];
  }
  force_step_max_N = std::max(force_step_max_N, length(step));
  commanded_step_max_N = std::max(commanded_step_max_N, length(commanded_step));
  commanded_force_sum_N += length(port.asked_force_N);
  commanded_force_max_N = std::max(commanded_force_max_N, length(port.asked_force_N));
  evaluations_sum += static_cast<double>(port.evaluations);
  evaluations_max = std::max(evaluations_max, port.evaluations);
  force_hash = force_hash_after(force_hash, force, torque);
  tick_us.add(r.step_us);
  late_us.add(r.late_us);
  for (int s = 0; s < kStageCount; ++s) stage_us[s].add(report.stage_us[s]);
  const double force_now_N = length(force), torque_now_mNm = 1e3 * length(torque);
  force_N.add(static_cast<float>(force_now_N));
  torque_mNm.add(static_cast<float>(torque_now_mNm));
  contacts_sum += r.contacts;
  contacts_max = std::max(contacts_max, r.contacts);
  const double spindle_krpm = 1e-3 * report.cutting.spindle_rad_per_s / kRevolutionPerMinute;
  if (r.contacts > 0) {
    force_in_contact_sum_N += force_now_N;
    ++ticks_in_contact;
  }
  ChartPoint point{.time_s = r.time_s,
                   .tick_us = r.step_us,
                   .spindle_krpm = static_cast<float>(spindle_krpm),
                   .contacts = r.contacts};
  const Eigen::Vector3d axis =
      pose_of(r.tool_position_m, r.tool_orientation).direction(Eigen::Vector3d::UnitY());
  for (std::size_t a = 0; a < 3; ++a) {
    point.force_N[a] = static_cast<float>(force[a]);
    point.torque_mNm[a] = static_cast<float>(1e3 * torque[a]);
    point.tip_m[a] = static_cast<float>(r.tool_position_m[a]);
    point.axis[a] = static_cast<float>(axis[static_cast<Eigen::Index>(a)]);
  }
  chart.add(point);
  leaves_sum += r.leaves;
  tested_sum += r.tested;
  leaves_max = std::max<std::uint32_t>(leaves_max, r.leaves);
  tested_max = std::max<std::uint32_t>(tested_max, r.tested);
  removed += r.removed;
  for (int bit = 0; bit < 32; ++bit) faults[bit] += r.faults >> bit & 1u;
  ++ticks;
}

}  // namespace sulcus
