#include "app/window/held_burr.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "app/window/burr_lift.hpp"
#include "engine/scene/scene.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::held_burr_test {
namespace {

constexpr double kVoxel_m = 50e-6, kRadius_m = 0.4e-3;

const Burr& ball() {
  static const Burr kBall = [] {
    BurrSettings settings;
    settings.shape = BurrShape::kRound;
    settings.diameter_m = 2.0 * kRadius_m;
    return make_burr(settings, kVoxel_m);
  }();
  return kBall;
}

/// A burr whose axis points up, with its tip there.
Pose upright(const Eigen::Vector3d& tip) {
  return {tip, Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX()))};
}

/// By all voxels: the least distance of a centre from the ball of the head.
double truth(const VoxelModel& model, const Pose& tool) {
  const Eigen::Vector3d middle = tool.point({0.0, kRadius_m, 0.0});
  double least = 1.0;
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if (!model.solid(c)) continue;
    least = std::min(least, (model.grid.centre_world(c) - middle).norm() - kRadius_m);
  }
  return least;
}

/// A floor with a wall on three of a hole's sides, as wide as the burr.
VoxelModel tooth_with_hole() {
  return test::make_model({64, 64, 64}, kVoxel_m, [](const Cell& c) {
    const double x = c.x() - 31.5, y = c.y() - 31.5;
    const bool hole = std::hypot(x, y) < 8.6 && c.z() > 20;
    return c.z() < 44 && !hole;
  });
}

TEST(RoomRound, IsTheLeastOverAllVoxels) {
  const VoxelModel tooth = tooth_with_hole();
  for (const Eigen::Vector3d& tip :
       {Eigen::Vector3d(0, 0, 0.7e-3), Eigen::Vector3d(0.2e-3, 0, 0.9e-3),
        Eigen::Vector3d(0, 0, -0.1e-3)}) {
    const Pose tool = upright(tip);
    const double room = room_round(tooth, ball(), tool, 0.4e-3);
    const double least = std::min(0.4e-3, truth(tooth, tool));
    EXPECT_GT(room, least - 5e-6);
    EXPECT_LT(room, std::max(least + 5e-6, 1.1 * least));
  }
}

TEST(DrawnBack, LeavesAHoleAlongTheBurrsAxis) {
  const VoxelModel tooth = tooth_with_hole();
  const Pose tool = upright({0, 0, -0.55e-3});  // on its floor
  ASSERT_LT(truth(tooth, tool), 0.05e-3);
  const auto back = drawn_back(tooth, ball(), tool, 0.3e-3);
  ASSERT_TRUE(back);
  EXPECT_GE(truth(tooth, *back), 0.3e-3 - 5e-6);
  EXPECT_LT((back->position - tool.position).head<2>().norm(), 1e-12);
  EXPECT_GT(back->position.z(), tool.position.z());
  EXPECT_EQ(back->orientation.coeffs(), tool.orientation.coeffs());
}

TEST(DrawnBack, GoesAcrossWhereAnOverhangIsInTheWay) {
  // A floor and a roof, open towards +x.
  const VoxelModel tooth = test::make_model({64, 64, 64}, kVoxel_m, [](const Cell& c) {
    return c.x() < 40 && (c.z() < 20 || (c.z() > 44 && c.z() < 60));
  });
  const Pose tool = upright({0, 0, -0.6e-3});
  ASSERT_LT(truth(tooth, tool), 0.1e-3);
  const auto back = drawn_back(tooth, ball(), tool, 0.2e-3);
  ASSERT_TRUE(back);
  EXPECT_GE(truth(tooth, *back), 0.2e-3 - 5e-6);
  // Straight, and never deeper in the solid than it was.
  for (int part = 0; part <= 20; ++part) {
    Pose pose = tool;
    pose.position += 0.05 * part * (back->position - tool.position);
    EXPECT_GT(truth(tooth, pose), -kVoxel_m);
  }
}

TEST(DrawnBack, StaysWhereNoWayLeadsOut) {
  const VoxelModel closed = test::make_model({64, 64, 64}, kVoxel_m, [](const Cell& c) {
    return (c.cast<double>() - Eigen::Vector3d::Constant(31.5)).norm() > 9.0;
  });
  EXPECT_FALSE(drawn_back(closed, ball(), upright({0, 0, -kRadius_m}), 0.3e-3));
}

TEST(HeldBurr, IsLiftedWhenLetGoAndSetDownWhereItWas) {
  const VoxelModel tooth = tooth_with_hole();
  const View view = make_view(Camera::kBuccal, {}, {}, 1e-3, 640, 360);
  const Pose tool = upright({0, 0, -0.55e-3});
  HeldBurr burr(upright({0, 0, 2e-3}));
  WindowInput input;
  input.left = true;
  input.drag = {0.0, -0.1};
  EXPECT_TRUE(burr.follow(input, view, 360, burr.pose(), tooth, ball()));
  const Pose hand = burr.pose();  // wherever: the tooth holds the burr back from it
  input.drag.setZero();
  EXPECT_FALSE(burr.follow(input, view, 360, tool, tooth, ball()));
  input.left = false;
  EXPECT_TRUE(burr.follow(input, view, 360, tool, tooth, ball()));
  EXPECT_TRUE(burr.is_lifted());
  EXPECT_GE(truth(tooth, burr.pose()), 0.4e-3 - 5e-6);
  EXPECT_NE(burr.pose().position, hand.position);
  EXPECT_FALSE(burr.follow(input, view, 360, tool, tooth, ball())) << "stays";
  input.left = true;
  EXPECT_TRUE(burr.follow(input, view, 360, burr.pose(), tooth, ball()));
  EXPECT_EQ(burr.pose().position, tool.position);
}

TEST(HeldBurr, InFreeAirItStays) {
  const VoxelModel tooth = tooth_with_hole();
  const View view = make_view(Camera::kBuccal, {}, {}, 1e-3, 640, 360);
  HeldBurr burr(upright({0, 0, 2e-3}));
  WindowInput input;
  input.left = true;
  burr.follow(input, view, 360, burr.pose(), tooth, ball());
  input.left = false;
  EXPECT_FALSE(burr.follow(input, view, 360, burr.pose(), tooth, ball()));
  EXPECT_FALSE(burr.is_lifted());
}

}  // namespace
}  // namespace sulcus::held_burr_test
