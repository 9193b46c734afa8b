#include "engine/graphics/surface_mesh.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace sulcus {
namespace {

VoxelModel empty_model(const Eigen::Vector3i& cells, double voxel_m = 1e-4) {
  VoxelModel model;
  model.grid = {cells, voxel_m};
  model.leaves.resize(model.grid.leaf_count());
  return model;
}

template <class Inside>
VoxelModel make_model(const Eigen::Vector3i& cells, Inside inside) {
  VoxelModel model = empty_model(cells);
  for (int k = 0; k < cells.z(); ++k) {
    for (int j = 0; j < cells.y(); ++j) {
      for (int i = 0; i < cells.x(); ++i) {
        if (inside(Cell(i, j, k))) model.set(Cell(i, j, k), true);
      }
    }
  }
  return model;
}

/// Directed edges, each counted.
std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed_edges(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  return edges;
}

void expect_closed_manifold(const TriangleMesh& mesh) {
  const auto edges = directed_edges(mesh);
  int unmatched = 0;
  int repeated = 0;
  for (const auto& [edge, count] : edges) {
    const auto opposite = edges.find({edge.second, edge.first});
    unmatched += opposite == edges.end() || opposite->second != count ? 1 : 0;
    repeated += count != 1 ? 1 : 0;
  }
  EXPECT_EQ(unmatched, 0);
  EXPECT_EQ(repeated, 0);
}

double volume_m3(const TriangleMesh& mesh) {
  double six = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[t[2]].cast<double>();
    six += a.dot(b.cross(c));
  }
  return six / 6.0;
}

double area_m2(const TriangleMesh& mesh) {
  double twice = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[t[2]].cast<double>();
    twice += (b - a).cross(c - a).norm();
  }
  return twice / 2.0;
}

TEST(ClosedSurface, RandomNoiseIsClosedAndTwoManifold) {
  // Independent voxels give every one of the 256 cases, next to every other; the grid spans bricks.
  for (const double fill : {0.15, 0.5, 0.8}) {
    std::mt19937 random(7);
    std::bernoulli_distribution solid(fill);
    const VoxelModel model = make_model({24, 16, 72}, [&](const Cell&) { return solid(random); });
    const TriangleMesh mesh = closed_surface(model);
    ASSERT_GT(mesh.triangles.size(), 1000u);
    expect_closed_manifold(mesh);
  }
}

TEST(ClosedSurface, SphereHasItsVolumeAndArea) {
  const double radius = 26.3;
  const VoxelModel model = make_model({72, 64, 64}, [&](const Cell& c) {
    return (c.cast<double>() - Eigen::Vector3d(35.2, 31.4, 31.9)).norm() < radius;
  });
  const TriangleMesh mesh = closed_surface(model);
  expect_closed_manifold(mesh);
  const double r_m = radius * model.grid.voxel_m;
  EXPECT_NEAR(volume_m3(mesh) / (4.0 / 3.0 * std::numbers::pi * r_m * r_m * r_m), 1.0, 0.02);
  EXPECT_NEAR(area_m2(mesh) / (4.0 * std::numbers::pi * r_m * r_m), 1.0, 0.03);
  const Eigen::Vector3d centre = model.grid.world_from_index(Eigen::Vector3d(35.2, 31.4, 31.9));
  for (const Eigen::Vector3f& p : mesh.positions) {
    EXPECT_NEAR((p.cast<double>() - centre).norm(), r_m, model.grid.voxel_m);
  }
}

TEST(ClosedSurface, FullGridIsCappedAtItsFaces) {
  const VoxelModel model = make_model({16, 8, 24}, [](const Cell&) { return true; });
  const TriangleMesh mesh = closed_surface(model, {.tissue = {}, .smoothing_passes = 0});
  expect_closed_manifold(mesh);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) box.extend(p);
  EXPECT_NEAR(box.sizes().x(), 16e-4f, 1e-9f);
  EXPECT_NEAR(box.sizes().y(), 8e-4f, 1e-9f);
  EXPECT_NEAR(box.sizes().z(), 24e-4f, 1e-9f);
  EXPECT_LT(box.center().norm(), 1e-9f);
}

TEST(ClosedSurface, OneTissueAlone) {
  VoxelModel model = make_model(
      {16, 16, 16}, [](const Cell& c) { return (c.array() >= 2).all() && (c.array() < 14).all(); });
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    tissues->set_uniform(leaf, model.grid.leaf_origin(leaf).z() >= 8 ? 1 : 0);
  }
  model.tissues = tissues;
  const TriangleMesh mesh =
      closed_surface(model, {.tissue = std::uint8_t{1}, .smoothing_passes = 0});
  expect_closed_manifold(mesh);
  // 12 x 12 x 6 voxels, less what the chamfered edges take.
  EXPECT_NEAR(volume_m3(mesh) / (864 * model.grid.voxel_volume_m3()), 1.0, 0.06);
  EXPECT_TRUE(closed_surface(model, {.tissue = std::uint8_t{2}}).triangles.empty());
}

TEST(ClosedSurface, NothingSolidIsAnEmptyMesh) {
  const TriangleMesh mesh = closed_surface(empty_model({8, 8, 8}));
  EXPECT_TRUE(mesh.positions.empty());
  EXPECT_TRUE(mesh.triangles.empty());
}

}  // namespace
}  // namespace sulcus
