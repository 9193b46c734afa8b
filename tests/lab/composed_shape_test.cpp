#include "tools/sulcus_lab/truth/composed_shape.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace sulcus::lab::composed_shape_test {
namespace {

using Eigen::Vector3d;

Eigen::AlignedBox3d bounds(double half) {
  return {Vector3d::Constant(-half), Vector3d::Constant(half)};
}

/// A ball of radius 10 with a flat side at z = 4 and a channel through it.
ComposedShape drilled_ball() {
  return {{side_of(SphereShape(10.0), "ball"), half_space({0, 0, 4}, Vector3d::UnitZ()),
           outside_capsule({-20, 3, 0}, {20, 3, 0}, 2.0, "channel")},
          bounds(10)};
}

Vector3d random_point(std::mt19937& random, double half) {
  std::uniform_real_distribution<double> along(-half, half);
  const double x = along(random), y = along(random), z = along(random);
  return {x, y, z};
}

TEST(ComposedShape, IsSolidWhereAllItsSidesAre) {
  const ComposedShape shape = drilled_ball();
  EXPECT_LT(shape.value({0, -4, 0}), 0.0);
  EXPECT_GT(shape.value({0, 3, 0}), 0.0) << "in the channel";
  EXPECT_GT(shape.value({0, -3, 5}), 0.0) << "above the flat side";
  EXPECT_GT(shape.value({0, -11, 0}), 0.0) << "outside the ball";
}

TEST(ComposedShape, FootIsTheNearestPointOfTheSurface) {
  const ComposedShape shape = drilled_ball();
  std::mt19937 random(7);
  int tested = 0;
  while (tested < 300) {
    const Vector3d p = random_point(random, 10.0);
    if (shape.value(p) > -0.05) continue;
    ++tested;
    const ComposedShape::ClosestPoint closest = shape.closest_point(p);
    const double distance = (closest.point - p).norm();
    EXPECT_NEAR(shape.value(closest.point), 0.0, 1e-9);
    EXPECT_NEAR((closest.point - p).dot(closest.normal), distance, 1e-9) << "straight out";
    // Nothing within that distance is outside of the solid.
    for (int n = 0; n < 200; ++n) {
      const Vector3d d = random_point(random, 1.0);
      if (d.norm() > 1.0) continue;
      EXPECT_LT(shape.value(p + 0.999 * distance * d), 0.0);
    }
  }
}

TEST(ComposedShape, FootFollowsAFunctionThatIsNoDistance) {
  // An ellipsoid; the closest point to a point on the longest axis near its end, worked out by
  // hand: for a = 8, b = 4 the centre of curvature there is at 8 - 16/8 = 6, and beyond it the end
  // is nearest.
  const Vector3d axes(8, 4, 4);
  Side side;
  side.value = [=](const Vector3d& p) { return 4.0 * (p.cwiseQuotient(axes).norm() - 1.0); };
  side.gradient = [=](const Vector3d& p) -> Vector3d {
    const Vector3d q = p.cwiseQuotient(axes);
    return 4.0 / q.norm() * q.cwiseQuotient(axes);
  };
  const ComposedShape shape({side}, bounds(8));
  const ComposedShape::ClosestPoint end = shape.closest_point({6.8, 0, 0});
  EXPECT_NEAR((end.point - Vector3d(8, 0, 0)).norm(), 0.0, 1e-6);
  const ComposedShape::ClosestPoint closest = shape.closest_point({5.0, 2.5, 0.3});
  EXPECT_NEAR(shape.value(closest.point), 0.0, 1e-9);
  const Vector3d out = closest.point - Vector3d(5.0, 2.5, 0.3);
  EXPECT_LT(out.cross(closest.normal).norm(), 1e-3 * out.norm());
}

TEST(ComposedShape, EdgeDistanceIsToWhereTwoSidesMeet) {
  const ComposedShape shape(
      {half_space({5, 0, 0}, Vector3d::UnitX()), half_space({0, 5, 0}, Vector3d::UnitY())},
      bounds(5));
  const ComposedShape::ClosestPoint closest = shape.closest_point({4.5, 2.0, 1.0});
  EXPECT_EQ(closest.side, 0u);
  ASSERT_TRUE(shape.edge_distance(closest, 10.0));
  EXPECT_NEAR(*shape.edge_distance(closest, 10.0), 3.0, 1e-9);
  EXPECT_FALSE(shape.edge_distance(closest, 2.9));
}

TEST(ComposedShape, NoEdgeWhereAThirdSideTookItAway) {
  // The two planes meet at x = y = 5, beyond the third.
  const ComposedShape shape(
      {half_space({5, 0, 0}, Vector3d::UnitX()), half_space({0, 5, 0}, Vector3d::UnitY()),
       half_space({2, 2, 0}, Vector3d(1, 1, 0).normalized())},
      bounds(5));
  const ComposedShape::ClosestPoint closest{{5, -1, 0}, Vector3d::UnitX(), 0};
  ASSERT_TRUE(shape.edge_distance(closest, 10.0));
  EXPECT_NEAR(*shape.edge_distance(closest, 10.0), 0.0, 1e-9) << "the third side passes there";
  const ComposedShape::ClosestPoint below{{5, -4, 0}, Vector3d::UnitX(), 0};
  EXPECT_NEAR(*shape.edge_distance(below, 10.0), 3.0, 1e-9) << "not 9, to the second side";
}

TEST(ComposedShape, GradientsAreThoseOfTheValues) {
  const ComposedShape shape = drilled_ball();
  std::mt19937 random(3);
  for (const Side& side : shape.sides()) {
    for (int n = 0; n < 50; ++n) {
      const Vector3d p = random_point(random, 9.0);
      Vector3d slope;
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d h = 1e-6 * Vector3d::Unit(axis);
        slope[axis] = (side.value(p + h) - side.value(p - h)) / 2e-6;
      }
      EXPECT_LT((slope - side.gradient(p)).norm(), 1e-5);
    }
  }
}

}  // namespace
}  // namespace sulcus::lab::composed_shape_test
