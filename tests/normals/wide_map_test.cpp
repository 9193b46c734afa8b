#include "engine/normals/wide_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::wide_map_test {
namespace {

using Eigen::Vector3d;

constexpr int kNs = 6;

/// Every other column of the plane z = 0.3 + slope . (x, y), up to x = `edge` voxels, beyond which
/// it falls off by two voxels each; heights beyond the trace are not found.
HeightMap wide_of(const Vector3d& slopes, int edge, int trace) {
  HeightMap map;
  map.ns = kNs;
  map.stride = 2;
  map.lanes = lanes_of(kNs);
  map.height.fill(HeightMap::kNone);
  for (int j = -kNs; j <= kNs; ++j) {
    for (int i = -kNs; i <= kNs; ++i) {
      const double x = 2.0 * i, y = 2.0 * j, beyond = std::max(0.0, x - edge);
      const int height =
          static_cast<int>(std::floor(0.3 + slopes.x() * x + slopes.y() * y - 2.0 * beyond));
      if (std::abs(height) > trace) continue;
      map.height[static_cast<std::size_t>(map.place(i, j))] = static_cast<signed char>(height);
    }
  }
  return map;
}

/// The plane's own closest point, turned by so many degrees.
ClosestPoint near(const Vector3d& slopes, double off_deg) {
  Vector3d normal = Vector3d(-slopes.x(), -slopes.y(), 1.0).normalized();
  const double offset = 0.3 * normal.z();
  normal =
      (normal + std::tan(off_deg * std::acos(-1.0) / 180.0) * normal.unitOrthogonal()).normalized();
  return {static_cast<float>(normal.x()), static_cast<float>(normal.y()),
          static_cast<float>(normal.z()), static_cast<float>(offset)};
}

double error_deg(const ClosestPoint& closest, const Vector3d& slopes) {
  return test::angle_deg(Vector3d(closest.normal_x, closest.normal_y, closest.normal_z),
                         Vector3d(-slopes.x(), -slopes.y(), 1.0).normalized());
}

constexpr int kNoEdge = 100;

TEST(FaceOver, IsTheFaceThatAllFoundColumnsLieOn) {
  // The second leaves the trace at its corners, so that its map is not whole.
  for (const Vector3d& slopes : {Vector3d(0.31, -0.22, 0), Vector3d(0.96, 0.076, 0)}) {
    const std::optional<ClosestPoint> face =
        extended_plane(wide_of(slopes, kNoEdge, 12), near(slopes, 2.0));
    ASSERT_TRUE(face);
    EXPECT_LT(error_deg(*face, slopes), 0.3);
    EXPECT_NEAR(face->offset, near(slopes, 0.0).offset, 0.1);
  }
}

TEST(FaceOver, IsNoneWhereOneColumnLiesOffIt) {
  const Vector3d slopes(0.31, -0.22, 0);
  for (const int edge : {11, 8, 3}) {
    EXPECT_FALSE(extended_plane(wide_of(slopes, edge, 12), near(slopes, 1.0))) << edge;
  }
}

TEST(FaceOver, IsNoneOfFewColumns) {
  // Along the diagonal of the cube three quarters of the columns are in the trace, of a steeper
  // face fewer than half.
  const Vector3d diagonal(1.04, 0.98, 0), steep(1.9, 1.9, 0);
  EXPECT_TRUE(extended_plane(wide_of(diagonal, kNoEdge, 12), near(diagonal, 0.5)));
  EXPECT_FALSE(extended_plane(wide_of(steep, kNoEdge, 12), near(steep, 0.5)));
}

TEST(FaceOver, IsNoneOfAFirstPlaneThatIsFarOffOrAlongTheColumns) {
  const Vector3d slopes(0.31, -0.22, 0);
  EXPECT_FALSE(extended_plane(wide_of(slopes, kNoEdge, 12), near(slopes, 12.0)));
  EXPECT_FALSE(extended_plane(wide_of(slopes, kNoEdge, 12), {0.99f, 0.0f, 0.14f, 0.0f}));
}

}  // namespace
}  // namespace sulcus::wide_map_test
