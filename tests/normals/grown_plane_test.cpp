#include "engine/normals/grown_plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::grown_plane_test {
namespace {

using Eigen::Vector3d;

constexpr int kNs = 6;

/// Heights of the face z = c0 + c1 i + c2 j up to i = `edge`, beyond which it falls off by two
/// voxels a column.
HeightMap map_of(double c0, double c1, double c2, int edge) {
  HeightMap map;
  map.ns = kNs;
  map.lanes = lanes_of(kNs);
  map.height.fill(HeightMap::kNone);
  for (int j = -kNs; j <= kNs; ++j) {
    for (int i = -kNs; i <= kNs; ++i) {
      const double beyond = std::max(0, i - edge);
      map.height[static_cast<std::size_t>(map.place(i, j))] =
          static_cast<signed char>(std::floor(c0 + c1 * i + c2 * j - (2.0 + c1) * beyond));
    }
  }
  return map;
}

Vector3d normal_of(double c1, double c2) { return Vector3d(-c1, -c2, 1.0).normalized(); }

ClosestPoint closest_point_of(const Vector3d& normal, double offset) {
  return {static_cast<float>(normal.x()), static_cast<float>(normal.y()),
          static_cast<float>(normal.z()), static_cast<float>(offset)};
}

/// A plane two degrees and a tenth of a voxel off.
ClosestPoint roughly(double c0, double c1, double c2) {
  const Vector3d normal = normal_of(c1, c2);
  const Vector3d off = Eigen::AngleAxisd(2.0 * std::numbers::pi / 180.0,
                                         normal.cross(Vector3d(0.3, -0.7, 0.2)).normalized()) *
                       normal;
  return closest_point_of(off, c0 * normal.z() + 0.1);
}

template <class Each>
void for_planes(const Each& each) {
  for (int k = 0; k < 200; ++k) {
    // Slopes all around, none so level that a map shows a step or two.
    const double size = 0.15 + 0.75 * std::sqrt((k + 0.5) / 200.0), angle = 2.399963 * k;
    each(0.13 + 0.0731 * (k % 11), size * std::cos(angle), size * std::sin(angle));
  }
}

TEST(GrownPlane, ReachesUpToTheEdgeAndNotBeyond) {
  for (const int edge : {2, 4, kNs}) {
    double sum = 0.0, offsets = 0.0;
    int planes = 0;
    for_planes([&](double c0, double c1, double c2) {
      const auto face =
          grow_plane(map_of(c0, c1, c2, edge), roughly(c0, c1, c2), 40, PlaneStart::kFit);
      ASSERT_TRUE(face) << c0 << " " << c1 << " " << c2;
      const Vector3d normal(face->normal_x, face->normal_y, face->normal_z);
      EXPECT_NEAR(normal.norm(), 1.0, 1e-5);
      const double deg = test::angle_deg(normal, normal_of(c1, c2));
      EXPECT_LT(deg, 3.0) << c0 << " " << c1 << " " << c2;
      sum += deg;
      offsets += std::abs(face->offset - c0 * normal_of(c1, c2).z());
      ++planes;
    });
    std::printf("grown plane, edge at %d: mean %.3f deg, offset %.4f\n", edge, sum / planes,
                offsets / planes);
    EXPECT_LT(sum / planes, 0.35) << "least squares alone has twice that";
    EXPECT_LT(offsets / planes, 0.03);
  }
}

TEST(GrownPlane, OverEveryOtherColumnItIsTheSamePlaneSeenFarther) {
  double sum = 0.0, wide_sum = 0.0;
  int planes = 0;
  for_planes([&](double c0, double c1, double c2) {
    HeightMap wide = map_of(c0, 2.0 * c1, 2.0 * c2, kNs);
    wide.stride = 2;
    for (const bool is_wide : {false, true}) {
      const HeightMap& map = is_wide ? wide : map_of(c0, c1, c2, kNs);
      const HeightPlane first = plane_through(roughly(c0, c1, c2), map.stride, 0.8f);
      PlaneGrowth growth{&map, first, 150, PlaneStart::kFit, {}};  // of 169 columns
      grow_planes({&growth, 1});
      const std::optional<ClosestPoint>& face = growth.closest;
      ASSERT_TRUE(face) << c0 << " " << c1 << " " << c2;
      const Vector3d normal(face->normal_x, face->normal_y, face->normal_z);
      EXPECT_NEAR(normal.norm(), 1.0, 1e-5);
      (is_wide ? wide_sum : sum) += test::angle_deg(normal, normal_of(c1, c2));
    }
    ++planes;
  });
  std::printf("grown plane: mean %.3f deg, over every other column %.3f\n", sum / planes,
              wide_sum / planes);
  EXPECT_LT(wide_sum, 0.65 * sum) << "half of it or so, as it sees twice as far";
}

TEST(GrownPlane, ThoseThatGrowTogetherAreThoseThatGrowAlone) {
  std::vector<HeightMap> maps;
  std::vector<PlaneGrowth> growths;
  for_planes([&](double c0, double c1, double c2) {
    maps.push_back(map_of(c0, c1, c2, static_cast<int>(maps.size() % 7)));
  });
  for (std::size_t k = 0; k < maps.size(); ++k) {
    maps[k].stride = k % 5 == 0 ? 2 : 1;
    const double slope = 0.1 * static_cast<double>(k % 9);
    growths.push_back({&maps[k],
                       plane_to_grow(maps[k], roughly(0.3, slope, -0.4)),
                       static_cast<int>(k % 120),
                       k % 3 != 0 ? PlaneStart::kFit : PlaneStart::kAsGiven,
                       {}});
  }
  int grown = 0, none = 0;
  for (std::size_t first = 0; first + kMostGrowths <= growths.size(); first += kMostGrowths) {
    grow_planes(std::span(growths).subspan(first, kMostGrowths));
    for (std::size_t k = first; k < first + kMostGrowths; ++k) {
      PlaneGrowth alone = growths[k];
      grow_planes({&alone, 1});
      ASSERT_EQ(alone.closest.has_value(), growths[k].closest.has_value());
      (alone.closest ? grown : none) += 1;
      if (!alone.closest) continue;
      EXPECT_EQ(alone.closest->normal_x, growths[k].closest->normal_x);
      EXPECT_EQ(alone.closest->normal_y, growths[k].closest->normal_y);
      EXPECT_EQ(alone.closest->normal_z, growths[k].closest->normal_z);
      EXPECT_EQ(alone.closest->offset, growths[k].closest->offset);
    }
  }
  EXPECT_GT(grown, 20);
  EXPECT_GT(none, 20);
}

TEST(GrownPlane, NeedsItsColumns) {
  const HeightMap map = map_of(0.4, 0.3, -0.2, 2);
  const ClosestPoint first = roughly(0.4, 0.3, -0.2);
  // Nine columns of thirteen are on the face, and some that have only begun to fall off.
  EXPECT_TRUE(grow_plane(map, first, 117, PlaneStart::kFit));
  EXPECT_FALSE(grow_plane(map, first, 140, PlaneStart::kFit));
  EXPECT_FALSE(grow_plane(map, closest_point_of(normal_of(0.3, -0.2), 9.0), 1, PlaneStart::kFit))
      << "nothing on it";
}

TEST(GrownPlane, WallsAlongTheColumnsHaveNone) {
  const HeightMap map = map_of(0.4, 0.0, 0.0, kNs);
  EXPECT_FALSE(grow_plane(map, closest_point_of(Vector3d(0.99, 0.0, 0.141).normalized(), 0.3), 1,
                          PlaneStart::kFit));
}

}  // namespace
}  // namespace sulcus::grown_plane_test
