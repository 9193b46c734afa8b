#include "engine/normals/ldm_filled.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/normals/filled_columns.hpp"
#include "engine/normals/ldm.hpp"
#include "engine/normals/map_batch.hpp"
#include "engine/normals/normal_method.hpp"
#include "engine/shapes/basic_shapes.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "tests/support/rough_blobs.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::ldm_filled_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kNs = 6, kTrace = 12;

double angle_deg(const Vector3f& a, const Vector3d& b) {
  const Vector3d n = a.cast<double>();
  return std::atan2(n.cross(b).norm(), n.dot(b)) * 180.0 / 3.14159265358979;
}

/// Surface voxels at least so many from the faces of the grid.
std::vector<Cell> inner_cells(const Workpiece& workpiece, int margin) {
  std::vector<Cell> cells = test::surface_cells(workpiece);
  std::erase_if(cells, [&](const Cell& c) {
    return (c.array() < margin).any() ||
           (c.array() >= workpiece.grid().cells.array() - margin).any();
  });
  return cells;
}

std::vector<SurfaceEstimate> estimates_of(const Workpiece& workpiece,
                                          const std::vector<Cell>& cells) {
  std::vector<VoxelQuery> queries;
  for (const Cell& c : cells) queries.push_back({c});
  std::vector<SurfaceEstimate> estimates(queries.size());
  estimate_ldm_filled(workpiece, queries, kNs, kTrace, estimates);
  return estimates;
}

template <ImplicitShape S>
Workpiece with_fractions(const S& shape, int cells, const Pose& pose = {}) {
  VoxelGrid grid;
  grid.cells = Eigen::Vector3i::Constant(cells);
  grid.voxel_m = 1.0;
  return Workpiece(voxelise_implicit(shape, grid, nullptr, pose, SurfaceKind::kFractions));
}

Pose turned(double x, double y, double z) {
  Pose pose;
  pose.orientation = Eigen::AngleAxisd(x, Vector3d::UnitX()) *
                     Eigen::AngleAxisd(y, Vector3d::UnitY()) *
                     Eigen::AngleAxisd(z, Vector3d::UnitZ());
  pose.position = Vector3d(0.13, -0.29, 0.37);
  return pose;
}

TEST(LdmFilled, PlanesAreExactAtAnyTilt) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 30; ++n) {
    Pose pose;
    // Nearly level ones too, whose terraces no binary map sees the end of.
    const Vector3d axis = Vector3d(normal(random), normal(random), normal(random)).normalized();
    pose.orientation = Eigen::AngleAxisd(n < 10 ? 0.005 * n : normal(random), axis);
    pose.position = Vector3d(normal(random), normal(random), normal(random));
    const Workpiece workpiece = with_fractions(PlateShape(24.0, 0.0), 64, pose);
    const Vector3d up = pose.direction(Vector3d::UnitZ());
    const std::vector<Cell> cells = inner_cells(workpiece, 18);
    const auto estimates = estimates_of(workpiece, cells);
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const double height =
          up.dot(workpiece.grid().centre_world(cells[k]) - pose.position);  // over the middle
      const Vector3d out = height > 0.0 ? up : Vector3d(-up);
      ASSERT_LT(angle_deg(estimates[k].normal, out), 0.05) << n;
      ASSERT_NEAR(estimates[k].offset, 12.0 - std::abs(height), 0.02) << n;
    }
  }
}

TEST(LdmFilled, CurvedSurfacesAreNearlyExact) {
  const Workpiece ball = with_fractions(SphereShape(40.0), 96, turned(0, 0, 0));
  const std::vector<Cell> cells = inner_cells(ball, 1);
  const auto estimates = estimates_of(ball, cells);
  double sum_deg = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const Vector3d p = ball.grid().centre_world(cells[k]) - Vector3d(0.13, -0.29, 0.37);
    sum_deg += angle_deg(estimates[k].normal, p.normalized());
    squares += std::pow(estimates[k].offset - (40.0 - p.norm()), 2);
  }
  const auto count = static_cast<double>(cells.size());
  EXPECT_LT(sum_deg / count, 0.03);  // ldm on bits: 0.5
  EXPECT_LT(std::sqrt(squares / count), 0.01);
}

TEST(LdmFilled, FacesOfATiltedBoxAreTheNearest) {
  const Pose pose = turned(0.3, 0.5, 0.2);
  const Workpiece box = with_fractions(BoxShape({50, 50, 50}), 96, pose);
  const std::vector<Cell> cells = inner_cells(box, 1);
  const auto estimates = estimates_of(box, cells);
  double face = 0.0, near = 0.0, edge = 0.0;
  int faces = 0, nears = 0, edges = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const Vector3d p = pose.inverse_point(box.grid().centre_world(cells[k]));
    const Vector3d away = 25.0 - p.array().abs();  // from each pair of faces, inward
    if ((away.array() < 0.0).any()) continue;      // the nearest point may be on an edge
    int axis = 0;
    away.minCoeff(&axis);
    Vector3d out = Vector3d::Zero();
    out[axis] = p[axis] > 0.0 ? 1.0 : -1.0;
    double to_edge = 1e9;
    for (int a = 0; a < 3; ++a) to_edge = a == axis ? to_edge : std::min(to_edge, away[a]);
    const double error = angle_deg(estimates[k].normal, pose.direction(out));
    (to_edge > 10.0 ? face : to_edge > 2.0 ? near : edge) += error;
    ++(to_edge > 10.0 ? faces : to_edge > 2.0 ? nears : edges);
  }
  ASSERT_GT(edges, 100);
  EXPECT_LT(face / faces, 0.01);
  EXPECT_LT(near / nears, 0.1);
  EXPECT_LT(edge / edges, 5.0);
}

TEST(LdmFilled, WhereNoVoxelIsPartFilledItIsLdm) {
  VoxelModel model = test::random_blobs({40, 40, 40}, 7);
  model.fills.emplace(model.grid.leaf_count(), std::vector<LeafLevels>{});
  const Workpiece workpiece(std::move(model));
  const std::vector<Cell> cells = test::surface_cells(workpiece);
  std::vector<VoxelQuery> queries;
  for (const Cell& c : cells) queries.push_back({c});
  std::vector<SurfaceEstimate> of_bits(queries.size()), filled(queries.size());
  estimate_ldm(workpiece, queries, kNs, kTrace, of_bits);
  estimate_ldm_filled(workpiece, queries, kNs, kTrace, filled);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    ASSERT_EQ(filled[k].defined, of_bits[k].defined);
    ASSERT_TRUE(filled[k].normal.isApprox(of_bits[k].normal, 1e-6f));
    ASSERT_NEAR(filled[k].offset, of_bits[k].offset, 1e-6);
  }
}

TEST(LdmFilled, OneByOneAndTogetherAreTheSameBits) {
  for (const Workpiece& workpiece : {test::rough_blobs(), with_fractions(SphereShape(14.0), 48),
                                     with_fractions(PlateShape(2.2, 0.4), 48)}) {
    std::vector<Cell> cells = test::surface_cells(workpiece);
    const auto together = estimates_of(workpiece, cells);
    std::ranges::reverse(cells);
    const auto backward = estimates_of(workpiece, cells);
    for (std::size_t k = 0; k < cells.size(); k += 5) {
      const auto alone = estimates_of(workpiece, {cells[k]});
      const std::size_t other = cells.size() - 1 - k;
      ASSERT_EQ(together[other].normal, alone[0].normal);
      ASSERT_EQ(together[other].offset, alone[0].offset);
      ASSERT_EQ(backward[k].normal, alone[0].normal);
      ASSERT_EQ(backward[k].offset, alone[0].offset);
    }
  }
}

TEST(LdmFilled, WhateverIsFilledHasFiniteUnitNormals) {
  const Workpiece workpiece = test::rough_blobs();
  const std::vector<Cell> cells = test::surface_cells(workpiece);
  for (const SurfaceEstimate& estimate : estimates_of(workpiece, cells)) {
    if (!estimate.defined) continue;
    ASSERT_NEAR(estimate.normal.norm(), 1.0f, 1e-4f);
    ASSERT_TRUE(std::isfinite(estimate.offset));
    ASSERT_LT(std::abs(estimate.offset), 20.0f);
  }
}

/// Thinly filled voxels of faces that lean between two axes, of which one column is cut away
/// beneath: they rest on the other, and their surface is still the face.
TEST(LdmFilled, ARestIsFeltWhereTheSurfaceIs) {
  const BoxShape box({30, 30, 60});
  for (const double turn : {0.6, 0.7, 0.9, 2.4}) {
    const Pose pose = turned(0.0, 0.0, turn);
    const Workpiece whole = with_fractions(box, 48, pose);
    int rests = 0;
    for (const Cell& cell : inner_cells(whole, 6)) {
      if (whole.level(cell) > 30) continue;
      const Vector3d centre = pose.inverse_point(whole.grid().centre_world(cell));
      const Vector3d normal = pose.direction(box.gradient(centre));
      for (int axis = 0; axis < 2; ++axis) {
        Cell beneath = cell;
        beneath[axis] += normal[axis] > 0.0 ? -1 : 1;
        if (whole.level(beneath) == kFullLevel || std::abs(normal[axis]) < 0.5) continue;
        Workpiece cut(whole.model());
        cut.remove(beneath);
        ++rests;
        EXPECT_NEAR(estimates_of(cut, {cell})[0].offset, -box.value(centre), 0.1)
            << cell.transpose() << ", axis " << axis << ", turned by " << turn;
      }
    }
    EXPECT_GT(rests, 20) << turn;
  }
}

TEST(LdmFilled, NoSurfaceIsFartherThanItsColumnsSay) {
  int bounded = 0;
  for (const Workpiece& workpiece :
       {test::rough_blobs(), with_fractions(SphereShape(14.0), 48),
        with_fractions(PlateShape(2.2, 0.4), 48), with_fractions(BoxShape({20, 17, 9}), 48)}) {
    const std::vector<Cell> cells = test::surface_cells(workpiece);
    const auto estimates = estimates_of(workpiece, cells);
    LevelReader levels(workpiece.model());
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const auto farthest = farthest_surface(workpiece, levels, cells[k]);
      if (!farthest || !estimates[k].defined) continue;
      ++bounded;
      ASSERT_LE(std::abs(estimates[k].offset), *farthest + 1e-5f) << cells[k].transpose();
    }
  }
  EXPECT_GT(bounded, 1000);
}

TEST(LdmFilled, ALookThatEndsEarlySaysTheSameOfWhatIsEnough) {
  const Workpiece workpiece = test::rough_blobs();
  LevelReader levels(workpiece.model());
  int ended = 0, whole = 0;
  for (const Cell& cell : test::surface_cells(workpiece)) {
    const auto farthest = farthest_surface(workpiece, levels, cell);
    for (const float enough : {0.0f, 0.2f, 0.5f, 1.5f}) {
      const auto found = farthest_surface(workpiece, levels, cell, enough);
      ASSERT_EQ(found.has_value(), farthest.has_value());
      if (!found) continue;
      if (*farthest < enough) {
        ++whole;
        ASSERT_EQ(*found, *farthest);
      } else {
        ended += *found != *farthest;
        ASSERT_GE(*found, enough);
        ASSERT_LE(*found, *farthest);
      }
    }
  }
  EXPECT_GT(ended, 1000);
  EXPECT_GT(whole, 1000);
}

}  // namespace
}  // namespace sulcus::ldm_filled_test
