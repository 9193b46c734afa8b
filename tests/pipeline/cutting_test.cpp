#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/core/pose.hpp"
#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/energy_balance.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::cutting_test {
namespace {

using test::sulcus_command;

/// The bar that is cut on its side, fast enough that many layers go in the time of a test.
class SideCutting : public ::testing::Test {
 protected:
  nlohmann::json run(const std::string& name, const std::string& options) {
    const auto result =
        sulcus_command("run " + std::string(SULCUS_SOURCE_DIR) +
                           "/scenes/side_cut.toml --set burr.speed_rpm=150000 --set "
                           "trajectory.hold_s=1 " +
                           options + " -o " + scratch_.path(name),
                       scratch_.path("err"));
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(test::read_file(scratch_.path(name) + "/summary.json"));
  }
  static double removed_mm3(const nlohmann::json& summary) {
    double sum = 0.0;
    for (const auto& [tissue, mm3] : summary["removed_mm3"].items()) sum += mm3.get<double>();
    return sum;
  }

  const ScratchFolder scratch_;
  const std::string coarse_ = "--set workpiece.voxel_mm=0.05 --set 'workpiece.cells=[24, 72, 56]' ";
};

TEST_F(SideCutting, TheLoadIsHeldAndTheWorkIsThatOfTheRecordedForceTorqueAndSpeed) {
  const nlohmann::json summary =
      run("out", coarse_ + "--set spindle.stall_torque_mNm=0.5 --set spindle.inertia_g_mm2=1");
  const double work_J = summary["tangential_work_J"];
  ASSERT_GT(removed_mm3(summary), 0.1);
  test::expect_energies_balance(summary);
  EXPECT_NEAR(summary["removed_energy_J"].get<double>(), 3.5 * removed_mm3(summary), 1e-6 * work_J);

  const RecordingReader reader(scratch_.path("out/recording.h5"));
  const auto ticks = reader.ticks();
  const auto rows = reader.cutting();
  ASSERT_EQ(rows.size(), ticks.size());
  const double dt_s = 1.0 / reader.header().rate_hz;
  double integrated_J = 0.0, slowest = rows.front().spindle_rad_per_s;
  int held = 0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const auto pose = [](const TickRecord& t) {
      return pose_of(t.tool_position_m, t.tool_orientation);
    };
    // The handpiece does not turn here, so that every point of it moves as the tip does.
    const Eigen::Vector3d velocity = (pose(ticks[i]).position - pose(ticks[i - 1]).position) / dt_s;
    const Eigen::Vector3d turning =
        rows[i].spindle_rad_per_s * pose(ticks[i]).direction(Eigen::Vector3d::UnitY());
    const Eigen::Vector3d force(rows[i].tangential_force_N[0], rows[i].tangential_force_N[1],
                                rows[i].tangential_force_N[2]);
    const Eigen::Vector3d torque(rows[i].tangential_torque_Nm[0], rows[i].tangential_torque_Nm[1],
                                 rows[i].tangential_torque_Nm[2]);
    integrated_J -= (force.dot(velocity) + torque.dot(turning)) * dt_s;
    slowest = std::min(slowest, rows[i].spindle_rad_per_s);
    held += std::abs(ticks[i].contact_force_N[2] - 1.0) < 0.02;
  }
  EXPECT_NEAR(integrated_J, work_J, 1e-4 * work_J);
  EXPECT_EQ(rows.back().work_J, work_J);
  EXPECT_LT(slowest, 0.85 * rows.front().spindle_rad_per_s) << "it sags under load";
  EXPECT_GT(held, 900);
}

TEST_F(SideCutting, TheVolumeDoesNotDependOnTheVoxelSizeOrTheRate) {
  std::map<std::string, double> mm3;
  for (const std::string rate : {"500", "2000"}) {
    mm3[rate] = removed_mm3(run(rate, coarse_ + "--set haptics.rate_hz=" + rate));
  }
  mm3["fine"] = removed_mm3(run("fine", ""));
  for (const auto& [a, volume_a] : mm3) {
    for (const auto& [b, volume_b] : mm3) EXPECT_LT(volume_a, 1.1 * volume_b) << a << ", " << b;
  }
}

TEST_F(SideCutting, UnderTheSaturatingLawItDoesNotDependOnTheRateEither) {
  const std::string law =
      coarse_ +
      "--set cutting.law=saturating --set burr.tangential_ratio=0.5 --set burr.grit=super_coarse "
      "--set trajectory.hold_s=0.4 --set workpiece.surface=fractions ";
  const auto of = [&](const std::string& name, const std::string& options) {
    const nlohmann::json summary = run(name, law + options);
    test::expect_energies_balance(summary);
    EXPECT_GT(summary["heat_J"].get<double>(), 0.5 * summary["tangential_work_J"].get<double>());
    return removed_mm3(summary);
  };
  const double mm3 = of("usual", "");
  EXPECT_NEAR(of("slow", "--set haptics.rate_hz=500"), mm3, 0.01 * mm3);
}

TEST_F(SideCutting, ItCutsHardlyMoreWithTwiceTheLoadUnderTheSaturatingLaw) {
  const auto of = [&](const std::string& name, const std::string& options) {
    return removed_mm3(run(name, coarse_ + "--set trajectory.load_N=" + options));
  };
  // Not twice as much: deeper in, more of the burr's side turns where it cuts less.
  EXPECT_GT(of("paper_2", "2"), 1.7 * of("paper_1", "1"));
  const std::string law = " --set cutting.law=saturating";
  EXPECT_LT(of("saturating_2", "2" + law), 1.2 * of("saturating_1", "1" + law));
}

TEST_F(SideCutting, TissuesGoInTheRatioOfTheirSpecificEnergies) {
  std::map<std::string, double> mm3;
  for (const std::string tissue : {"enamel", "dentine", "caries"}) {
    mm3[tissue] = removed_mm3(
        run(tissue, coarse_ + "--set trajectory.hold_s=0.5 --set 'tissue=[\"" + tissue + "\"]'"));
  }
  EXPECT_NEAR(mm3["dentine"] / mm3["enamel"], 3.5 / 0.65, 0.1 * 3.5 / 0.65);
  EXPECT_GT(mm3["caries"], 1.2 * mm3["dentine"]);
}

TEST(Drilling, TheForceFallsWhereEnamelEndsAsTheSpecificEnergyDoes) {
  const ScratchFolder scratch;
  const auto result =
      sulcus_command("run " + std::string(SULCUS_SOURCE_DIR) +
                         "/scenes/enamel_to_dentine.toml --set workpiece.voxel_mm=0.06 "
                         "--set 'workpiece.cells=[224, 224, 408]' -o " +
                         scratch.path("out"),
                     scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  const RecordingReader reader(scratch.path("out/recording.h5"));
  const VoxelModel tooth = reader.workpiece();
  // In windows of 0.25 s: mean force along the axis, and how much of what went was dentine.
  constexpr std::uint64_t kWindow = 250;
  std::map<std::uint64_t, double> force_N;
  std::map<std::uint64_t, std::array<int, 2>> went;
  for (const TickRecord& row : reader.ticks()) {
    force_N[row.tick / kWindow] += row.force_N[0] / kWindow;
  }
  for (const Edit& edit : reader.edits()) {
    ++went[edit.tick / kWindow][tooth.tissue(tooth.grid.cell_of_linear(edit.voxel))];
  }
  double enamel_N = 0.0, dentine_N = 0.0;
  int windows = 0;
  for (const auto& [window, voxels] : went) {
    if (voxels[1] == 0) enamel_N = std::max(enamel_N, force_N[window]);
    if (voxels[0] > 0 || window > 8400 / kWindow) continue;  // or past the end of the way
    dentine_N += force_N[window];
    ++windows;
  }
  ASSERT_GT(windows, 5);
  dentine_N /= windows;
  // The hole has hardly come to its full width where the enamel ends.
  const double ratio = 3.5 / 0.65;
  EXPECT_GT(enamel_N / dentine_N, 0.7 * ratio);
  EXPECT_LT(enamel_N / dentine_N, 1.1 * ratio);
}

TEST(LoosePieces, WhatIsCutOffFallsAndComesToRestAndARunOfItReplaysExactly) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("post.toml", test::post_scene());
  for (const std::string pace : {"fast", "real"}) {
    const std::string folder = scratch.path(pace);
    const auto result = sulcus_command(
        "run " + scene + " --duration 2.5 --pace " + pace + " -o " + folder, scratch.path("err"));
    ASSERT_EQ(result.status, 0) << result.err;
    const auto summary = nlohmann::json::parse(test::read_file(folder + "/summary.json"));
    EXPECT_EQ(summary["fragments"], 1);
    const std::string recording = folder + "/recording.h5";
    const auto again = sulcus_command("replay --verify " + recording, scratch.path("err"));
    EXPECT_EQ(again.status, 0) << again.err;

    const RecordingReader reader(recording);
    ASSERT_EQ(reader.pieces().size(), 1u);
    const PieceRow& piece = reader.pieces()[0];
    // 0.5 x 0.5 x 0.5 mm are over the cut, and what of the cut the round burr leaves at its sides.
    EXPECT_NEAR(static_cast<double>(piece.voxels) * 0.05 * 0.05 * 0.05, 0.125, 0.03);
    // After it has gone nothing holds the burr that has passed through.
    for (const TickRecord& row : reader.ticks()) {
      if (row.tick > piece.tick) {
        EXPECT_EQ(row.contacts, 0u) << row.tick;
      }
    }
    ASSERT_FALSE(reader.piece_poses().empty());
    const PiecePoseRow& last = reader.piece_poses().back();
    EXPECT_LT(last.position_m[2], -0.4e-3) << "it has fallen";
    EXPECT_LT(last.tick + 100, reader.ticks().back().tick) << "and rests: nothing more is told";
  }
}

}  // namespace
}  // namespace sulcus::cutting_test
