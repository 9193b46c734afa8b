#include "tools/sulcus_lab/pareto/pareto_measurement.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "engine/shapes/voxelise_implicit.hpp"

namespace sulcus::lab::pareto_measurement_test {
namespace {

ParetoRow row(double tick_us, double error_pct) {
  ParetoRow made;
  made.tick_us = tick_us;
  made.whole_pct = error_pct;
  return made;
}

TEST(ParetoFront, HoldsWhatNothingElseIsBetterThan) {
  std::vector<ParetoRow> rows{row(30, 2), row(10, 5),   row(20, 5), row(40, 1),
                              row(35, 3), row(30, 1.5), row(10, 6)};
  mark_front(rows);
  std::vector<bool> front;
  for (const ParetoRow& r : rows) front.push_back(r.on_front);
  EXPECT_EQ(front, (std::vector<bool>{false, true, false, true, false, true, false}));
}

TEST(ParetoSettings, EveryMethodWithEveryFieldAndOursFurther) {
  const std::vector<ParetoSetting> settings = pareto_settings(3);
  EXPECT_EQ(settings.size(), 3u * (6 * 6 + 2 * 2));
  for (const ParetoSetting& setting : settings) {
    const bool ours =
        setting.method == NormalMethod::kLdm || setting.method == NormalMethod::kLdmFast;
    EXPECT_TRUE(setting.neighbourhood <= 6 || ours);
    EXPECT_LT(setting.field, 3u);
  }
}

/// A ball of 30 voxels.
class Pareto : public ::testing::Test {
 protected:
  static constexpr double kVoxel = 35e-6, kHead = 12.0 * kVoxel, kDepth = 3.0 * kVoxel;

  Pareto()
      : ball_(30.0 * kVoxel),
        shape_({side_of(ball_)}, ball_.bounds()),
        workpiece_([&] {
          VoxelGrid grid;
          grid.cells = Eigen::Vector3i::Constant(80);
          grid.voxel_m = kVoxel;
          return voxelise_implicit(ball_, grid, nullptr);
        }()),
        surface_(workpiece_, shape_),
        burrs_{burr(96), burr(20)} {}

  static Burr burr(int samples) {
    BurrSettings settings;
    settings.diameter_m = 2.0 * kHead;
    settings.field_samples = Eigen::Vector3i(samples, 6 * samples, samples);
    return make_burr(settings, kVoxel);
  }
  std::vector<PressedPose> poses(std::uint64_t seed) {
    return pressed_poses(surface_, burrs_[0], kHead, kDepth, 5.0 * kVoxel, 12, seed,
                         HapticsSettings());
  }

  SphereShape ball_;
  ComposedShape shape_;
  Workpiece workpiece_;
  KnownSurface surface_;
  std::vector<Burr> burrs_;
};

TEST_F(Pareto, PosesAreAsDeepAsAskedAndFollowTheirSeed) {
  const std::vector<PressedPose> first = poses(1), again = poses(1), other = poses(2);
  ASSERT_EQ(first.size(), 12u);
  for (std::size_t p = 0; p < first.size(); ++p) {
    EXPECT_NEAR(first[p].truth.deepest_m / kVoxel, 3.0, 0.05);
    EXPECT_EQ(first[p].world_from_tool.position, again[p].world_from_tool.position);
    EXPECT_NE(first[p].world_from_tool.position, other[p].world_from_tool.position);
    // Tilted by up to 30 degrees from the ball's normal under the head.
    const Eigen::Vector3d axis = first[p].world_from_tool.direction(Eigen::Vector3d::UnitY());
    const Eigen::Vector3d head = first[p].world_from_tool.position + kHead * axis;
    EXPECT_GT(head.normalized().dot(axis), 0.866 - 1e-3);
    EXPECT_GT(head.z(), 0.0);
  }
}

TEST_F(Pareto, AFineFieldAndAGoodMethodAreNearerToTheTruth) {
  const std::vector<ParetoSetting> settings{{NormalMethod::kLdmFast, 4, 0},
                                            {NormalMethod::kLdmFast, 4, 1},
                                            {NormalMethod::kLdmFast, 1, 0}};
  const std::vector<ParetoRow> rows =
      measure_pareto(surface_, burrs_, poses(1), settings, [](const std::string&) {});
  ASSERT_EQ(rows.size(), 3u);
  for (const ParetoRow& r : rows) {
    EXPECT_GT(r.tick_us, 0.0);
    EXPECT_GT(r.normals_us, 0.0);
  }
  EXPECT_LT(rows[0].whole_pct, rows[1].whole_pct);
  EXPECT_EQ(rows[0].normal_error_deg, rows[1].normal_error_deg) << "the voxels are the same";
  EXPECT_EQ(rows[0].directions_pct, rows[1].directions_pct);
  EXPECT_LT(rows[0].normal_error_deg, 1.0);
  EXPECT_GT(rows[2].normal_error_deg, 3.0);
  EXPECT_LT(rows[0].directions_pct, rows[2].directions_pct);
}

}  // namespace
}  // namespace sulcus::lab::pareto_measurement_test
