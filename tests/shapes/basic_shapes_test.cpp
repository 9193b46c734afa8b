#include "engine/shapes/basic_shapes.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/units.hpp"

namespace sulcus::basic_shapes_test {
namespace {

using Eigen::Vector3d;

const SphereShape kSphere(3e-3);
const BoxShape kBox(Vector3d(2e-3, 4e-3, 6e-3));
const PlateShape kPlate(1e-3, 20.0 * kDegree);
const TorusShape kTorus(3e-3, 1e-3);
const GrooveShape kGroove(90.0 * kDegree, 1e-3);

template <class Test>
void for_each_shape(Test test) {
  test(kSphere);
  test(kBox);
  test(kPlate);
  test(kTorus);
  test(kGroove);
}

std::vector<Vector3d> scattered_points(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> along(-6e-3, 6e-3);
  std::vector<Vector3d> points;
  for (int n = 0; n < count; ++n) {
    points.emplace_back(along(random), along(random), along(random));
  }
  return points;
}

TEST(Shapes, SurfacesLieWhereTheyShould) {
  EXPECT_DOUBLE_EQ(kSphere.value({0, 0, 3e-3}), 0.0);
  EXPECT_DOUBLE_EQ(kSphere.value({0, 0, 0}), -3e-3);
  EXPECT_DOUBLE_EQ(kBox.value({1e-3, 0, 0}), 0.0);
  EXPECT_DOUBLE_EQ(kBox.value({0, 0, 0}), -1e-3);
  EXPECT_DOUBLE_EQ(kBox.value({4e-3, 6e-3, 0}), 5e-3);  // 3-4-5 beyond an edge
  EXPECT_NEAR(
      kPlate.value(0.5e-3 * Vector3d(std::sin(20.0 * kDegree), 0, std::cos(20.0 * kDegree))), 0.0,
      1e-15);
  EXPECT_DOUBLE_EQ(kPlate.value({0, 5e-3, 0}), -0.5e-3);
  EXPECT_DOUBLE_EQ(kTorus.value({3e-3, 0, 1e-3}), 0.0);
  EXPECT_DOUBLE_EQ(kTorus.value({0, 0, 0}), 2e-3);
  EXPECT_NEAR(kGroove.value({0, 0, -1e-3}), 0.0, 1e-15);                // the bottom edge
  EXPECT_NEAR(kGroove.value({7e-3, 0.5e-3, -0.5e-3}), 0.0, 1e-15);      // a wall of a right angle
  EXPECT_NEAR(kGroove.value({0, 3e-3, -0.2e-3}), -0.2e-3, 1e-15);       // under the flat face
  EXPECT_NEAR(kGroove.value({0, 0, -2e-3}), -1e-3, 1e-15);              // under the bottom edge
  EXPECT_NEAR(kGroove.value({0, 0, 0}), std::sqrt(0.5) * 1e-3, 1e-15);  // in the groove
}

TEST(Shapes, GradientsAreUnitAndThoseOfTheValues) {
  constexpr double kStep = 1e-8;  // m
  for_each_shape([&](const auto& shape) {
    int compared = 0;
    for (const Vector3d& p : scattered_points(2000)) {
      const Vector3d gradient = shape.gradient(p);
      EXPECT_NEAR(gradient.norm(), 1.0, 1e-12);
      // Where the nearest point changes within a step there is no derivative.
      bool smooth = true;
      Vector3d difference;
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d step = kStep * Vector3d::Unit(axis);
        smooth &= (shape.gradient(p + step) - shape.gradient(p - step)).norm() < 1e-3;
        difference[axis] = (shape.value(p + step) - shape.value(p - step)) / (2.0 * kStep);
      }
      if (!smooth) continue;
      ++compared;
      ASSERT_LT((gradient - difference).norm(), 1e-6) << p.transpose();
    }
    EXPECT_GT(compared, 1900);
  });
}

TEST(Shapes, ValueIsTheDistanceToTheSurface) {
  // Going the distance along the gradient arrives on the surface; the bound then makes it nearest.
  for_each_shape([&](const auto& shape) {
    const std::vector<Vector3d> points = scattered_points(2000);
    for (std::size_t n = 1; n < points.size(); ++n) {
      const Vector3d& p = points[n];
      const double value = shape.value(p);
      EXPECT_NEAR(shape.value(p - value * shape.gradient(p)), 0.0, 1e-12) << p.transpose();
      EXPECT_LE(std::abs(value - shape.value(points[n - 1])),
                shape.lipschitz() * (p - points[n - 1]).norm() + 1e-15);
    }
  });
}

TEST(Shapes, GradientOnTheSurfaceIsTheOutwardNormal) {
  EXPECT_EQ(kSphere.gradient({0, -3e-3, 0}), -Vector3d::UnitY());
  EXPECT_EQ(kBox.gradient({0, 0, -3e-3}), -Vector3d::UnitZ());
  EXPECT_EQ(kTorus.gradient({-4e-3, 0, 0}), -Vector3d::UnitX());
  EXPECT_EQ(kGroove.gradient({0, 4e-3, 0}), Vector3d::UnitZ());
  const double root = std::numbers::sqrt2 / 2.0;
  EXPECT_LT((kGroove.gradient({0, 0.5e-3, -0.5e-3}) - Vector3d(0, -root, root)).norm(), 1e-12);
  EXPECT_LT((kGroove.gradient({0, -0.5e-3, -0.5e-3}) - Vector3d(0, root, root)).norm(), 1e-12);
}

TEST(Shapes, DegeneratePointsHaveAUnitGradient) {
  EXPECT_EQ(kSphere.gradient(Vector3d::Zero()).norm(), 1.0);
  EXPECT_EQ(kTorus.gradient(Vector3d::Zero()).norm(), 1.0);
  EXPECT_EQ(kTorus.gradient({3e-3, 0, 0}).norm(), 1.0);
  EXPECT_EQ(kGroove.gradient({0, 0, -1e-3}).norm(), 1.0);
  EXPECT_EQ(kGroove.gradient({0, 1e-3, 0}).norm(), 1.0);
}

TEST(Shapes, AreOfOnePartAndBounded) {
  for_each_shape([](const auto& shape) {
    EXPECT_EQ(shape.parts_within(Vector3d::Zero(), 1.0, PartSet::all()),
              PartSet::only(Part::kEnamel));
  });
  EXPECT_TRUE(kSphere.bounds().isApprox({Vector3d::Constant(-3e-3), Vector3d::Constant(3e-3)}));
  EXPECT_TRUE(kBox.bounds().isApprox({Vector3d(-1e-3, -2e-3, -3e-3), Vector3d(1e-3, 2e-3, 3e-3)}));
  EXPECT_TRUE(
      kTorus.bounds().isApprox({Vector3d(-4e-3, -4e-3, -1e-3), Vector3d(4e-3, 4e-3, 1e-3)}));
  EXPECT_EQ(kPlate.bounds().sizes().y(), 0.0);  // endless, so nothing clips it
  EXPECT_EQ(kGroove.bounds().sizes().x(), 0.0);
  EXPECT_DOUBLE_EQ(kGroove.bounds().sizes().z(), 1e-3);
}

}  // namespace
}  // namespace sulcus::basic_shapes_test
