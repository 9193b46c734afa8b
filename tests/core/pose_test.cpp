#include "engine/core/pose.hpp"

#include <gtest/gtest.h>

namespace sulcus::pose_test {
namespace {

using Eigen::Vector3d;

const Pose kQuarterTurn{Vector3d(1, 2, 3), Eigen::Quaterniond(Eigen::AngleAxisd(
                                               1.5707963267948966, Vector3d::UnitZ()))};

TEST(Pose, PointsTurnAndMoveDirectionsOnlyTurn) {
  EXPECT_TRUE(kQuarterTurn.point(Vector3d(1, 0, 0)).isApprox(Vector3d(1, 3, 3), 1e-15));
  EXPECT_TRUE(kQuarterTurn.direction(Vector3d(1, 0, 0)).isApprox(Vector3d(0, 1, 0), 1e-15));
}

TEST(Pose, InverseGoesBack) {
  const Vector3d p(0.3, -0.7, 2.5);
  EXPECT_TRUE(kQuarterTurn.inverse_point(kQuarterTurn.point(p)).isApprox(p, 1e-15));
  EXPECT_TRUE(kQuarterTurn.inverse_direction(kQuarterTurn.direction(p)).isApprox(p, 1e-15));
}

}  // namespace
}  // namespace sulcus::pose_test
