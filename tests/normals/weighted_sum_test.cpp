#include "engine/normals/weighted_sum.hpp"

#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/normal_errors.hpp"

namespace sulcus::weighted_sum_test {
namespace {

using Eigen::Vector3d;
using test::NormalErrors;

constexpr WeightedSum kKinds[] = {WeightedSum::kAsStated, WeightedSum::kAsPlotted};

/// The voxel at (12, 12, 12) and others, at offsets from it.
Workpiece voxels(const std::vector<Cell>& offsets) {
  const Cell at(12, 12, 12);
  VoxelModel model = test::make_model({24, 24, 24}, 1e-4, [&](const Cell& c) { return c == at; });
  for (const Cell& offset : offsets) model.set(at + offset, true);
  return Workpiece(std::move(model));
}

NormalErrors sphere_errors(WeightedSum kind, int ns) {
  const Vector3d centre(55.5, 55.5, 55.5);
  static const Workpiece workpiece(test::ball({112, 112, 112}, 1e-4, centre, 50.0));
  // One octant stands for all: the ball is centred.
  static const std::vector<Cell> cells = [] {
    std::vector<Cell> octant = test::surface_cells(workpiece);
    std::erase_if(octant, [](const Cell& c) { return (c.array() < 56).any(); });
    return octant;
  }();
  return test::measure_errors(
      cells, [&](const Cell& c) { return estimate_weighted_sum(workpiece, c, ns, kind); },
      [&](const Cell& c) {
        return test::SurfaceTruth{(c.cast<double>() - centre).normalized(), 0.0};
      });
}

TEST(WeightedSum, SphereSettlesWhereThePapersSphereDoes) {
  const NormalErrors stated = sphere_errors(WeightedSum::kAsStated, 6);
  const NormalErrors plotted = sphere_errors(WeightedSum::kAsPlotted, 6);
  std::printf("weighted sums, sphere of 50 voxels, NS 6: as stated %.3f deg, as plotted %.3f deg\n",
              stated.mean_deg, plotted.mean_deg);
  EXPECT_EQ(stated.undefined + plotted.undefined, 0);
  EXPECT_NEAR(stated.mean_deg, 3.5, 0.3);
  EXPECT_NEAR(plotted.mean_deg, 1.95, 0.2);
}

TEST(WeightedSum, ALargerCubeHelpsUpToNsThree) {
  for (const WeightedSum kind : kKinds) {
    EXPECT_GT(sphere_errors(kind, 1).mean_deg, sphere_errors(kind, 2).mean_deg);
    EXPECT_GT(sphere_errors(kind, 2).mean_deg, sphere_errors(kind, 3).mean_deg);
  }
}

TEST(WeightedSum, WeighsByTheDistance) {
  // Stated: both voxels pull with a unit vector. Plotted: the second has a quarter of the weight.
  const Workpiece workpiece = voxels({{1, 0, 0}, {0, 0, 2}});
  const auto angle_to = [&](WeightedSum kind, const Vector3d& expected) {
    const SurfaceEstimate e = estimate_weighted_sum(workpiece, {12, 12, 12}, 6, kind);
    return test::angle_deg(e.normal.cast<double>(), expected);
  };
  EXPECT_LT(angle_to(WeightedSum::kAsStated, Vector3d(-1, 0, -1)), 1e-4);
  EXPECT_LT(angle_to(WeightedSum::kAsPlotted, Vector3d(-1, 0, -0.25)), 1e-4);
}

TEST(WeightedSum, SeesTheCubeAndNothingBeyond) {
  const auto sees = [](const Cell& offset, int ns) {
    return estimate_weighted_sum(voxels({offset}), {12, 12, 12}, ns, WeightedSum::kAsStated)
        .defined;
  };
  for (const int ns : {1, 3, 11}) {
    for (const Cell& side : {Cell(-1, 0, 0), Cell(0, -1, 0), Cell(0, 0, -1), Cell(-1, -1, -1)}) {
      EXPECT_TRUE(sees(ns * side, ns)) << ns;
      EXPECT_FALSE(sees((ns + 1) * side, ns)) << ns;
      if (ns == 11) continue;  // the grid ends there
      EXPECT_TRUE(sees(-ns * side, ns)) << ns;
      EXPECT_FALSE(sees(-(ns + 1) * side, ns)) << ns;
    }
  }
}

TEST(WeightedSum, IsTheSumOverTheSolidVoxelsOfTheCube) {
  // Voxel by voxel, also where the cube leaves the grid.
  const Workpiece workpiece(test::random_blobs({24, 40, 32}, 5));
  const std::vector<Cell> cells = test::surface_cells(workpiece);
  for (const int ns : {1, 4, 12}) {
    for (std::size_t n = 0; n < cells.size(); n += 67) {
      Vector3d stated = Vector3d::Zero(), plotted = Vector3d::Zero();
      for (int k = -ns; k <= ns; ++k) {
        for (int j = -ns; j <= ns; ++j) {
          for (int i = -ns; i <= ns; ++i) {
            const Vector3d x(i, j, k);
            if (x.isZero() || !workpiece.solid(cells[n] + Cell(i, j, k))) continue;
            stated -= x / x.norm();
            plotted -= x / std::pow(x.norm(), 3);
          }
        }
      }
      const SurfaceEstimate a =
          estimate_weighted_sum(workpiece, cells[n], ns, WeightedSum::kAsStated);
      const SurfaceEstimate b =
          estimate_weighted_sum(workpiece, cells[n], ns, WeightedSum::kAsPlotted);
      // Where the solid is nearly symmetric both are rounding.
      if (stated.norm() > 1e-3) {
        ASSERT_LT((a.normal.cast<double>() - stated.normalized()).norm(), 1e-4);
      }
      if (plotted.norm() > 1e-3) {
        ASSERT_LT((b.normal.cast<double>() - plotted.normalized()).norm(), 1e-4);
      }
    }
  }
}

TEST(WeightedSum, PlanesAcrossAnAxisAreExact) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {-1, 1}) {
      const Vector3d normal = sign * Vector3d::Unit(axis);
      const Workpiece workpiece(
          test::half_space({40, 40, 40}, 1e-4, normal, Vector3d::Constant(19.5)));
      for (const Cell& c : test::inner_surface(workpiece, 16)) {
        for (const WeightedSum kind : kKinds) {
          const SurfaceEstimate e = estimate_weighted_sum(workpiece, c, 12, kind);
          ASSERT_TRUE(e.defined);
          ASSERT_EQ(e.normal, normal.cast<float>());
          ASSERT_EQ(e.offset, 0.0f) << "depth is measured at voxel centres";
        }
      }
    }
  }
}

TEST(WeightedSum, SymmetricSolidsHaveNone) {
  const Workpiece lone = voxels({}), bar = voxels({{1, 2, -1}, {-1, -2, 1}});
  const Workpiece wall(test::block({32, 32, 32}, 1e-4, {0, 0, 16}, {32, 32, 17}));
  for (const WeightedSum kind : kKinds) {
    EXPECT_FALSE(estimate_weighted_sum(lone, {12, 12, 12}, 6, kind).defined);
    EXPECT_FALSE(estimate_weighted_sum(bar, {12, 12, 12}, 6, kind).defined);
    EXPECT_FALSE(estimate_weighted_sum(wall, {16, 16, 16}, 12, kind).defined);
  }
}

TEST(WeightedSum, EveryPatternOfTheSixNeighboursGivesAUnitNormalOrNone) {
  for (int pattern = 0; pattern < 64; ++pattern) {
    const Workpiece workpiece = test::pattern_workpiece(pattern, {12, 12, 12});
    for (const WeightedSum kind : kKinds) {
      const SurfaceEstimate e = estimate_weighted_sum(workpiece, {12, 12, 12}, 6, kind);
      EXPECT_TRUE(test::is_unit_or_undefined(e)) << pattern;
    }
  }
}

TEST(WeightedSum, RaggedShapesGiveAUnitNormalOrNone) {
  const Workpiece workpiece(test::random_blobs({40, 24, 32}, 21));
  for (const int ns : {1, 6, 12}) {
    for (const Cell& c : test::surface_cells(workpiece)) {
      for (const WeightedSum kind : kKinds) {
        ASSERT_TRUE(test::is_unit_or_undefined(estimate_weighted_sum(workpiece, c, ns, kind)));
      }
    }
  }
}

TEST(WeightedSum, MirroredShapesHaveMirroredNormalsToTheBit) {
  const VoxelModel model = test::two_balls();
  const Workpiece workpiece{VoxelModel(model)};
  for (int axis = 0; axis < 3; ++axis) {
    const Workpiece mirror(test::mirrored(model, axis));
    for (const Cell& c : test::surface_cells(workpiece)) {
      Cell image = c;
      image[axis] = model.grid.cells[axis] - 1 - c[axis];
      const SurfaceEstimate a = estimate_weighted_sum(workpiece, c, 4, WeightedSum::kAsPlotted);
      SurfaceEstimate b = estimate_weighted_sum(mirror, image, 4, WeightedSum::kAsPlotted);
      b.normal[axis] = -b.normal[axis];
      ASSERT_TRUE(test::same_bits(a, b)) << a.normal << " " << b.normal;
    }
  }
}

}  // namespace
}  // namespace sulcus::weighted_sum_test
