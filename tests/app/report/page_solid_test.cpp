#include "app/report/page/page_solid.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "app/report/page/page_fields.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "tests/support/surface_distance.hpp"

namespace sulcus::page_solid_test {
namespace {

constexpr double kVoxel_m = 1e-4;

/// A block of two tissues, the upper 1.2 mm of the second; its top lies at 2.4 mm over the origin.
VoxelModel block() {
  VoxelModel model;
  model.grid = {{64, 64, 64}, kVoxel_m};
  model.leaves.resize(model.grid.leaf_count());
  for_each_cell(Cell(4, 4, 4), Cell(60, 60, 56), [&](const Cell& c) { model.set(c, true); });
  return model;
}

/// A shaft of 1 x 1 mm from the top, 1.6 mm deep, layer by layer.
std::vector<Edit> shaft(const VoxelModel& model) {
  std::vector<Edit> edits;
  for (int layer = 0; layer < 16; ++layer) {
    for_each_cell(Cell(27, 27, 55 - layer), Cell(37, 37, 56 - layer), [&](const Cell& c) {
      edits.push_back(
          {.tick = static_cast<std::uint64_t>(layer + 1), .voxel = model.grid.linear(c)});
    });
  }
  return edits;
}

void append(const TriangleMesh& part, TriangleMesh& all) {
  const auto first = static_cast<std::uint32_t>(all.positions.size());
  all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
  for (const auto& [a, b, c] : part.triangles) {
    all.triangles.push_back({first + a, first + b, first + c});
  }
}

TEST(PageSolid, WhatIsStillAndWhatMovesAreOneClosedSurface) {
  const VoxelModel start = block();
  const std::vector<Edit> edits = shaft(start);
  const std::array<std::size_t, 3> ends{0, 800, 1600};
  const PageSolid solid = page_solid(start, 1, edits, 0, ends, nullptr);
  ASSERT_EQ(solid.shown, (std::vector<std::size_t>{0, 1, 2}));
  VoxelModel model = start;
  for (std::size_t moment = 0; moment < 3; ++moment) {
    TriangleMesh all;
    for (const PageSurface& part : solid.still) append(part.mesh, all);
    append(solid.moving[solid.shown[moment]].mesh, all);
    EXPECT_EQ(test::open_edges(all), 0u) << moment;
    // Removed here voxel by voxel, of the model as a whole.
    for (std::size_t n = moment == 0 ? 0 : ends[moment - 1]; n < ends[moment]; ++n) {
      model.set(model.grid.cell_of_linear(edits[n].voxel), false);
    }
    EXPECT_LE(greatest_distance(closed_surface(model), all, 1e-3), kMostPageError_m) << moment;
  }
}

TEST(PageSolid, WhatNoEditTouchesIsMeshedOnce) {
  const VoxelModel start = block();
  std::vector<Edit> edits = shaft(start);
  for (Edit& edit : edits) edit.body = 1;
  const std::array<std::size_t, 3> ends{0, 800, 1600};
  const PageSolid untouched = page_solid(start, 1, edits, 0, ends, nullptr);
  EXPECT_TRUE(untouched.box.isEmpty());
  EXPECT_TRUE(untouched.moving.empty());
  EXPECT_EQ(page_solid(start, 1, edits, 1, std::array<std::size_t, 3>{0, 0, 1600}, nullptr).shown,
            (std::vector<std::size_t>{0, 0, 1}));
}

class Fields : public testing::Test {
 protected:
  Fields() : target_(start_.grid) {
    // The goal: 0.8 x 0.8 mm, 1.8 mm deep.
    for_each_cell(Cell(28, 28, 38), Cell(36, 36, 56), [&](const Cell& c) { target_.insert(c); });
  }
  PageFields fields(AssessedKind kind) const {
    const std::vector<TissueLook> looks{{"enamel", {1.0f, 0.5f, 0.0f}}};
    const Eigen::AlignedBox3i box(Cell(20, 20, 30), Cell(44, 44, 60));
    return page_fields(start_, box,
                       {.looks = looks, .edits = edits_, .target = &target_, .kind = kind});
  }
  static std::size_t place(const PageFields& fields, const Cell& voxel) {
    const Cell at = voxel - fields.first;
    return static_cast<std::size_t>(at.x() +
                                    fields.samples.x() * (at.y() + fields.samples.y() * at.z()));
  }
  const VoxelModel start_ = block();
  const std::vector<Edit> edits_ = shaft(start_);
  VoxelSet target_;
};

TEST_F(Fields, TheGoalsWallIsWhereItsVoxelsEnd) {
  const PageFields found = fields(AssessedKind::kCavity);
  ASSERT_EQ(found.step, 1);
  const auto goal_mm = [&](const Cell& c) {
    return (found.tissue_goal[place(found, c)][3] - 128.0) * 0.01;
  };
  EXPECT_NEAR(goal_mm({28, 31, 45}), -0.05, 1e-9);  // beside the wall, within
  EXPECT_NEAR(goal_mm({27, 31, 45}), 0.05, 1e-9);   // and beyond
  EXPECT_NEAR(goal_mm({24, 31, 45}), 0.35, 1e-9);
  EXPECT_NEAR(goal_mm({31, 31, 40}), -0.25, 1e-9);  // over the floor
}

TEST_F(Fields, DepthIsAlongTheInsertionOfACavityAndToTheSurfaceOfACrown) {
  const auto depth_mm = [&](AssessedKind kind, const Cell& c) {
    const PageFields found = fields(kind);
    return found.cut_depth[place(found, c)][2] * 0.04;
  };
  EXPECT_NEAR(depth_mm(AssessedKind::kCavity, {31, 31, 40}), 1.55, 0.021);
  EXPECT_NEAR(depth_mm(AssessedKind::kCrown, {31, 31, 40}), 1.55, 0.021);
  EXPECT_NEAR(depth_mm(AssessedKind::kCavity, {20, 31, 30}), 2.55, 0.021);
  EXPECT_NEAR(depth_mm(AssessedKind::kCrown, {20, 31, 30}), 1.65, 0.021);  // to the side
}

TEST_F(Fields, TheOrderOfCuttingIsByTurn) {
  const PageFields found = fields(AssessedKind::kCavity);
  const auto turn = [&](const Cell& c) {
    const auto& [turn_share, share, depth] = found.cut_depth[place(found, c)];
    return static_cast<double>(turn_share) / share;
  };
  EXPECT_EQ(found.cut_depth[place(found, {31, 31, 36})][1], 0);  // uncut
  EXPECT_NEAR(turn({31, 31, 54}), 1.5 / 16.0, 0.02);
  EXPECT_NEAR(turn({31, 31, 47}), 8.5 / 16.0, 0.02);
  EXPECT_EQ(found.tissue_goal[place(found, {31, 31, 36})][0], 255);  // of linear 1, 0.5 and 0
  EXPECT_EQ(found.tissue_goal[place(found, {31, 31, 36})][1], 188);
  EXPECT_EQ(found.tissue_goal[place(found, {31, 31, 36})][2], 0);
}

}  // namespace
}  // namespace sulcus::page_solid_test
