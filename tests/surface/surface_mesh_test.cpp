#include "engine/surface/surface_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace sulcus::surface_mesh_test {
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

/// Voxels of a label.
double voxels_m3(const VoxelModel& model, int label) {
  double volume = 0.0;
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if (model.solid(c) && model.tissue(c) == label) volume += model.grid.voxel_volume_m3();
  }
  return volume;
}

/// A ball of three tissues about one another, the outer one cut open, and one label that no voxel
/// has.
VoxelModel layered_ball() {
  const Eigen::Vector3d centre(35.2, 35.4, 35.9);
  const auto radius = [&](const Cell& c) { return (c.cast<double>() - centre).norm(); };
  VoxelModel model = make_model(
      {72, 72, 72}, [&](const Cell& c) { return radius(c) < 30.0 && !(c.x() > 44 && c.y() > 36); });
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels;
    for (int v = 0; v < 512; ++v) {
      const double r = radius(model.grid.leaf_origin(leaf) + Cell(v & 7, v >> 3 & 7, v >> 6));
      labels[v] = r < 6.0 ? 3 : r < 20.0 ? 1 : 0;
    }
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = tissues;
  return model;
}

TEST(TissueSurfaces, FillTheSolidTogether) {
  const VoxelModel model = layered_ball();
  const std::vector<TriangleMesh> meshes = tissue_surfaces(model, 4);
  ASSERT_EQ(meshes.size(), 4u);
  double sum = 0.0;
  for (const int label : {0, 1, 3}) {
    SCOPED_TRACE(label);
    expect_closed_manifold(meshes[label]);
    EXPECT_NEAR(volume_m3(meshes[label]) / voxels_m3(model, label), 1.0,
                label == 3 ? 0.025 : 0.01);  // a ball of six voxels' radius loses most
    sum += volume_m3(meshes[label]);
  }
  EXPECT_TRUE(meshes[2].triangles.empty());
  const double all = static_cast<double>(model.solid_count()) * model.grid.voxel_volume_m3();
  EXPECT_NEAR(sum / all, 1.0, 0.005);
}

using Corners = std::array<std::array<float, 3>, 3>;

/// The triangles of a mesh by place, each from its least corner on.
std::multiset<Corners> placed_triangles(const TriangleMesh& mesh, bool turned) {
  std::multiset<Corners> all;
  for (auto t : mesh.triangles) {
    if (turned) std::swap(t[1], t[2]);
    Corners corners;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3f& p = mesh.positions[t[i]];
      corners[i] = {p.x(), p.y(), p.z()};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.insert(corners);
  }
  return all;
}

TEST(TissueSurfaces, ShareTheirBorders) {
  const VoxelModel model = layered_ball();
  const std::vector<TriangleMesh> meshes = tissue_surfaces(model, 4);
  std::multiset<Corners> all;
  for (const TriangleMesh& mesh : meshes) all.merge(placed_triangles(mesh, false));
  // Each triangle is there once more, turned, in the neighbour's mesh; but for those to the air.
  std::size_t to_air = 0;
  for (const TriangleMesh& mesh : meshes) {
    for (const Corners& triangle : placed_triangles(mesh, true)) {
      to_air += all.contains(triangle) ? 0 : 1;
    }
  }
  EXPECT_GT(all.size() - to_air, 20000u);
  EXPECT_EQ(to_air, closed_surface(model).triangles.size());
}

TEST(TissueSurfaces, RandomLabelsAreClosed) {
  std::mt19937 random(11);
  VoxelModel model = make_model({16, 24, 72}, [&](const Cell&) { return random() % 4 != 0; });
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels;
    for (std::uint8_t& label : labels) label = static_cast<std::uint8_t>(random() % 3);
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = tissues;
  for (const TriangleMesh& mesh : tissue_surfaces(model, 3)) {
    EXPECT_GT(mesh.triangles.size(), 1000u);
    expect_closed_manifold(mesh);
  }
}

TEST(ClosedSurface, NothingSolidIsAnEmptyMesh) {
  const TriangleMesh mesh = closed_surface(empty_model({8, 8, 8}));
  EXPECT_TRUE(mesh.positions.empty());
  EXPECT_TRUE(mesh.triangles.empty());
}

}  // namespace
}  // namespace sulcus::surface_mesh_test
