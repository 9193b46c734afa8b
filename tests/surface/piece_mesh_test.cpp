#include "engine/surface/piece_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace sulcus::piece_mesh_test {
namespace {

const std::vector<TissueLook> kLooks{{"outer", {0.81f, 0.64f, 0.36f}}, {"inner", {0.5f, 0, 0}}};
const Eigen::Vector3d kMiddle(43.5, 39.5, 47.5);
constexpr double kVoxel = 1e-4;

template <class Inside>
VoxelModel make_model(Inside inside) {
  VoxelModel model;
  model.grid = {{88, 80, 96}, kVoxel};
  model.leaves.resize(model.grid.leaf_count());
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if (inside(c)) model.set(c, true);
  }
  return model;
}

double from_middle(const Cell& c) { return (c.cast<double>() - kMiddle).norm(); }

/// A ball of 36 voxels' radius, of the inner tissue up to 24.
VoxelModel two_layer_ball() {
  VoxelModel model = make_model([](const Cell& c) { return from_middle(c) < 36.0; });
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels{};
    for (int n = 0; n < 512; ++n) {
      const Cell c = model.grid.leaf_origin(leaf) + Cell(n & 7, n >> 3 & 7, n >> 6);
      labels[n] = from_middle(c) < 24.0 ? 1 : 0;
    }
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = tissues;
  return model;
}

template <class Inside>
std::vector<std::uint32_t> solid_where(const VoxelModel& model, Inside inside) {
  std::vector<std::uint32_t> voxels;
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if (model.solid(c) && inside(c)) voxels.push_back(v);
  }
  return voxels;
}

Eigen::Vector3d place(const DrawnVertex& v) {
  return {v.position_m[0], v.position_m[1], v.position_m[2]};
}

/// How many directed edges have no opposite, and how often the most frequent one occurs: once on
/// a surface that touches itself nowhere. Vertices at the same place are taken as one.
struct Edges {
  int open = 0;
  int most = 0;
};
Edges edges_of(const DrawnMesh& mesh) {
  using Place = std::array<float, 3>;
  std::map<std::pair<Place, Place>, int> directed;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    for (std::size_t i = 0; i < 3; ++i) {
      ++directed[{mesh.vertices[mesh.indices[t + i]].position_m,
                  mesh.vertices[mesh.indices[t + (i + 1) % 3]].position_m}];
    }
  }
  Edges edges;
  for (const auto& [edge, count] : directed) {
    const auto opposite = directed.find({edge.second, edge.first});
    edges.open += opposite == directed.end() || opposite->second != count ? 1 : 0;
    edges.most = std::max(edges.most, count);
  }
  return edges;
}

void expect_closed(const DrawnMesh& mesh) {
  const Edges edges = edges_of(mesh);
  EXPECT_EQ(edges.open, 0);
  EXPECT_EQ(edges.most, 1);
}

double volume_in_voxels(const DrawnMesh& mesh) {
  double six = 0.0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const Eigen::Vector3d a = place(mesh.vertices[mesh.indices[t]]);
    const Eigen::Vector3d b = place(mesh.vertices[mesh.indices[t + 1]]);
    const Eigen::Vector3d c = place(mesh.vertices[mesh.indices[t + 2]]);
    six += a.dot(b.cross(c));
  }
  return six / (6.0 * kVoxel * kVoxel * kVoxel);
}

TEST(PieceMesh, ACubeAndABallAreClosedAndKeepTheirVolume) {
  const VoxelModel model = make_model([](const Cell&) { return true; });
  for (const int cell_voxels : {1, 2}) {
    const DrawnSurface solid(model, kLooks, cell_voxels);
    // Off the lattice of leaves, over several bricks.
    const auto cube = solid_where(
        model, [](const Cell& c) { return (c.array() >= 13).all() && (c.array() < 49).all(); });
    const DrawnMesh cube_mesh = piece_mesh(solid, cube);
    expect_closed(cube_mesh);
    EXPECT_NEAR(volume_in_voxels(cube_mesh) / (36.0 * 36 * 36), 1.0,
                0.02 * cell_voxels);  // edges are rounded
    Eigen::AlignedBox3d box;
    for (const DrawnVertex& v : cube_mesh.vertices) box.extend(place(v));
    const Eigen::Vector3d low = model.grid.world_from_index(Eigen::Vector3d::Constant(12.5));
    const Eigen::Vector3d high = model.grid.world_from_index(Eigen::Vector3d::Constant(48.5));
    EXPECT_LT((box.min() - low).cwiseAbs().maxCoeff(), 0.5 * kVoxel);
    EXPECT_LT((box.max() - high).cwiseAbs().maxCoeff(), 0.5 * kVoxel);

    const Eigen::Vector3d centre(50.2, 39.4, 41.7);
    const auto round = solid_where(
        model, [&](const Cell& c) { return (c.cast<double>() - centre).norm() < 20.0; });
    const DrawnMesh ball_mesh = piece_mesh(solid, round);
    expect_closed(ball_mesh);
    EXPECT_NEAR(volume_in_voxels(ball_mesh) / (4.0 / 3.0 * std::numbers::pi * 8000.0), 1.0,
                0.02 * cell_voxels);  // edges are rounded
    const Eigen::Vector3d centre_world = model.grid.world_from_index(centre);
    for (const DrawnVertex& v : ball_mesh.vertices) {
      const Eigen::Vector3d out = place(v) - centre_world;
      EXPECT_NEAR(out.norm(), 20 * kVoxel, kVoxel);
      const Eigen::Vector3d n(v.normal[0], v.normal[1], v.normal[2]);
      EXPECT_GT(out.normalized().dot(n / 32767.0), 0.99);
    }
  }
}

TEST(PieceMesh, AnyVoxelsAtTheBorderOfTheGridAreClosed) {
  std::mt19937 random(5);
  std::bernoulli_distribution take(0.7);
  const VoxelModel model = make_model([](const Cell&) { return true; });
  const auto voxels =
      solid_where(model, [&](const Cell& c) { return c.x() < 20 && c.z() >= 60 && take(random); });
  const DrawnMesh mesh = piece_mesh(DrawnSurface(model, kLooks), voxels);
  ASSERT_GT(mesh.vertices.size(), 10000u);
  EXPECT_EQ(edges_of(mesh).open, 0);
}

TEST(PieceMesh, SoundFacesStayWhereTheyWereAndFreshOnesAreCut) {
  const VoxelModel model = two_layer_ball();
  for (const int cell_voxels : {1, 2, 4}) {
    DrawnSurface solid(model, kLooks, cell_voxels);
    std::vector<Eigen::Vector3d> before;
    DrawnSurface::Scratch scratch;
    DrawnMesh brick;
    for (int b = 0; b < solid.brick_count(); ++b) {
      solid.mesh(b, scratch, brick);
      for (const DrawnVertex& v : brick.vertices) before.push_back(place(v));
    }
    // The burr's way is gone from the solid already.
    solid.remove(solid_where(model, [](const Cell& c) { return c.z() >= 50 && c.z() < 56; }));
    const DrawnMesh mesh =
        piece_mesh(solid, solid_where(model, [](const Cell& c) { return c.z() >= 56; }));
    expect_closed(mesh);

    const std::array<std::uint8_t, 4> outer{230, 204, 153, 0};
    const std::array<std::uint8_t, 4> inner_cut{180, 0, 0, 255};
    const double cut_world = model.grid.world_from_index({0, 0, 55.5}).z();
    int sound = 0;
    int cut = 0;
    for (const DrawnVertex& v : mesh.vertices) {
      const Eigen::Vector3d p = place(v);
      const Eigen::Vector3d p_index = model.grid.index_from_world(p);
      if (p.z() > cut_world + 12 * kVoxel) {
        ++sound;
        double nearest = 1.0;
        for (const Eigen::Vector3d& q : before) nearest = std::min(nearest, (p - q).norm());
        EXPECT_LT(nearest, 1e-4 * kVoxel);
        EXPECT_EQ(v.colour_cut, outer);
      } else if ((p_index - kMiddle).head<2>().norm() < 10.0) {
        ++cut;
        EXPECT_NEAR(p.z(), cut_world, 0.6 * cell_voxels * kVoxel);
        EXPECT_EQ(v.colour_cut, inner_cut);
        EXPECT_LT(v.normal[2], -32000);
      }
    }
    EXPECT_GT(sound, 2000 / (cell_voxels * cell_voxels));
    EXPECT_GT(cut, 250 / (cell_voxels * cell_voxels));
  }
}

TEST(PieceMesh, FacesTowardsWhatIsStillSolidAreCutTooAndRemovingFirstChangesNothing) {
  const VoxelModel model = two_layer_ball();
  DrawnSurface solid(model, kLooks);
  auto voxels = solid_where(model, [](const Cell& c) { return c.z() >= 56; });
  const DrawnMesh first = piece_mesh(solid, voxels);
  EXPECT_TRUE(std::any_of(first.vertices.begin(), first.vertices.end(),
                          [](const DrawnVertex& v) { return v.colour_cut[3] == 255; }));
  solid.remove(voxels);
  std::reverse(voxels.begin(), voxels.end());
  const DrawnMesh after = piece_mesh(solid, voxels);
  EXPECT_EQ(after.vertices, first.vertices);
  EXPECT_EQ(after.indices, first.indices);
}

TEST(PieceMesh, SmallPiecesAreMeshedFinerAndNoVoxelIsAnError) {
  const VoxelModel model = make_model([](const Cell&) { return true; });
  const DrawnSurface solid(model, kLooks, 4);
  const auto crumb = solid_where(model, [](const Cell& c) {
    return (c.array() >= 30).all() && (c.array() < 34).all();  // half of each of eight cells
  });
  const DrawnMesh mesh = piece_mesh(solid, crumb);
  expect_closed(mesh);
  EXPECT_GT(volume_in_voxels(mesh), 32.0);
  const std::vector<std::uint32_t> dust{model.grid.linear({30, 30, 30})};
  EXPECT_TRUE(piece_mesh(solid, dust).indices.empty());
  EXPECT_THROW(piece_mesh(solid, {}), std::invalid_argument);
  const std::vector<std::uint32_t> beyond{static_cast<std::uint32_t>(model.grid.cell_count())};
  EXPECT_THROW(piece_mesh(solid, beyond), std::invalid_argument);
}

}  // namespace
}  // namespace sulcus::piece_mesh_test
