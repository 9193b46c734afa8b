#include "tools/sulcus_lab/table1/table1_experiment.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/scene/scene_file.hpp"
#include "tools/sulcus_lab/table1/table1_rows.hpp"

namespace sulcus::lab::table1_experiment_test {
namespace {

const auto kSilent = [](const std::string&) {};

/// Down onto the molar's chewing surface and a little along it: 60 ticks on coarse voxels.
Scene small_scene(const std::string& method) {
  const std::string overrides[] = {"haptics.normals=" + method};
  return parse_scene(R"(
title = "A touch"
tissue = ["enamel"]
[workpiece]
shape = "molar"
voxel_mm = 0.14
cells = [128, 128, 128]
[burr]
shape = "round"
diameter_mm = 1.4
field = [48, 192, 48]
[trajectory]
axis = [0, 0, 1]
speed_mm_per_s = 0.6
points_mm = [[0.8, -0.28, 5.94], [0.8, -0.28, 5.66], [1.1, -0.3, 5.72]]
[haptics]
rate_hz = 100
scaling = "count"
)",
                     "scene.toml", overrides);
}

TEST(Table1Experiment, TheReferenceAgainstItselfHasNoError) {
  const Table1Run run = run_table1_experiment(small_scene("exact"), 10, kSilent);
  ASSERT_GT(run.normals, 50u);
  const WrenchErrors errors =
      wrench_errors(run.compared, &ComparedTick::ours, &ComparedTick::exact);
  EXPECT_EQ(errors.force_vector_rmse_N, 0.0);
  EXPECT_EQ(errors.torque_vector_rmse_mNm, 0.0);
  EXPECT_EQ(run.ours_to_exact.max_deg, 0.0);
}

TEST(Table1Experiment, ComparesEveryNthTickAndKnowsTheUncutTooth) {
  const Table1Run run = run_table1_experiment(small_scene("ldm"), 7, kSilent);
  ASSERT_EQ(run.compared.size(), (run.contacts.size() + 6) / 7);
  EXPECT_EQ(run.compared[1].tick, 7u);
  EXPECT_EQ(run.compared.back().contacts, run.contacts[run.compared.back().tick]);
  ASSERT_GT(run.normals, 50u);
  EXPECT_EQ(std::accumulate(run.by_axes.begin(), run.by_axes.end(), std::uint64_t{0}), run.normals);
  EXPECT_GT(run.tick_us_mean, 0.0);
  EXPECT_GT(run.exact_us, run.ours_us);

  ASSERT_TRUE(run.has_truth);
  EXPECT_GT(run.ours_to_truth.mean_deg(), 0.0);
  EXPECT_LT(run.ours_to_truth.mean_deg(), 12.0);  // a fissure in coarse voxels
  const WrenchErrors errors =
      wrench_errors(run.compared, &ComparedTick::ours, &ComparedTick::truth);
  double most_N = 0.0;
  for (const ComparedTick& tick : run.compared) {
    most_N = std::max(most_N, tick.truth.force_N.norm());
  }
  ASSERT_GT(most_N, 0.0);
  EXPECT_LT(errors.force_rmse_N, 0.1 * most_N);
}

TEST(Table1Experiment, BesideTheReferenceTheSameVoxelsAreCut) {
  // Soft, so that a second of it takes some voxels away. A comparison that is not with the tick's
  // own force, on the voxels as they are then, ends in an exception.
  Scene scene = small_scene("ldm");
  scene.cutting.emplace();
  scene.tissues[0].specific_energy_J_per_m3 = 0.02e9;
  const Table1Run run = run_table1_experiment(scene, 1, kSilent);
  EXPECT_GT(run.removed_voxels, 0u);
  EXPECT_FALSE(run.has_truth);
  ASSERT_EQ(run.compared.size(), run.contacts.size());
  for (const ComparedTick& tick : run.compared) {
    EXPECT_EQ(tick.contacts, run.contacts[tick.tick]);
  }
}

TEST(Table1Experiment, AStartInsideTheToothIsRefused) {
  Scene scene = small_scene("ldm");
  scene.trajectory.points_m.front().z() = 1e-3;
  EXPECT_THROW(run_table1_experiment(scene, 1, kSilent), InputError);
}

}  // namespace
}  // namespace sulcus::lab::table1_experiment_test
