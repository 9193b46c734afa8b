#include "engine/surface/occlusion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace sulcus::occlusion_test {
namespace {

constexpr double kVoxel = 3.5e-5;  // four voxels to a cell of the texture

/// Solid where `inside` says; the texture has 24 x 24 x 24 cells.
template <class Inside>
VoxelModel make_model(Inside inside, double voxel_m) {
  VoxelModel model;
  model.grid = {{96, 96, 96}, voxel_m};
  model.leaves.resize(model.grid.leaf_count());
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if (inside(c)) model.set(c, true);
  }
  return model;
}
bool in_rest(const Cell& c) { return (c.cast<double>() - Eigen::Vector3d(40, 48, 30)).norm() < 25; }
bool in_piece(const Cell& c) {
  return (c.cast<double>() - Eigen::Vector3d(45, 43, 70)).norm() < 15 && !in_rest(c);
}

std::vector<std::uint16_t> values_of(const VoxelModel& model) {
  return Occlusion(model, Density(model)).values();
}

int largest_difference(const std::vector<std::uint16_t>& a, const std::vector<std::uint16_t>& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

/// A rest without the piece, and the piece added to it.
struct Placed {
  Density density;  // of the rest
  Occlusion occlusion;
};
Placed with_piece(double voxel_m = kVoxel) {
  const VoxelModel rest = make_model(in_rest, voxel_m);
  const Density density(rest);
  Occlusion occlusion(rest, density);
  std::vector<std::uint32_t> voxels;
  for (std::uint32_t v = 0; v < rest.grid.cell_count(); ++v) {
    if (in_piece(rest.grid.cell_of_linear(v))) voxels.push_back(v);
  }
  occlusion.add_piece(rest.grid, voxels);
  return {density, std::move(occlusion)};
}

TEST(OcclusionOfPieces, APieceInItsPlaceIsAsBeforeItCameLoose) {
  for (const double voxel_m : {kVoxel, kVoxel / 2}) {  // also eight voxels to a cell
    const auto whole =
        values_of(make_model([](const Cell& c) { return in_rest(c) || in_piece(c); }, voxel_m));
    auto [density, occlusion] = with_piece(voxel_m);
    EXPECT_GT(largest_difference(occlusion.values(), whole), 8000);
    const Pose stayed;
    EXPECT_EQ(occlusion.place_pieces(density, {&stayed, 1}).size(), 1u);
    EXPECT_LE(largest_difference(occlusion.values(), whole), 1);
  }
}

TEST(OcclusionOfPieces, AMovedPieceIsWhereItIsNowAndItsOldPlaceIsEmpty) {
  auto [density, occlusion] = with_piece();
  Pose pose;
  occlusion.place_pieces(density, {&pose, 1});
  pose.position = Eigen::Vector3d(20, -8, 4) * kVoxel;
  const std::vector<Occlusion::Box> boxes = occlusion.place_pieces(density, {&pose, 1});
  const auto moved = values_of(make_model(
      [](const Cell& c) { return in_rest(c) || in_piece(c - Cell(20, -8, 4)); }, kVoxel));
  EXPECT_LE(largest_difference(occlusion.values(), moved), 1);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_TRUE((boxes[0].low.array() >= 0).all());
  EXPECT_TRUE((boxes[0].high.array() <= 24).all());
  EXPECT_TRUE((boxes[0].low.array() < boxes[0].high.array()).all());
  EXPECT_TRUE(occlusion.place_pieces(density, {&pose, 1}).empty());  // it has not moved

  // Turned by a right angle about the vertical through the grid's centre, and half a cell up.
  pose.orientation = Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ());
  pose.position = Eigen::Vector3d(0, 0, 2) * kVoxel;
  occlusion.place_pieces(density, {&pose, 1});
  const auto turned = values_of(make_model(
      [](const Cell& c) { return in_rest(c) || in_piece(Cell(c.y(), 95 - c.x(), c.z() - 2)); },
      kVoxel));
  EXPECT_LE(largest_difference(occlusion.values(), turned), 65535 / 40);
}

TEST(OcclusionOfPieces, NothingIsDenserThanSolid) {
  const VoxelModel full = make_model([](const Cell&) { return true; }, kVoxel);
  const Density density(full);
  Occlusion occlusion(full, density);
  const std::vector<std::uint16_t> before = occlusion.values();
  const std::vector<std::uint32_t> voxels{full.grid.linear({40, 40, 40})};
  occlusion.add_piece(full.grid, voxels);  // and not yet removed
  const Pose stayed;
  EXPECT_EQ(occlusion.place_pieces(density, {&stayed, 1}).size(), 1u);
  EXPECT_EQ(occlusion.values(), before);
}

TEST(OcclusionOfPieces, WithoutAPoseOrOutOfReachAPieceIsNowhere) {
  const auto rest = values_of(make_model(in_rest, kVoxel));
  auto [density, occlusion] = with_piece();
  EXPECT_TRUE(occlusion.place_pieces(density, {}).empty());
  EXPECT_EQ(occlusion.values(), rest);
  std::vector<Pose> poses(2);  // one more than there are pieces
  for (const double x : {0.5, std::numeric_limits<double>::quiet_NaN(), 1e300}) {
    poses[0].position = Eigen::Vector3d::Zero();
    occlusion.place_pieces(density, poses);
    EXPECT_NE(occlusion.values(), rest);
    poses[0].position = {x, 0, 0};
    occlusion.place_pieces(density, poses);
    EXPECT_EQ(occlusion.values(), rest);
  }
  poses[0].position = Eigen::Vector3d::Zero();
  occlusion.place_pieces(density, poses);
  EXPECT_EQ(occlusion.place_pieces(density, {}).size(), 1u);
  EXPECT_EQ(occlusion.values(), rest);
}

}  // namespace
}  // namespace sulcus::occlusion_test
