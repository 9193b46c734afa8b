#include "engine/normals/exact.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "engine/normals/weighted_sum.hpp"
#include "tests/support/normal_errors.hpp"

namespace sulcus::exact_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::NormalErrors;

constexpr int kNs = 6;

SurfaceEstimate exact(const Workpiece& workpiece, const Cell& c) {
  return estimate_exact(workpiece, c, kNs);
}

void print(const char* what, const NormalErrors& e) {
  std::printf("exact, %s: mean %.3f deg, max %.2f deg, offset %.3f, %d voxels, %d undefined\n",
              what, e.mean_deg, e.max_deg, e.mean_offset, e.voxels, e.undefined);
}

/// Every n-th.
std::vector<Cell> some(const std::vector<Cell>& cells, std::size_t n) {
  std::vector<Cell> taken;
  for (std::size_t i = 0; i < cells.size(); i += n) taken.push_back(cells[i]);
  return taken;
}

TEST(Exact, SphereIsWithinHalfADegreeAndATenthOfAVoxel) {
  const Vector3d centre(55.5, 55.5, 55.5);
  const Workpiece workpiece(test::ball({112, 112, 112}, 1e-4, centre, 50.0));
  // One octant stands for all: the ball is centred.
  std::vector<Cell> cells = test::surface_cells(workpiece);
  std::erase_if(cells, [](const Cell& c) { return (c.array() < 56).any(); });
  const NormalErrors e = test::measure_errors(
      some(cells, 3), [&](const Cell& c) { return exact(workpiece, c); },
      [&](const Cell& c) {
        const Vector3d p = c.cast<double>() - centre;
        return test::SurfaceTruth{p.normalized(), 50.0 - p.norm()};
      });
  print("sphere of 50 voxels, NS 6", e);
  EXPECT_EQ(e.undefined, 0);
  EXPECT_LT(e.mean_deg, 0.5);
  EXPECT_LT(e.mean_offset, 0.1);
}

TEST(Exact, PlanesAcrossAnAxisAreExact) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {-1, 1}) {
      const Vector3d normal = sign * Vector3d::Unit(axis);
      const Workpiece workpiece(
          test::half_space({40, 40, 40}, 1e-4, normal, Vector3d::Constant(19.5)));
      for (const Cell& c : test::inner_surface(workpiece, 18)) {
        const SurfaceEstimate e = exact(workpiece, c);
        ASSERT_TRUE(e.defined);
        ASSERT_EQ(e.normal, normal.cast<float>());
        ASSERT_EQ(e.offset, 0.5f) << "the surface lies half-way between two voxels";
      }
    }
  }
}

TEST(Exact, TiltedPlanesAreWithinADegreeUnlessTheStepsAreLong) {
  // Five degrees off an axis a step is 11 voxels long, more than the filter reaches over.
  const Vector3d through(23.6, 24.1, 23.8);
  double worst = 0.0;
  for (const Vector3d& normal : test::tilted_normals()) {
    const Workpiece workpiece(test::half_space({48, 48, 48}, 1e-4, normal, through));
    const NormalErrors e = test::measure_errors(
        some(test::inner_surface(workpiece, 14), 7),
        [&](const Cell& c) { return exact(workpiece, c); },
        [&](const Cell& c) {
          return test::SurfaceTruth{normal, normal.dot(through - c.cast<double>())};
        });
    ASSERT_GT(e.voxels, 40);
    EXPECT_EQ(e.undefined, 0);
    EXPECT_LT(e.mean_deg, normal.cwiseAbs().maxCoeff() > 0.99 ? 2.6 : 1.0) << normal.transpose();
    EXPECT_LT(e.mean_offset, 0.15) << normal.transpose();
    worst = std::max(worst, e.mean_deg);
  }
  std::printf("exact, tilted planes, worst of means: %.3f deg\n", worst);
}

TEST(Exact, TheFilterLeavesOutWhatBelongsToAnotherFace) {
  // A box tilted; 3 to 6 voxels from its edges every cube of 13 reaches around one.
  const Vector3d centre(39.7, 40.1, 39.9);
  const Eigen::Matrix3d tilted = (Eigen::AngleAxisd(0.41, Vector3d(0.3, -0.5, 0.8).normalized()) *
                                  Eigen::AngleAxisd(0.67, Vector3d(0.9, 0.2, -0.3).normalized()))
                                     .toRotationMatrix();
  constexpr double kHalf = 20.0;
  const auto in_box = [&](const Cell& c) -> Vector3d {
    return tilted.transpose() * (c.cast<double>() - centre);
  };
  const Workpiece workpiece(test::make_model(
      {80, 80, 80}, 1e-4, [&](const Cell& c) { return in_box(c).cwiseAbs().maxCoeff() <= kHalf; }));
  std::vector<Cell> cells = test::surface_cells(workpiece);
  std::erase_if(cells, [&](const Cell& c) {
    Vector3d a = in_box(c).cwiseAbs();
    std::sort(a.data(), a.data() + 3);
    return a[1] > kHalf - 3.0 || a[1] < kHalf - 6.0;
  });
  const auto truth = [&](const Cell& c) {
    const Vector3d p = in_box(c);
    Eigen::Index face = 0;
    p.cwiseAbs().maxCoeff(&face);
    return test::SurfaceTruth{(p[face] > 0 ? 1.0 : -1.0) * tilted.col(face), 0.0};
  };
  const NormalErrors e = test::measure_errors(
      some(cells, 5), [&](const Cell& c) { return exact(workpiece, c); }, truth);
  const NormalErrors plain = test::measure_errors(
      some(cells, 5),
      [&](const Cell& c) {
        return estimate_weighted_sum(workpiece, c, kNs, WeightedSum::kAsStated);
      },
      truth);
  print("3 to 6 voxels from an edge, NS 6", e);
  ASSERT_GT(e.voxels, 300);
  EXPECT_LT(e.mean_deg, 3.0);
  EXPECT_LT(e.mean_deg, 0.25 * plain.mean_deg);
}

/// The method again, word for word and voxel by voxel: distances by trying every cell of the cube.
SurfaceEstimate plainly(const Workpiece& workpiece, const Cell& voxel, int ns) {
  const auto distance = [&](const Cell& q) {
    const bool solid = workpiece.solid(voxel + q);
    int squared = std::numeric_limits<int>::max();
    for (int k = -ns; k <= ns; ++k) {
      for (int j = -ns; j <= ns; ++j) {
        for (int i = -ns; i <= ns; ++i) {
          const Cell other(i, j, k);
          if (workpiece.solid(voxel + other) == solid) continue;
          squared = std::min(squared, (other - q).squaredNorm());
        }
      }
    }
    const float d = std::sqrt(static_cast<float>(squared));
    return solid ? 0.5f - d : d - 0.5f;
  };
  const auto gradient = [&](const Cell& q) {
    Vector3f g = Vector3f::Zero();
    for (int k = -1; k <= 1; ++k) {
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i)
          g += distance(q + Cell(i, j, k)) * Cell(i, j, k).cast<float>();
      }
    }
    return g;
  };
  const Vector3f central = gradient(Cell::Zero());
  if (central.norm() < 1e-3f) return {};
  Vector3f sum = Vector3f::Zero();
  float offset = 0.0f;
  int count = 0;
  const int reach = ns - 1;
  for (int k = -reach; k <= reach; ++k) {
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const Cell q(i, j, k);
        if (q.cast<double>().norm() > static_cast<double>(ns) - 0.5) continue;
        const Vector3f here = gradient(q), there = gradient(-q);
        if (here.isZero() || there.isZero()) continue;
        if (test::angle_deg(here.cast<double>(), central.cast<double>()) > 30.0) continue;
        if (test::angle_deg(there.cast<double>(), central.cast<double>()) > 30.0) continue;
        sum += here;
        if (q.squaredNorm() > 9) continue;
        offset -= distance(q);
        ++count;
      }
    }
  }
  return {sum.normalized(), offset / static_cast<float>(count), true};
}

TEST(Exact, IsWhatTheMethodSaysVoxelByVoxel) {
  // Ragged, and across the faces of the grid.
  const Workpiece workpiece(test::random_blobs({24, 24, 24}, 3));
  const std::vector<Cell> cells = test::surface_cells(workpiece);
  int defined = 0;
  for (const int ns : {1, 2, 3}) {
    for (const Cell& c : some(cells, ns == 3 ? 151 : 41)) {
      const SurfaceEstimate a = estimate_exact(workpiece, c, ns), b = plainly(workpiece, c, ns);
      ASSERT_EQ(a.defined, b.defined) << ns << ": " << c.transpose();
      ASSERT_LT((a.normal - b.normal).norm(), 1e-4f) << ns << ": " << c.transpose();
      ASSERT_NEAR(a.offset, b.offset, 1e-4f) << ns << ": " << c.transpose();
      defined += a.defined;
    }
  }
  EXPECT_GT(defined, 50);
}

TEST(Exact, WhereTheGradientVanishesThereIsNone) {
  const Workpiece lone(test::block({24, 24, 24}, 1e-4, {12, 12, 12}, {13, 13, 13}));
  EXPECT_FALSE(exact(lone, {12, 12, 12}).defined);
  const Workpiece wall(test::block({32, 32, 32}, 1e-4, {0, 0, 16}, {32, 32, 17}));
  EXPECT_FALSE(exact(wall, {16, 16, 16}).defined);
  const Workpiece full(test::block({32, 32, 32}, 1e-4, {0, 0, 0}, {32, 32, 32}));
  EXPECT_FALSE(exact(full, {16, 16, 16}).defined);
  // A wall of one voxel that is symmetric through the voxel, but in no mirror: sums that cancel
  // but for rounding.
  const Vector3d normal = Vector3d(0.31, 0.42, 0.87).normalized();
  const Workpiece tilted(test::make_model({32, 32, 32}, 1e-4, [&](const Cell& c) {
    return std::abs(normal.dot((c - Cell(16, 16, 16)).cast<double>())) <= 0.5;
  }));
  EXPECT_FALSE(exact(tilted, {16, 16, 16}).defined);
}

TEST(Exact, ThinPlatesAndRaggedShapesGiveAUnitNormalOrNone) {
  for (const Vector3d& normal : test::tilted_normals()) {
    const Workpiece workpiece = test::plate(32, 1.0, normal);
    for (const Cell& c : some(test::surface_cells(workpiece), 29)) {
      ASSERT_TRUE(test::is_unit_or_undefined(exact(workpiece, c)));
    }
  }
  const Workpiece workpiece(test::random_blobs({40, 24, 32}, 21));
  for (const int ns : {1, 6, 12}) {
    for (const Cell& c : some(test::surface_cells(workpiece), ns == 12 ? 151 : 17)) {
      ASSERT_TRUE(test::is_unit_or_undefined(estimate_exact(workpiece, c, ns)));
    }
  }
}

TEST(Exact, EveryPatternOfTheSixNeighboursGivesAUnitNormalOrNone) {
  for (int pattern = 0; pattern < 64; ++pattern) {
    const Workpiece workpiece = test::pattern_workpiece(pattern, {12, 12, 12});
    const SurfaceEstimate e = exact(workpiece, {12, 12, 12});
    EXPECT_TRUE(test::is_unit_or_undefined(e)) << pattern;
    EXPECT_TRUE(test::same_bits(e, exact(workpiece, {12, 12, 12}))) << pattern;
  }
}

TEST(Exact, MirroredShapesHaveMirroredNormals) {
  const VoxelModel model = test::two_balls();
  const Workpiece workpiece{VoxelModel(model)};
  for (int axis = 0; axis < 3; ++axis) {
    const Workpiece mirror(test::mirrored(model, axis));
    for (const Cell& c : some(test::surface_cells(workpiece), 11)) {
      Cell image = c;
      image[axis] = model.grid.cells[axis] - 1 - c[axis];
      const SurfaceEstimate a = exact(workpiece, c);
      SurfaceEstimate b = exact(mirror, image);
      b.normal[axis] = -b.normal[axis];
      ASSERT_EQ(a.defined, b.defined);
      ASSERT_LT((a.normal - b.normal).norm(), 1e-4f) << a.normal << " " << b.normal;
      ASSERT_NEAR(a.offset, b.offset, 1e-5f);
    }
  }
}

}  // namespace
}  // namespace sulcus::exact_test
