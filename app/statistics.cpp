#include "app/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/core/hash.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

double length(const double (&v)[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace

void RunStatistics::reserve(std::size_t ticks) {
  for (auto* values : {&tick_us, &late_us, &force_N, &torque_mNm}) values->reserve(ticks);
  for (auto& values : stage_us) values.reserve(ticks);
  contacts.reserve(ticks);
}

void RunStatistics::add(const TickReport& report) {
  const TickRecord& r = report.record;
  const PortRecord& port = report.port;
  double force[3], torque[3], step[3], asked_step[3];
  for (int a = 0; a < 3; ++a) {
    force[a] = r.force_N[a];
    torque[a] = r.torque_Nm[a];
    step[a] = tick_us.empty() ? 0.0 : force[a] - last_force_[a];
    last_force_[a] = force[a];
    asked_step[a] = tick_us.empty() ? 0.0 : port.asked_force_N[a] - last_asked_[a];
    last_asked_[a] = port.asked_force_N[a];
  }
  force_step_max_N = std::max(force_step_max_N, length(step));
  asked_step_max_N = std::max(asked_step_max_N, length(asked_step));
  asked_force_sum_N += length(port.asked_force_N);
  asked_force_max_N = std::max(asked_force_max_N, length(port.asked_force_N));
  evaluations_sum += static_cast<double>(port.evaluations);
  evaluations_max = std::max(evaluations_max, port.evaluations);
  force_hash = hash_bytes(force, sizeof(force), force_hash);
  force_hash = hash_bytes(torque, sizeof(torque), force_hash);
  tick_us.push_back(r.step_us);
  late_us.push_back(r.late_us);
  for (int s = 0; s < kStageCount; ++s) stage_us[s].push_back(report.stage_us[s]);
  force_N.push_back(static_cast<float>(length(force)));
  torque_mNm.push_back(static_cast<float>(length(torque) * 1e3));
  contacts.push_back(r.contacts);
  leaves_sum += r.leaves;
  tested_sum += r.tested;
  leaves_max = std::max<std::uint32_t>(leaves_max, r.leaves);
  tested_max = std::max<std::uint32_t>(tested_max, r.tested);
  removed += r.removed;
  for (int bit = 0; bit < 32; ++bit) faults[bit] += r.faults >> bit & 1u;
}

double mean(const std::vector<float>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double quantile(std::vector<float> values, double part) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + std::lround(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace sulcus
