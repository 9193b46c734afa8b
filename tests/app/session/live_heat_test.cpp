#include "app/session/live_heat.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/terminal/terminal.hpp"
#include "tests/outcome/labelled_model.hpp"
#include "tests/support/scene_text.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::live_heat_test {
namespace {

/// Work of a tick, all of which heats the tooth, dry; air as warm as the tooth.
Scene hot_scene() {
  return test::parse(
      "tissue = ['enamel', 'pulp']\n[workpiece]\nshape = 'box'\nvoxel_mm = 0.05\n"
      "cells = [64, 64, 64]\n[trajectory]\npoints_mm = [[0, 0, 9]]\n[cutting]\n"
      "[heat]\ntooth_share = 1\nair_C = 37\n");
}

/// Enamel over pulp.
VoxelModel tooth() {
  return test::labelled(
      test::block(Eigen::Vector3i::Constant(64), 0.05e-3, Cell::Constant(8), Cell::Constant(56)),
      [](const Cell& c) { return static_cast<std::uint8_t>(c.z() < 32 ? 1 : 0); });
}

/// Ticks of a run in which a voxel goes in every tenth, at 20 mW unless said otherwise.
class HotRun {
 public:
  explicit HotRun(std::uint64_t first_tick = 0) : tick_(first_tick) {}

  template <class Heat>
  void go_on(Heat&& add, int ticks, double work_J = 2e-5) {
    const VoxelGrid grid = tooth().grid;
    for (int i = 0; i < ticks; ++i, ++tick_) {
      TickReport report;
      report.record.tick = report.cutting.tick = tick_;
      report.record.time_s = 1e-3 * static_cast<double>(tick_);
      report.cutting.spindle_rad_per_s = 1e4;
      report.cutting.work_J = work_J_ += work_J;
      const Edit edit{tick_, grid.linear({10 + (i / 400), 10 + ((i / 10) % 40), 55}), 0,
                      EditCause::kCut};
      add(report, i % 10 == 0 ? &edit : nullptr);
    }
  }

 private:
  std::uint64_t tick_;
  double work_J_ = 0.0;
};

std::string line(const std::vector<OutcomeLine>& lines, const std::string& name) {
  for (const OutcomeLine& line : lines) {
    if (line.name == name) return line.value;
  }
  return "none";
}

// Taken picture by picture, at whatever ticks: as all at once after the run.
TEST(LiveHeat, SaysWhatTheSummaryWillSay) {
  const Scene scene = hot_scene();
  LiveHeat live(scene, tooth(), 0);
  HeatLog log(1000.0, 0);
  HotRun run;
  std::vector<OutcomeLine> lines;
  for (const int ticks : {7, 33, 1, 400, 59, 1000, 1}) {
    run.go_on(
        [&](const TickReport& report, const Edit* edit) {
          if (edit) live.add(*edit), log.add(*edit);
          live.add(report);
          log.add(report.record, report.cutting);
        },
        ticks);
    lines = live.lines();
  }
  ToothHeat whole(scene, tooth());
  whole.advance(log, 1.5);
  const double rise_K = whole.result().pulp->end_change_K();
  EXPECT_GT(rise_K, 1.0);
  EXPECT_EQ(line(lines, "Pulp's wall").substr(0, 3), formatted("%+.4f", rise_K).substr(0, 3));
}

TEST(LiveHeat, WarnsOnceThePulpIsTooWarmAndFromThenOn) {
  const Scene scene = hot_scene();
  LiveHeat live(scene, tooth(), 500);
  HotRun run(500);
  const auto add = [&](const TickReport& report, const Edit* edit) {
    if (edit) live.add(*edit);
    live.add(report);
  };
  run.go_on(add, 100);
  EXPECT_EQ(line(live.lines(), "Pulp too warm"), "none");
  run.go_on(add, 3000, 2e-4);
  EXPECT_NE(line(live.lines(), "Pulp too warm"), "none");
  run.go_on(add, 1000, 0.0);
  EXPECT_NE(line(live.lines(), "Pulp too warm"), "none");
}

TEST(LiveHeat, OfAToothWithoutPulpNothingIsSaid) {
  const Scene scene = hot_scene();
  LiveHeat live(
      scene,
      test::block(Eigen::Vector3i::Constant(64), 0.05e-3, Cell::Constant(8), Cell::Constant(56)),
      0);
  HotRun run;
  run.go_on([&](const TickReport& report, const Edit*) { live.add(report); }, 50);
  EXPECT_TRUE(live.lines().empty());
}

}  // namespace
}  // namespace sulcus::live_heat_test
