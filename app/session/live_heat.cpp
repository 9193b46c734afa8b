#include "app/session/live_heat.hpp"

#include "app/terminal/terminal.hpp"

namespace sulcus {

LiveHeat::LiveHeat(const Scene& scene, const VoxelModel& start, std::uint64_t first_tick)
    : log_(scene.haptics.rate_hz, first_tick), tooth_(scene, start) {}

void LiveHeat::add(const TickReport& report) {
  log_.add(report.record, report.cutting);
  latest_s_ = report.record.time_s;
}

std::vector<OutcomeLine> LiveHeat::lines() {
  tooth_.advance(log_, latest_s_);
  const auto& pulp = tooth_.result().pulp;
  if (!pulp || pulp->curve.empty()) return {};
  std::vector<OutcomeLine> lines{{"Pulp's wall", formatted("%+.1f K", pulp->end_change_K())}};
  if (pulp->over_limit_s > 0.0) {
    lines.push_back({"Pulp too warm", formatted("for %.1f s", pulp->over_limit_s)});
  }
  return lines;
}

}  // namespace sulcus
