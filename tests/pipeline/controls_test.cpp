#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/recording/recording_reader.hpp"
#include "engine/scene/scene_file.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

// What a hand and a foot ask for beside the pose: pedal, clutch, another burr; and where a device
// lies in the scene. The device is tests/support/plugins/controls_device.c, which does what its
// settings say at known ticks.

namespace sulcus::controls_test {
namespace {

namespace fs = std::filesystem;
using test::sulcus_command;

/// Across the top of the block and back, 0.08 mm deep, in 1.2 s and more.
const std::string kWay = R"(
[trajectory]
points_mm = [[-0.6, 0, 1.2], [-0.6, 0, 0.92], [0.6, 0, 0.92], [0.6, 0, 1.6]]
speed_mm_per_s = 1.6
hold_s = 0.6
[cutting]
[record]
)";
constexpr double kSpeed_rad_per_s = 100000.0 * 2.0 * M_PI / 60.0;  // of block_and_burr()

class Controls : public ::testing::Test {
 protected:
  test::CommandResult run(const std::string& settings, const std::string& tables = "",
                          const std::string& options = "") const {
    const std::string scene = scratch_.write(
        "s.toml", test::block_and_burr() + kWay + "[device]\nplugin = 'controls'\nsettings = '" +
                      settings + "'\n" + tables);
    return sulcus_command("run " + scene + " --force --plugins " SULCUS_BAD_PLUGINS " " + options +
                              " -o " + scratch_.path("out"),
                          scratch_.path("err"));
  }
  RecordingReader recording(const std::string& part = "") const {
    return RecordingReader(scratch_.path("out") + part + "/recording.h5");
  }
  void expect_verified(const std::string& part = "") const {
    const auto verified = sulcus_command(
        "replay --verify " + scratch_.path("out") + part + "/recording.h5", scratch_.path("err"));
    EXPECT_EQ(verified.status, 0) << verified.err;
  }
  nlohmann::json summary(const std::string& folder) const {
    return nlohmann::json::parse(test::read_file(scratch_.path(folder) + "/summary.json"));
  }
  const ScratchFolder scratch_;
};

TEST_F(Controls, ThePedalDrivesTheSpindleAndIsPlayedBackToTheBit) {
  const auto result = run("200 pedal 0.5 400 pedal 0 600 pedal 7 800 pedal -1 900 pedal 0.25");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto share = [](std::uint64_t tick) {
    if (tick < 200) return 1.0;
    if (tick < 400) return 0.5;
    if (tick < 600) return 0.0;
    if (tick < 800) return 1.0;  // no more than all of it
    return tick < 900 ? 0.0 : 0.25;
  };
  const RecordingReader reader = recording();
  std::size_t cut_without = 0, cut_with = 0;
  const std::vector<TickRecord> rows = reader.ticks();
  const std::vector<CuttingRecord> cutting = reader.cutting();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double speed = share(rows[i].tick);
    ASSERT_NEAR(cutting[i].spindle_rad_per_s, speed * kSpeed_rad_per_s, 1e-9) << rows[i].tick;
    (speed > 0.0 ? cut_with : cut_without) += rows[i].removed;
  }
  EXPECT_GT(cut_with, 100u);
  EXPECT_EQ(cut_without, 0u);  // the way is slow: without the spindle next to no work is done
  ASSERT_EQ(reader.pedal().size(), 5u);
  EXPECT_EQ(reader.pedal()[1].tick, 400u);
  EXPECT_EQ(reader.pedal()[1].share, 0.0);
  expect_verified();

  // As a scene's trajectory, and gone on from, it is the same again.
  const std::string again = scratch_.write(
      "again.toml", test::block_and_burr() + "[trajectory]\nrecording = 'out/recording.h5'\n" +
                        "[device]\nmodel = 'played_back'\nforce_limit_N = 3.3\n" +
                        "torque_limit_mNm = 100\n[cutting]\n[record]\n");
  const auto replayed =
      sulcus_command("run " + again + " -o " + scratch_.path("again"), scratch_.path("err"));
  ASSERT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_EQ(summary("again")["workpiece"]["hash"], summary("out")["workpiece"]["hash"]);
  EXPECT_EQ(summary("again")["force_hash"], summary("out")["force_hash"]);
  const auto on = sulcus_command(
      "replay " + scratch_.path("out/recording.h5") + " --from 0.5 -o " + scratch_.path("on"),
      scratch_.path("err"));
  ASSERT_EQ(on.status, 0) << on.err;
  EXPECT_EQ(summary("on")["workpiece"]["hash"], summary("out")["workpiece"]["hash"]);
  const RecordingReader rest(scratch_.path("on/recording.h5"));
  ASSERT_FALSE(rest.pedal().empty());
  EXPECT_EQ(rest.pedal().front().tick, 501u);
  EXPECT_EQ(rest.pedal().front().share, 0.0);
}

TEST_F(Controls, APedalWithASpindleThatSagsIsItsFreeSpeed) {
  const auto result = run("500 pedal 0.5", "[spindle]\n");
  ASSERT_EQ(result.status, 0) << result.err;
  double before = 0.0, after = 0.0;
  for (const CuttingRecord& row : recording().cutting()) {
    double& largest = row.tick < 500 ? before : after;
    if (row.tick < 500 || row.tick > 700) largest = std::max(largest, row.spindle_rad_per_s);
  }
  EXPECT_NEAR(before, kSpeed_rad_per_s, 1e-6 * kSpeed_rad_per_s);
  EXPECT_NEAR(after, 0.5 * kSpeed_rad_per_s, 1e-3 * kSpeed_rad_per_s);
  expect_verified();
}

TEST_F(Controls, TheClutchHoldsTheTipAndTheHandGoesOnFromThere) {
  ASSERT_EQ(run("300 clutch 1 500 clutch 0").status, 0);
  const std::vector<TickRecord> clutched = recording().ticks();
  ASSERT_EQ(run("0 clutch 0").status, 0);
  const std::vector<TickRecord> free = recording().ticks();
  for (std::size_t i = 0; i < clutched.size(); ++i) {
    // Held from the tip's place in tick 299 on; in 500 it is let go of there.
    const std::size_t held = 299, let_go = 500;
    for (int axis = 0; axis < 3; ++axis) {
      double expected = free[i].device_position_m[axis];
      if (i > held && i <= let_go) expected = free[held].device_position_m[axis];
      if (i > let_go) {
        expected += free[held].device_position_m[axis] - free[let_go].device_position_m[axis];
      }
      ASSERT_NEAR(clutched[i].device_position_m[axis], expected, 1e-12) << i;
    }
  }
}

TEST_F(Controls, UnderTheClutchNothingIsFeltOrCut) {
  ASSERT_EQ(run("300 clutch 1 500 clutch 0").status, 0);
  const std::vector<TickRecord> rows = recording().ticks();
  const auto force_N = [&](std::size_t tick) {
    return Eigen::Vector3d(rows[tick].force_N[0], rows[tick].force_N[1], rows[tick].force_N[2])
        .norm();
  };
  EXPECT_GT(force_N(299), 0.1);
  std::uint32_t removed = 0;
  for (std::size_t tick = 320; tick < 500; ++tick) removed += rows[tick].removed;
  EXPECT_EQ(removed, 0u);
  for (std::size_t tick = 380; tick < 500; ++tick) ASSERT_EQ(force_N(tick), 0.0) << tick;
  EXPECT_GT(force_N(700), 0.1);  // and again after it
  expect_verified();
}

TEST_F(Controls, TheDeviceLiesWhereTheSceneSays) {
  ASSERT_EQ(run("0 clutch 0").status, 0);
  const std::vector<TickRecord> own = recording().ticks();
  // A quarter turn about z: x of the device is y of the scene. Its origin is 0.1 mm up.
  ASSERT_EQ(run("0 clutch 0", "rotation_deg = [0, 0, 90]\nscale = 0.5\nposition_mm = [0, 0, 0.7]\n")
                .status,
            0);
  const std::vector<TickRecord> placed = recording().ticks();
  for (std::size_t i = 0; i < own.size(); i += 50) {
    const double *p = own[i].device_position_m, *q = placed[i].device_position_m;
    ASSERT_NEAR(q[0], -0.5 * p[1], 1e-12) << i;
    ASSERT_NEAR(q[1], 0.5 * p[0], 1e-12) << i;
    ASSERT_NEAR(q[2], 0.5 * p[2] + 0.7e-3, 1e-12) << i;
  }
  expect_verified();
  // Its first position comes to the trajectory's start, whatever its scale.
  ASSERT_EQ(run("0 clutch 0", "scale = 0.5\nrecentre = true\n").status, 0);
  const std::vector<TickRecord> centred = recording().ticks();
  EXPECT_NEAR(centred.front().device_position_m[2], 1.2e-3, 1e-12);
  EXPECT_NEAR(centred.back().device_position_m[0], -0.6e-3 + 0.5 * 1.2e-3, 1e-12);
}

TEST_F(Controls, AnotherBurrIsAnotherPartThatGoesOn) {
  ASSERT_EQ(run("0 clutch 0").status, 0);
  const std::size_t ticks = recording().tick_count();
  // In the air at the end.
  const auto result = run("1400 burr 1 1700 burr 7",
                          "[[spare_burr]]\nname = 'small'\n"
                          "shape = 'fissure'\ndiameter_mm = 0.6\n");
  ASSERT_EQ(result.status, 0) << result.err;
  expect_verified();
  expect_verified("/part_2");
  const RecordingReader first = recording(), second = recording("/part_2");
  const std::vector<TickRecord> before = first.ticks(), after = second.ticks();
  EXPECT_EQ(after.front().tick, before.back().tick + 1);
  EXPECT_EQ(
      std::hypot(before.back().force_N[0], before.back().force_N[1], before.back().force_N[2]),
      0.0);
  const Scene changed = parse_scene(second.header().scene_toml, "part_2");
  EXPECT_EQ(changed.burr.shape, BurrShape::kFissure);
  EXPECT_NEAR(changed.burr.diameter_m, 0.6e-3, 1e-12);
  EXPECT_NEAR(changed.burr.speed_rad_per_s, kSpeed_rad_per_s, 1e-6);  // [burr]'s own
  ASSERT_EQ(changed.burrs.size(), 2u);
  EXPECT_EQ(changed.burrs[1].name, "small");
  // A burr that there is not is none, which is told, and the run has its length.
  EXPECT_NE(result.err.find("asked for burr 7, where the scene has 1 [[spare_burr]]"),
            std::string::npos)
      << result.err;
  EXPECT_FALSE(fs::exists(scratch_.path("out/part_3")));
  EXPECT_EQ(first.tick_count() + second.tick_count(), ticks);
}

TEST_F(Controls, ADeviceThatIsOverEndsTheRunAsIfByItself) {
  const auto result = run("700 over 1");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_LT(recording().tick_count(), 800u);
  EXPECT_GE(recording().tick_count(), 700u);
  expect_verified();
}

TEST_F(Controls, SpareBurrsAreReadBeforeTheRun) {
  const auto fails = [&](const std::string& tables, const std::string& said) {
    const auto result = run("0 pedal 1", tables);
    EXPECT_EQ(result.status, 2) << tables;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_NE(result.err.find(said), std::string::npos) << result.err;
  };
  fails("[[spare_burr]]\nshape = 'spoon'\n", "spare_burr.shape");
  fails("[[spare_burr]]\ndiameter_mm = 60\n", "spare_burr.diameter_mm");
  fails("[[spare_burr]]\nfile = 'x.stl'\nshape = 'pear'\n", "both a shape and a file");
  fails("[spare_burr]\nshape = 'pear'\n", "[[spare_burr]]");
  std::string many;
  for (int i = 0; i < 16; ++i) many += "[[spare_burr]]\ndiameter_mm = 1\n";
  fails(many, "at most 15");
}

}  // namespace
}  // namespace sulcus::controls_test
