#include "engine/assessment/ray_stack.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/assessment/ray_mask.hpp"
#include "tests/assessment/turned_solid.hpp"

namespace sulcus::ray_stack_test {
namespace {

/// In mm.
TriangleMesh cone_in_mm() {
  TriangleMesh mesh =
      test::turned_mesh({{0, 0}, {3, 0}, {1, 5}, {0, 5}}, 96, Eigen::Affine3d::Identity());
  transform(Eigen::Affine3d(Eigen::Scaling(1e3)), mesh);
  return mesh;
}

TEST(RayStack, GoesInAndOutWhereTheSurfaceIs) {
  const RayLattice lattice{{-4, -4}, 0.05, 161, 161};
  const RayStack stack(cone_in_mm(), lattice);
  double volume = 0.0;
  for (std::size_t place = 0; place < lattice.size(); ++place) {
    const double r = lattice.at_mm(place).norm();
    for (const RayStack::Span& span : stack.spans(place)) {
      volume += (span.top_mm - span.bottom_mm) * 0.0025;
      EXPECT_NEAR(span.bottom_mm, 0.0, 1e-6);
      EXPECT_NEAR(span.top_mm, std::min(5.0, (3.0 - r) * 2.5), 0.01);
    }
    EXPECT_EQ(stack.spans(place).empty(), r > 2.999) << r;
  }
  EXPECT_NEAR(volume, std::numbers::pi * 5.0 / 3.0 * (9 + 3 + 1), 0.2);
}

// Edges and corners exactly on the rays, on a lattice that they share, and a mesh whose triangles
// share no corner: each ray is met once.
TEST(RayStack, NoRayLeaksThroughAnEdge) {
  const Eigen::Vector3f o(0, 0, 0);
  TriangleMesh mesh;
  const auto face = [&](Eigen::Vector3f a, Eigen::Vector3f b, Eigen::Vector3f c,
                        Eigen::Vector3f d) {
    const auto at = static_cast<std::uint32_t>(mesh.positions.size());
    for (const auto& p : {a, b, c, a, c, d}) mesh.positions.emplace_back(p + o);
    mesh.triangles.push_back({at, at + 1, at + 2});
    mesh.triangles.push_back({at + 3, at + 4, at + 5});
  };
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      face({fx, fy, 2}, {fx + 1, fy, 2}, {fx + 1, fy + 1, 2}, {fx, fy + 1, 2});
      face({fx, fy, 0}, {fx, fy + 1, 0}, {fx + 1, fy + 1, 0}, {fx + 1, fy, 0});
    }
  }
  const RayLattice lattice{{0, 0}, 0.25, 17, 17};
  const RayStack stack(mesh, lattice);
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 17; ++x) {
      const auto spans = stack.spans(lattice.place(x, y));
      if (x > 0 && y > 0 && x < 16 && y < 16) {
        ASSERT_EQ(spans.size(), 1u) << x << " " << y;
        EXPECT_EQ(spans[0].bottom_mm, 0.0);
        EXPECT_EQ(spans[0].top_mm, 2.0);
      } else {
        EXPECT_LE(spans.size(), 1u);
      }
    }
  }
}

TEST(RayStack, WhatIsLeftOfSpans) {
  const std::vector<RayStack::Span> a{{0, 4}, {6, 10}}, b{{1, 2}, {3.98, 7}, {9, 12}};
  const auto left = without(a, b, 0.05);
  ASSERT_EQ(left.size(), 3u);
  EXPECT_EQ(left[0].top_mm, 1.0);
  EXPECT_EQ(left[1].bottom_mm, 2.0);
  EXPECT_EQ(left[1].top_mm, 3.98);
  EXPECT_EQ(left[2].bottom_mm, 7.0);
  EXPECT_EQ(without(a, b, 1.5).size(), 2u);
}

TEST(RayMask, DistancesAreThoseOfBruteForce) {
  const RayLattice lattice{{0, 0}, 0.5, 37, 23};
  std::mt19937 random(3);
  RayMask set(lattice.size());
  for (int i = 0; i < 9; ++i) set[random() % set.size()] = 1;
  const std::vector<double> found = distances_to(set, lattice);
  for (std::size_t i = 0; i < set.size(); ++i) {
    double least = 1e9;
    for (std::size_t j = 0; j < set.size(); ++j) {
      if (set[j]) least = std::min(least, (lattice.at_mm(i) - lattice.at_mm(j)).norm());
    }
    EXPECT_NEAR(found[i], least, 1e-12);
  }
  EXPECT_TRUE(std::isinf(distances_to(RayMask(lattice.size()), lattice)[5]));
}

TEST(RayMask, OpeningTakesWhatIsNarrowAndLeavesWhatIsWide) {
  const RayLattice lattice{{0, 0}, 1.0, 30, 30};
  RayMask set(lattice.size());
  for (int y = 5; y < 25; ++y) {
    for (int x = 5; x < 25; ++x) set[lattice.place(x, y)] = x < 15 || y == 12;
  }
  const RayMask left = opened(set, 2.5, lattice);
  EXPECT_TRUE(left[lattice.place(10, 12)]);
  EXPECT_FALSE(left[lattice.place(20, 12)]);
  ASSERT_EQ(components(left, 1, lattice).size(), 1u);
  EXPECT_GT(components(left, 1, lattice)[0].size(), 190u);
}

}  // namespace
}  // namespace sulcus::ray_stack_test
