#include "engine/surface/drawn_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::drawn_surface_test {
namespace {

const std::vector<TissueLook> kLooks{{"outer", {0.81f, 0.64f, 0.36f}}, {"inner", {0.5f, 0, 0}}};

/// A ball in a grid that spans several bricks.
VoxelModel ball(double radius = 26.0) {
  VoxelModel model;
  model.grid = {{72, 64, 80}, 1e-4};
  model.leaves.resize(model.grid.leaf_count());
  for (int k = 0; k < 80; ++k) {
    for (int j = 0; j < 64; ++j) {
      for (int i = 0; i < 72; ++i) {
        const Eigen::Vector3d p = Eigen::Vector3d(i, j, k) - Eigen::Vector3d(35.5, 31.5, 40.5);
        if (p.norm() < radius) model.set(Cell(i, j, k), true);
      }
    }
  }
  return model;
}

std::vector<std::uint32_t> solid_within(const VoxelModel& model, const Eigen::Vector3d& centre,
                                        double radius) {
  std::vector<std::uint32_t> voxels;
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if (model.solid(c) && (c.cast<double>() - centre).norm() < radius) voxels.push_back(v);
  }
  return voxels;
}

std::vector<DrawnMesh> all_meshes(const DrawnSurface& surface, Detail detail = Detail::kFull) {
  std::vector<DrawnMesh> meshes(surface.brick_count(detail));
  DrawnSurface::Scratch scratch;
  for (int b = 0; b < surface.brick_count(detail); ++b) {
    surface.mesh(b, scratch, meshes[b], detail);
  }
  return meshes;
}

/// Vertices that two bricks share must agree in every bit, and edges must match across them.
void expect_closed(const std::vector<DrawnMesh>& meshes, std::size_t least_vertices) {
  using Place = std::array<float, 3>;
  std::map<Place, DrawnVertex> vertices;
  std::map<std::pair<Place, Place>, int> balance;
  for (const DrawnMesh& mesh : meshes) {
    for (const DrawnVertex& v : mesh.vertices) {
      const auto [entry, added] = vertices.try_emplace(v.position_m, v);
      EXPECT_EQ(entry->second, v) << added;
    }
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Place& a = mesh.vertices[mesh.indices[t + i]].position_m;
        const Place& b = mesh.vertices[mesh.indices[t + (i + 1) % 3]].position_m;
        if (a == b) continue;  // two vertices in one place
        if (a < b) {
          ++balance[{a, b}];
        } else {
          --balance[{b, a}];
        }
      }
    }
  }
  ASSERT_GT(vertices.size(), least_vertices);
  for (const auto& [edge, count] : balance) EXPECT_EQ(count, 0);
}

TEST(DrawnSurface, BricksCloseWithoutCracks) {
  expect_closed(all_meshes(DrawnSurface(ball(), kLooks)), 1000);
}

TEST(DrawnSurface, CoarseBricksCloseAndFollowTheCutToo) {
  for (const int cell_voxels : {1, 2, 4}) {
    DrawnSurface edited(ball(), kLooks, cell_voxels);
    std::vector<DrawnMesh> kept = all_meshes(edited, Detail::kCoarse);
    expect_closed(kept, cell_voxels == 1 ? 1000 : cell_voxels == 2 ? 250 : 60);
    EXPECT_EQ(edited.take_changed(1000, Detail::kCoarse).size(), kept.size());
    const auto bite = solid_within(edited.model(), {56, 30, 60}, 12.0);
    edited.remove(bite);
    DrawnSurface::Scratch scratch;
    for (const int b : edited.take_changed(1000, Detail::kCoarse)) {
      edited.mesh(b, scratch, kept[b], Detail::kCoarse);
    }
    expect_closed(kept, 60);
    DrawnSurface fresh(ball(), kLooks, cell_voxels);
    fresh.remove(bite);
    fresh.take_changed();
    const std::vector<DrawnMesh> wanted = all_meshes(fresh, Detail::kCoarse);
    std::size_t triangles = 0, full = 0;
    for (std::size_t b = 0; b < wanted.size(); ++b) {
      EXPECT_EQ(kept[b].vertices, wanted[b].vertices) << cell_voxels << " brick " << b;
      triangles += kept[b].indices.size() / 3;
    }
    for (const DrawnMesh& mesh : all_meshes(fresh)) full += mesh.indices.size() / 3;
    EXPECT_LT(triangles, full / 3);
  }
}

TEST(DrawnSurface, NormalsOfABallPointOutward) {
  DrawnSurface surface(ball(), kLooks);
  const Eigen::Vector3d centre =
      surface.model().grid.world_from_index(Eigen::Vector3d(35.5, 31.5, 40.5));
  for (const DrawnMesh& mesh : all_meshes(surface)) {
    for (const DrawnVertex& v : mesh.vertices) {
      const Eigen::Vector3d p(v.position_m[0], v.position_m[1], v.position_m[2]);
      const Eigen::Vector3d n(v.normal[0], v.normal[1], v.normal[2]);
      EXPECT_GT((p - centre).normalized().dot(n / 32767.0), 0.998);  // 3.6 degrees
      EXPECT_NEAR((p - centre).norm(), 26e-4, 1e-4);
    }
  }
}

TEST(DrawnSurface, EditedBricksEqualAFreshMesh) {
  DrawnSurface edited(ball(), kLooks);
  std::vector<DrawnMesh> kept = all_meshes(edited);
  EXPECT_EQ(edited.take_changed().size(), kept.size());
  // Three bites, the second across brick borders, each followed by what the renderer does.
  VoxelModel model = edited.model();
  std::size_t remeshed = 0;
  for (const Eigen::Vector3d& at :
       {Eigen::Vector3d(56, 30, 60), Eigen::Vector3d(35, 12, 32), Eigen::Vector3d(33, 32, 65)}) {
    const auto voxels = solid_within(model, at, 6.0);
    ASSERT_FALSE(voxels.empty());
    for (const std::uint32_t v : voxels) model.set(model.grid.cell_of_linear(v), false);
    edited.remove(voxels);
    DrawnSurface::Scratch scratch;
    for (const int b : edited.take_changed()) {
      edited.mesh(b, scratch, kept[b]);
      ++remeshed;
    }
  }
  EXPECT_GT(remeshed, 0u);
  DrawnSurface fresh(ball(), kLooks);
  fresh.remove(solid_within(fresh.model(), {56, 30, 60}, 6.0));
  fresh.remove(solid_within(fresh.model(), {35, 12, 32}, 6.0));
  fresh.remove(solid_within(fresh.model(), {33, 32, 65}, 6.0));
  fresh.take_changed();
  const std::vector<DrawnMesh> wanted = all_meshes(fresh);
  // The same shape without a history: only the marks of cutting may differ.
  const std::vector<DrawnMesh> plain = all_meshes(DrawnSurface(model, kLooks));
  bool cut = false;
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    EXPECT_EQ(kept[b].vertices, wanted[b].vertices) << "brick " << b;
    EXPECT_EQ(kept[b].indices, wanted[b].indices) << "brick " << b;
    ASSERT_EQ(plain[b].vertices.size(), wanted[b].vertices.size());
    for (std::size_t v = 0; v < wanted[b].vertices.size(); ++v) {
      EXPECT_EQ(plain[b].vertices[v].position_m, wanted[b].vertices[v].position_m);
      EXPECT_EQ(plain[b].vertices[v].normal, wanted[b].vertices[v].normal);
      EXPECT_EQ(plain[b].vertices[v].colour_cut[3], 0);
      cut = cut || wanted[b].vertices[v].colour_cut[3] > 200;
    }
  }
  EXPECT_TRUE(cut);
}

TEST(DrawnSurface, ACutShowsTheTissueInside) {
  VoxelModel model = ball();
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels{};
    for (int n = 0; n < 512; ++n) {
      const Cell c = model.grid.leaf_origin(leaf) + Cell(n & 7, n >> 3 & 7, n >> 6);
      labels[n] = (c.cast<double>() - Eigen::Vector3d(35.5, 31.5, 40.5)).norm() < 18.0 ? 1 : 0;
    }
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = tissues;
  DrawnSurface surface(model, kLooks);
  const std::array<std::uint8_t, 4> outer{230, 204, 153, 0};
  const std::array<std::uint8_t, 4> inner{180, 0, 0, 255};  // and cut
  auto count = [&](const std::array<std::uint8_t, 4>& colour) {
    std::size_t found = 0;
    for (const DrawnMesh& mesh : all_meshes(surface)) {
      for (const DrawnVertex& v : mesh.vertices) found += v.colour_cut == colour ? 1u : 0u;
    }
    return found;
  };
  EXPECT_GT(count(outer), 1000u);
  EXPECT_EQ(count(inner), 0u);
  surface.remove(solid_within(model, {35, 10, 40}, 12.0));
  EXPECT_GT(count(inner), 20u);
}

TEST(DrawnSurface, RemovingWhatIsNotThereChangesNothing) {
  DrawnSurface surface(ball(), kLooks);
  surface.take_changed();
  const std::uint32_t empty_voxel[] = {0};
  surface.remove(empty_voxel);
  EXPECT_TRUE(surface.take_changed().empty());
  EXPECT_TRUE(surface.take_changed_leaves().empty());
}

}  // namespace
}  // namespace sulcus::drawn_surface_test
