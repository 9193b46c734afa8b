#include "engine/outcome/goal.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::goal_test {
namespace {

using Eigen::Vector3d;

Vector3d mm(double x, double y, double z) { return Vector3d(x, y, z) * kMillimetre; }

GoalSettings box_goal(const Vector3d& size_mm) {
  GoalSettings goal;
  goal.shape = GoalShape::kBox;
  goal.size_m = size_mm * kMillimetre;
  return goal;
}

TEST(Goal, ABoxHoldsWhatIsWithinHalfItsSize) {
  GoalSettings settings = box_goal({2, 4, 6});
  settings.position_m = mm(1, 0, 0);
  const Goal goal(settings);
  EXPECT_TRUE(goal.contains(mm(1.99, 1.99, 2.99)));
  EXPECT_TRUE(goal.contains(mm(0.01, -1.99, -2.99)));
  EXPECT_FALSE(goal.contains(mm(2.01, 0, 0)));
  EXPECT_FALSE(goal.contains(mm(1, 2.01, 0)));
  EXPECT_FALSE(goal.contains(mm(1, 0, 3.01)));
}

TEST(Goal, ACylinderStandsAlongItsZ) {
  GoalSettings settings;
  settings.shape = GoalShape::kCylinder;
  settings.diameter_m = 2 * kMillimetre;
  settings.depth_m = 3 * kMillimetre;
  const Goal goal(settings);
  EXPECT_TRUE(goal.contains(mm(0.7, 0.7, 1.49)));
  EXPECT_FALSE(goal.contains(mm(0.72, 0.72, 0)));
  EXPECT_FALSE(goal.contains(mm(0, 0, 1.51)));
}

TEST(Goal, TaperOpensTheWallsUpward) {
  GoalSettings settings = box_goal({2, 2, 2});
  settings.taper = std::atan(0.5);
  const Goal goal(settings);
  for (const double z : {-0.9, 0.0, 0.9}) {
    EXPECT_TRUE(goal.contains(mm(1 + 0.5 * z - 0.01, 0, z))) << z;
    EXPECT_FALSE(goal.contains(mm(0, 1 + 0.5 * z + 0.01, z))) << z;
  }
  settings.shape = GoalShape::kCylinder;
  settings.diameter_m = settings.depth_m = 2 * kMillimetre;
  EXPECT_TRUE(Goal(settings).contains(mm(0, 1.4, 0.9)));
  EXPECT_FALSE(Goal(settings).contains(mm(0, 0.6, -0.9)));
}

TEST(Goal, TurnsAboutXThenYThenZ) {
  GoalSettings settings = box_goal({6, 1, 1});
  settings.rotation = Vector3d(90, 0, 90) * kDegree;  // x stays, then comes to y
  const Goal goal(settings);
  EXPECT_TRUE(goal.contains(mm(0, 2.9, 0)));
  EXPECT_FALSE(goal.contains(mm(2.9, 0, 0)));
  settings.rotation = Vector3d(90, 90, 0) * kDegree;  // x stays, then comes to -z
  EXPECT_TRUE(Goal(settings).contains(mm(0, 0, 2.9)));
  EXPECT_FALSE(Goal(settings).contains(mm(0, 2.9, 0)));
  settings = box_goal({1, 1, 6});
  settings.rotation = Vector3d(90, 0, 90) * kDegree;  // z to -y, then to x
  EXPECT_TRUE(Goal(settings).contains(mm(2.9, 0, 0)));
  EXPECT_FALSE(Goal(settings).contains(mm(0, 2.9, 0)));
}

TEST(Goal, TheTargetIsEverySolidVoxelInIt) {
  const VoxelModel model = test::random_blobs({48, 40, 56}, 9, 1e-4);
  GoalSettings settings = box_goal({1.1, 2.3, 3.1});
  settings.taper = 8 * kDegree;
  settings.rotation = Vector3d(20, -35, 60) * kDegree;
  settings.position_m = mm(0.3, -0.2, 0.5);
  for (const GoalShape shape : {GoalShape::kBox, GoalShape::kCylinder}) {
    settings.shape = shape;
    settings.diameter_m = 1.7 * kMillimetre;
    settings.depth_m = 2.9 * kMillimetre;
    const Goal goal(settings);
    const VoxelSet target = target_voxels(goal, model);
    EXPECT_GT(target.count(), 100u);
    for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
      const Cell c = model.grid.cell_of_linear(v);
      EXPECT_EQ(target.contains(c), model.solid(c) && goal.contains(model.grid.centre_world(c)));
    }
  }
}

TEST(Goal, OneThatMissesTheToothIsRefused) {
  Scene scene;
  scene.file = "s.toml";
  const VoxelModel model = test::ball({32, 32, 32}, 1e-4, {15.5, 15.5, 15.5}, 10.0);
  EXPECT_FALSE(target_of_goal(scene, model, nullptr)) << "a scene without a goal";
  scene.goal = box_goal({1, 1, 1});
  EXPECT_NO_THROW((void)target_of_goal(scene, model, nullptr));
  scene.goal->position_m = mm(0, 0, 5);
  try {
    (void)target_of_goal(scene, model, nullptr);
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "s.toml: [goal]: found a goal without a voxel of the tooth, around (0 0 5) mm, "
                 "expected a target that the tooth reaches into");
  }
}

TEST(Goal, OfAFileIsWhatOfItIsTooth) {
  Scene scene;
  scene.file = "s.toml";
  scene.goal.emplace().shape = GoalShape::kFile;
  const VoxelModel tooth = test::block({32, 32, 32}, 1e-4, {0, 0, 0}, {32, 32, 16});
  const VoxelModel file = test::block({32, 32, 32}, 1e-4, {8, 8, 12}, {20, 20, 28});
  const std::optional<VoxelSet> target = target_of_goal(scene, tooth, &file);
  ASSERT_TRUE(target);
  EXPECT_EQ(target->count(), 12u * 12 * 4);
  EXPECT_TRUE(target->contains({8, 19, 15}));
  const VoxelModel above = test::block({32, 32, 32}, 1e-4, {8, 8, 16}, {20, 20, 28});
  EXPECT_THROW((void)target_of_goal(scene, tooth, &above), InputError);
}

}  // namespace
}  // namespace sulcus::goal_test
