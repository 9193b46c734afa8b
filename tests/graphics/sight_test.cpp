#include "engine/graphics/sight.hpp"

#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace sulcus::sight_test {
namespace {

using Box = Eigen::AlignedBox3d;
const Eigen::Vector3d kHalf(4e-3, 3e-3, 5e-3);
const std::vector<Box> kTooth{Box(-kHalf, Eigen::Vector3d(kHalf.x(), kHalf.y(), 0.0)),
                              Box(Eigen::Vector3d(-kHalf.x(), -kHalf.y(), 0.0), kHalf)};

Pose pose_at(double x, double y, double z) {
  Pose pose;
  pose.position = {x, y, z};
  return pose;
}

TEST(PointsToSee, LieInTheUpperHalfOrAtTheBurr) {
  const Eigen::Vector3d tip(1e-3, 2e-3, 3e-3);
  const auto points = points_to_see(Camera::kMesial, kTooth, tip);
  ASSERT_EQ(points.size(), 9u);
  Box spread;
  for (const Eigen::Vector3d& p : points) {
    EXPECT_GT(p.z(), 0.0);
    EXPECT_TRUE(kTooth[1].contains(p));
    spread.extend(p);
  }
  EXPECT_GT(spread.sizes().x(), kHalf.x());
  EXPECT_GT(spread.sizes().y(), kHalf.y());
  EXPECT_EQ(points_to_see(Camera::kBurr, kTooth, tip), std::vector<Eigen::Vector3d>{tip});
  EXPECT_TRUE(points_to_see(Camera::kReview, {}, tip).empty());
}

TEST(HiddenShare, CountsTheLinesThatABodyStandsIn) {
  const auto points = points_to_see(Camera::kMesial, kTooth, Eigen::Vector3d::Zero());
  const Eigen::Vector3d from_mesial(60e-3, 0, 0);
  auto share = [&](const Pose& pose) { return hidden_share(from_mesial, points, kTooth, pose); };
  EXPECT_EQ(share(pose_at(9e-3, 0, 0)), 1.0);
  EXPECT_EQ(share(pose_at(-9e-3, 0, 0)), 0.0);     // beyond
  EXPECT_EQ(share(pose_at(70e-3, 0, 0)), 0.0);     // behind the eye
  EXPECT_EQ(share(pose_at(9e-3, 0, -6e-3)), 0.0);  // lower: only roots are hidden
  EXPECT_EQ(share(pose_at(9e-3, 6e-3, 0)), 0.0);   // beside
  EXPECT_NEAR(share(pose_at(9e-3, 3e-3, 0)), 1.0 / 2.0, 0.2);
  EXPECT_EQ(hidden_share(from_mesial, {}, kTooth, pose_at(9e-3, 0, 0)), 0.0);
  EXPECT_EQ(hidden_share(from_mesial, points, {}, pose_at(9e-3, 0, 0)), 0.0);

  // On its side it is too low for the lines: a turn by which x and z change places.
  Pose lying = pose_at(9e-3, 0, -3.5e-3);
  EXPECT_EQ(share(lying), 0.0);
  lying.position.z() = -2.4e-3;
  EXPECT_EQ(share(lying), 1.0);
  lying.orientation = Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY());
  EXPECT_EQ(share(lying), 0.0);
}

TEST(HiddenShare, WhatIsRoundAPointDoesNotHideIt) {
  // The burr cuts the body itself, then what stands behind it.
  const Eigen::Vector3d eye(0, -20e-3, 20e-3);
  const std::vector<Eigen::Vector3d> inside{
      {0, -2e-3, -4e-3}};  // in the lower box, below the upper
  const std::vector<Eigen::Vector3d> beyond{{0, 4e-3, 1e-3}};
  EXPECT_EQ(hidden_share(eye, inside, kTooth, {}), 0.0);
  EXPECT_EQ(hidden_share(eye, beyond, kTooth, {}), 1.0);
}

}  // namespace
}  // namespace sulcus::sight_test
