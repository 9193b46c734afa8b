#include "tools/sulcus_lab/fractions/surface_error.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/triangle_mesh.hpp"

namespace sulcus::lab::surface_error_test {
namespace {

using Eigen::Vector3d;

/// A square of 2 x 1 m in z = `height`, of 40 x 20 squares of two triangles each.
TriangleMesh sheet(float height) {
  TriangleMesh mesh;
  constexpr std::uint32_t kAlong = 40, kAcross = 20;
  for (std::uint32_t j = 0; j <= kAcross; ++j) {
    for (std::uint32_t i = 0; i <= kAlong; ++i) {
      mesh.positions.emplace_back(0.05f * static_cast<float>(i), 0.05f * static_cast<float>(j),
                                  height);
    }
  }
  for (std::uint32_t j = 0; j < kAcross; ++j) {
    for (std::uint32_t i = 0; i < kAlong; ++i) {
      const std::uint32_t a = i + (kAlong + 1) * j, b = a + kAlong + 1;
      mesh.triangles.push_back({a, a + 1, b});
      mesh.triangles.push_back({a + 1, b + 1, b});
    }
  }
  return mesh;
}

/// The plane z = 0, its half x > 1 in a zone of its own; y > 0.5 is not to be measured.
KnownBody ground() {
  KnownBody body;
  body.zones = {"left", "right"};
  body.voxel_m = 0.1;
  body.distance = [](const Vector3d& p) -> KnownDistance {
    if (p.y() > 0.5) return {std::numeric_limits<double>::quiet_NaN(), 0};
    return {p.z(), p.x() > 1.0 ? 1 : 0};
  };
  return body;
}

TEST(SurfaceError, IsInVoxelsByArea) {
  const std::vector<SurfaceSum> sums = surface_sums(sheet(0.02f), ground());
  ASSERT_EQ(sums.size(), 2u);
  for (const SurfaceSum& sum : sums) {
    EXPECT_NEAR(sum.area_m2, 0.5, 1e-6);
    EXPECT_NEAR(std::sqrt(sum.squares_m2 / sum.area_m2), 0.2, 1e-6);
  }
}

TEST(SurfaceError, OfASlopeIsItsRootMeanSquare) {
  TriangleMesh mesh = sheet(0.0f);
  for (Eigen::Vector3f& p : mesh.positions) p.z() = 0.1f * p.x();
  const SurfaceSum left = surface_sums(mesh, ground())[0];
  // From 0 to a voxel at x = 1.
  EXPECT_NEAR(std::sqrt(left.squares_m2 / left.area_m2), 1.0 / std::sqrt(3.0), 1e-3);
}

/// A voxel is solid where the distance of its centre says so.
TEST(KnownBodies, AreWhereTheySay) {
  std::mt19937 random(4);
  int planes = 0;
  for (const KnownBody& body : known_bodies(true)) {
    SCOPED_TRACE(body.name);
    planes += body.name == "planes" ? 1 : 0;
    const VoxelModel model = body.model(SurfaceKind::kBinary);
    std::uniform_int_distribution<std::uint32_t> any_voxel(
        0, static_cast<std::uint32_t>(model.grid.cell_count()) - 1);
    std::vector<int> near(body.zones.size(), 0);
    int wrong = 0;
    for (int n = 0; n < 100000; ++n) {
      const Cell c = model.grid.cell_of_linear(any_voxel(random));
      const KnownDistance at = body.distance(model.grid.centre_world(c));
      if (!std::isfinite(at.off_m)) continue;
      wrong += model.solid(c) == (at.off_m <= 0.0) ? 0 : 1;
      near[static_cast<std::size_t>(at.zone)] += std::abs(at.off_m) < body.voxel_m ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0);
    for (const int count : near) EXPECT_GT(count, 100);
  }
  EXPECT_EQ(planes, 20);
}

/// A ball's exported and drawn meshes: closed, and of its area.
TEST(KnownBodies, HaveMeshesOfTheirArea) {
  const KnownBody ball = known_bodies(true).front();
  const double radius_m = 50.0 * ball.voxel_m;
  const VoxelModel model = ball.model(SurfaceKind::kFractions);
  for (const TriangleMesh& mesh : {exported_mesh(model), drawn_mesh(model)}) {
    const SurfaceSum sum = surface_sums(mesh, ball)[0];
    EXPECT_NEAR(sum.area_m2 / (4.0 * std::numbers::pi * radius_m * radius_m), 1.0, 2e-3);
    EXPECT_LT(std::sqrt(sum.squares_m2 / sum.area_m2), 0.03);
  }
}

}  // namespace
}  // namespace sulcus::lab::surface_error_test
