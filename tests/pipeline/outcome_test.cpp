// What summary.json says that a cut did to the tooth, against the recording of the same run.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::outcome_test {
namespace {

using test::sulcus_command;

/// Enamel, dentine, pulp, in voxels of 0.15 mm; options may follow.
const std::string kCoarseAccess = std::string(SULCUS_SOURCE_DIR) +
                                  "/scenes/access_cavity.toml --set workpiece.voxel_mm=0.15 "
                                  "--set 'workpiece.cells=[96, 88, 168]' "
                                  "--set 'burr.field=[48, 192, 48]' ";

/// A run of a scene with options, its summary and its recording.
struct RecordedOutcome {
  RecordedOutcome(const ScratchFolder& scratch, const std::string& scene_and_options) {
    const auto result = sulcus_command(
        "run " + scene_and_options + " --no-render -o " + scratch.path("out"), scratch.path("err"));
    EXPECT_EQ(result.status, 0) << result.err;
    summary = nlohmann::json::parse(test::read_file(scratch.path("out/summary.json")));
    const RecordingReader reader(scratch.path("out/recording.h5"));
    start = reader.workpiece();
    edits = reader.edits();
    ticks = reader.ticks();
  }
  nlohmann::json summary;
  VoxelModel start;
  std::vector<Edit> edits;
  std::vector<TickRecord> ticks;
};

TEST(Outcome, TheAccessCavityExposesThePulpWhenItsEditsDo) {
  const ScratchFolder scratch;
  // Coarse, and straight down through the roof of the chamber.
  const RecordedOutcome run(
      scratch,
      kCoarseAccess + "--set 'trajectory.points_mm=[[0.46, -0.12, 6], [0.46, -0.12, 1.3]]'");
  constexpr std::uint8_t kPulp = 2;  // of enamel, dentine, pulp
  VoxelModel tooth = run.start;
  const auto is_pulp = [&](const Cell& c) { return tooth.solid(c) && tooth.tissue(c) == kPulp; };
  std::optional<std::uint64_t> exposed;
  std::uint64_t pulp_removed = 0;
  for (const Edit& edit : run.edits) {
    const Cell c = tooth.grid.cell_of_linear(edit.voxel);
    bool opens = is_pulp(c);
    pulp_removed += is_pulp(c);
    tooth.set(c, false);
    for (int axis = 0; axis < 3; ++axis) {
      opens = opens || is_pulp(c + Cell::Unit(axis)) || is_pulp(c - Cell::Unit(axis));
    }
    if (opens && !exposed) exposed = edit.tick;
  }
  ASSERT_TRUE(exposed);
  ASSERT_GT(*exposed, run.edits.front().tick);
  const nlohmann::json& outcome = run.summary["outcome"];
  EXPECT_EQ(outcome["pulp_exposed_tick"], *exposed);
  EXPECT_NEAR(outcome["pulp_exposed_s"].get<double>(), run.ticks[*exposed].time_s, 1e-9);
  EXPECT_NEAR(outcome["pulp_removed_mm3"].get<double>(),
              static_cast<double>(pulp_removed) * std::pow(0.15, 3), 1e-9);
  EXPECT_EQ(outcome["dentine_over_pulp_mm"], 0.0);
  EXPECT_FALSE(outcome.contains("caries_left_mm3")) << "no such tissue in the scene";
  EXPECT_FALSE(outcome.contains("pulp_distance")) << "nor a distance to be kept";
}

TEST(Outcome, DentineOverThePulpIsThatOfEveryPairOfVoxels) {
  const ScratchFolder scratch;
  const RecordedOutcome run(
      scratch, kCoarseAccess +
                   "--set 'trajectory.points_mm=[[0.9, 0.3, 6], [0.7, 0.2, 2.9], [0.1, -0.3, 3]]'");
  std::vector<Eigen::Vector3i> pulp;
  for (std::uint32_t v = 0; v < run.start.grid.cell_count(); ++v) {
    const Cell c = run.start.grid.cell_of_linear(v);
    if (run.start.solid(c) && run.start.tissue(c) == 2) pulp.push_back(c);
  }
  ASSERT_GT(pulp.size(), 1000u);
  int least = std::numeric_limits<int>::max();
  Edit nearest;
  for (const Edit& edit : run.edits) {
    const Cell c = run.start.grid.cell_of_linear(edit.voxel);
    for (const Eigen::Vector3i& p : pulp) {
      const int x = c.x() - p.x(), y = c.y() - p.y(), z = c.z() - p.z();
      const int squared = x * x + y * y + z * z;
      if (squared < least) least = squared, nearest = edit;
    }
  }
  ASSERT_GT(least, 4);
  const double wall_mm = 0.15 * (std::sqrt(static_cast<double>(least)) - 1.0);
  EXPECT_NEAR(run.summary["outcome"]["dentine_over_pulp_mm"].get<double>(), wall_mm, 1e-9);

  const auto assessed = sulcus_command(
      "assess " + scratch.path("out/recording.h5") + " --no-render -o " + scratch.path("assessed") +
          " --assessment " + scratch.write("pulp.toml", "[assessment]\ndentine_over_pulp_mm = 5\n"),
      scratch.path("err"));
  ASSERT_EQ(assessed.status, 0) << assessed.err;
  const auto json =
      nlohmann::json::parse(test::read_file(scratch.path("assessed/assessment.json")));
  const auto measure = std::ranges::find_if(
      json["measures"], [](const auto& m) { return m["name"] == "dentine_over_pulp_mm"; });
  ASSERT_NE(measure, json["measures"].end());
  EXPECT_NEAR((*measure)["value"].get<double>(), wall_mm, 1e-9);
  EXPECT_EQ((*measure)["tick"], nearest.tick);
  const Eigen::Vector3d at_m =
      run.start.grid.centre_world(run.start.grid.cell_of_linear(nearest.voxel));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR((*measure)["position_mm"][axis].get<double>(), 1e3 * at_m[axis], 1e-6);
  }
}

TEST(Outcome, BeforeTheRoofIsThroughThePulpIsNotExposed) {
  const ScratchFolder scratch;
  const RecordedOutcome run(
      scratch, kCoarseAccess +
                   "--set 'tissue=[\"enamel\", \"dentine\", \"pulp\", \"caries\"]' "
                   "--set workpiece.molar.caries_radius_mm=1.2 --set goal.pulp_distance_mm=2 "
                   "--set 'trajectory.points_mm=[[0.46, -0.12, 6], [0.46, -0.12, 3.4]]'");
  const nlohmann::json& outcome = run.summary["outcome"];
  EXPECT_TRUE(outcome["pulp_exposed_tick"].is_null());
  EXPECT_TRUE(outcome["pulp_exposed_s"].is_null());
  EXPECT_EQ(outcome["pulp_removed_mm3"], 0.0);
  // The roof lies at 1.8 mm; the tip has come to 3.4 mm.
  EXPECT_NEAR(outcome["dentine_over_pulp_mm"].get<double>(), 1.6, 0.25);
  // At 4 mm/s it was 2 mm above it 0.1 s before.
  EXPECT_EQ(outcome["pulp_distance"]["wanted_mm"], 2.0);
  EXPECT_EQ(outcome["pulp_distance"]["kept"], false);
  EXPECT_NEAR(outcome["pulp_distance"]["nearer_s"].get<double>(), run.ticks.back().time_s - 0.1,
              0.06);
  std::uint64_t caries = 0;
  for (std::uint32_t v = 0; v < run.start.grid.cell_count(); ++v) {
    const Cell c = run.start.grid.cell_of_linear(v);
    caries += run.start.solid(c) && run.start.tissue(c) == 3;
  }
  std::uint64_t removed = 0;
  for (const Edit& edit : run.edits) {
    removed += run.start.tissue(run.start.grid.cell_of_linear(edit.voxel)) == 3;
  }
  ASSERT_GT(removed, 0u);
  EXPECT_NEAR(outcome["caries_left_mm3"].get<double>(),
              static_cast<double>(caries - removed) * std::pow(0.15, 3), 1e-9);
  EXPECT_NEAR(outcome["removed_mm3"]["cut"]["caries"].get<double>(),
              run.summary["removed_mm3"]["caries"].get<double>(), 1e-9);
}

TEST(Outcome, ForcesAreThoseOfTheTicksInContact) {
  const ScratchFolder scratch;
  const RecordedOutcome run(scratch, scratch.write("s.toml", test::cut_scene()));
  double sum_N = 0.0, peak_N = 0.0;
  int in_contact = 0;
  for (const TickRecord& tick : run.ticks) {
    const double force_N = std::hypot(tick.force_N[0], tick.force_N[1], tick.force_N[2]);
    peak_N = std::max(peak_N, force_N);
    if (tick.contacts == 0) continue;
    sum_N += force_N;
    ++in_contact;
  }
  ASSERT_LT(in_contact, static_cast<int>(run.ticks.size()));
  const nlohmann::json& outcome = run.summary["outcome"];
  EXPECT_NEAR(outcome["peak_force_N"].get<double>(), peak_N, 1e-6);
  EXPECT_NEAR(outcome["mean_force_N"].get<double>(), sum_N / in_contact, 1e-6);
  EXPECT_NEAR(outcome["contact_s"].get<double>(), 1e-3 * in_contact, 1e-9);
  EXPECT_FALSE(outcome.contains("pulp_exposed_tick")) << "no pulp in the scene";
  EXPECT_FALSE(run.summary.contains("goal"));
}

TEST(Outcome, AGoalIsComparedWithWhatWent) {
  const ScratchFolder scratch;
  const std::string goal =
      "[goal]\nshape = 'box'\nsize_mm = [0.6, 0.4, 0.2]\nposition_mm = [0, 0, 0.9]\n";
  const RecordedOutcome run(scratch, scratch.write("s.toml", test::cut_scene() + goal));
  double both = 0.0, target = 0.0;
  const auto wanted = [&](const Cell& c) {
    const Eigen::Vector3d p = run.start.grid.centre_world(c) - Eigen::Vector3d(0, 0, 0.9e-3);
    return run.start.solid(c) && std::abs(p.x()) <= 0.3e-3 && std::abs(p.y()) <= 0.2e-3 &&
           std::abs(p.z()) <= 0.1e-3;
  };
  for (std::uint32_t v = 0; v < run.start.grid.cell_count(); ++v) {
    target += wanted(run.start.grid.cell_of_linear(v));
  }
  for (const Edit& edit : run.edits) both += wanted(run.start.grid.cell_of_linear(edit.voxel));
  ASSERT_GT(both, 0.0);
  const auto removed = static_cast<double>(run.edits.size());
  const double voxel_mm3 = std::pow(0.05, 3);
  const nlohmann::json& figures = run.summary["goal"];
  EXPECT_NEAR(figures["target_mm3"].get<double>(), target * voxel_mm3, 1e-9);
  EXPECT_NEAR(figures["missing_mm3"].get<double>(), (target - both) * voxel_mm3, 1e-9);
  EXPECT_NEAR(figures["excess_mm3"].get<double>(), (removed - both) * voxel_mm3, 1e-9);
  EXPECT_NEAR(figures["dice"].get<double>(), 2.0 * both / (target + removed), 1e-9);
  for (const char* reach : {"excess_beyond_mm", "missing_within_mm"}) {
    EXPECT_LE(figures[reach]["p95"], figures[reach]["max"]) << reach;
    EXPECT_GT(figures[reach]["max"], 0.0) << reach;
  }
}

TEST(Outcome, AGoalBesideTheToothIsRefusedBeforeAnythingIsWritten) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write(
      "s.toml",
      test::cut_scene() + "[goal]\nshape = 'box'\nsize_mm = [1, 1, 1]\nposition_mm = [0, 0, 9]\n");
  const auto result =
      sulcus_command("run " + scene + " -o " + scratch.path("out"), scratch.path("err"));
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("[goal]: found a goal without a voxel of the tooth"), std::string::npos)
      << result.err;
  EXPECT_FALSE(std::filesystem::exists(scratch.path("out")));
}

}  // namespace
}  // namespace sulcus::outcome_test
