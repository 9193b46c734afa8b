#include "engine/normals/ldm.hpp"

#include <algorithm>
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include "engine/normals/ldm_fast.hpp"
#include "tests/support/normal_errors.hpp"

namespace sulcus::ldm_test {
namespace {

using test::estimate_ldm, test::estimate_ldm_fast;

using Eigen::Vector3d;

constexpr int kNs = 6, kTrace = 12;

TEST(Ldm, QueriesTogetherAreAnsweredAsOneByOne) {
  const Workpiece workpiece(test::random_blobs({40, 32, 48}, 9));
  std::vector<VoxelQuery> queries;
  for (const Cell& c : test::surface_cells(workpiece)) {
    queries.push_back({c, Eigen::Vector3f(0.3f, -0.2f, static_cast<float>(c.x() % 3) - 1.0f)});
  }
  queries.resize(queries.size() / 8 * 8 + 3);  // and a rest
  // As they were found, by leaves, as contacts come, and in no order.
  const auto by_leaves = [](const VoxelQuery& a, const VoxelQuery& b) {
    return leaf_key(voxel_key(a.voxel)) < leaf_key(voxel_key(b.voxel));
  };
  std::mt19937 random(3);
  for (int order = 0; order < 3; ++order) {
    if (order == 1) std::stable_sort(queries.begin(), queries.end(), by_leaves);
    if (order == 2) std::shuffle(queries.begin(), queries.end(), random);
    std::vector<SurfaceEstimate> ldm(queries.size()), fast(queries.size());
    estimate_ldm(workpiece, queries, kNs, kTrace, ldm);
    estimate_ldm_fast(workpiece, queries, kNs, kTrace, fast);
    for (std::size_t k = 0; k < queries.size(); ++k) {
      const auto& [voxel, outward] = queries[k];
      ASSERT_TRUE(test::same_bits(ldm[k], estimate_ldm(workpiece, voxel, kNs, kTrace, outward)))
          << order << " " << k;
      ASSERT_TRUE(
          test::same_bits(fast[k], estimate_ldm_fast(workpiece, voxel, kNs, kTrace, outward)))
          << order << " " << k;
    }
  }
}

TEST(Ldm, TheToolNamesTheSideWhereTheSolidDoesNot) {
  // A wall of one voxel.
  const Workpiece workpiece(test::block({40, 40, 40}, 1e-4, {2, 2, 20}, {38, 38, 21}));
  EXPECT_FALSE(estimate_ldm(workpiece, {20, 20, 20}, kNs, kTrace).defined);
  for (const float side : {1.0f, -1.0f}) {
    const SurfaceEstimate e =
        estimate_ldm(workpiece, {20, 20, 20}, kNs, kTrace, {0.2f, 0.1f, side});
    EXPECT_EQ(e.normal, Eigen::Vector3f(0, 0, side));
    EXPECT_EQ(e.offset, 0.5f);
  }
}

TEST(Ldm, TheToolVetoesTheWrongFaceOfAnEdgeButNotTheFarSideOfAWall) {
  // The ridge of a roof of 90 degrees: either face is as near.
  const Workpiece roof(test::make_model(
      {64, 40, 40}, 1e-4, [](const Cell& c) { return c.z() + std::abs(c.x() - 32) <= 24; }));
  for (const float side : {1.0f, -1.0f}) {
    const Eigen::Vector3f tool(side, 0.0f, 0.1f);
    const SurfaceEstimate e = estimate_ldm(roof, {32, 20, 24}, kNs, kTrace, tool);
    ASSERT_TRUE(e.defined);
    EXPECT_GE(e.normal.dot(tool), 0.0f);
  }
  const Workpiece wall(test::block({40, 40, 40}, 1e-4, {2, 2, 19}, {38, 38, 21}));
  const SurfaceEstimate far =
      estimate_ldm(wall, {20, 20, 19}, kNs, kTrace, Eigen::Vector3f::UnitZ());
  EXPECT_EQ(far.normal, Eigen::Vector3f(0, 0, -1));
}

TEST(Ldm, FacesHoldUpToTheEdge) {
  // A block tilted: 2 to 10 voxels from an edge, where a centred window sees two faces.
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.5, Vector3d::UnitY()) * Eigen::AngleAxisd(0.3, Vector3d::UnitX()))
          .toRotationMatrix();
  const Vector3d middle(32.1, 31.8, 32.4);
  constexpr double kHalf = 18.0;
  const auto local = [&](const Cell& c) {
    return Vector3d(turn.transpose() * (c.cast<double>() - middle));
  };
  const Workpiece workpiece(test::make_model(
      {64, 64, 64}, 1e-4, [&](const Cell& c) { return (local(c).array().abs() <= kHalf).all(); }));
  double sum = 0.0, sum_fast = 0.0;
  int count = 0;
  for (const Cell& c : test::surface_cells(workpiece)) {
    const Vector3d p = local(c);
    int face = 0;
    const double highest = p.cwiseAbs().maxCoeff(&face);
    Vector3d others = p.cwiseAbs();
    others[face] = 0.0;
    const double from_edge = kHalf - others.maxCoeff();
    if (from_edge < 2.0 || from_edge > 10.0 || kHalf - highest > 1.0) continue;
    const Vector3d truth = turn * Vector3d(Vector3d::Unit(face) * (p[face] > 0 ? 1 : -1));
    sum += test::angle_deg(estimate_ldm(workpiece, c, kNs, kTrace).normal.cast<double>(), truth);
    sum_fast +=
        test::angle_deg(estimate_ldm_fast(workpiece, c, kNs, kTrace).normal.cast<double>(), truth);
    ++count;
  }
  std::printf("2 to 10 voxels from an edge: ldm mean %.3f deg, ldm_fast %.3f, %d voxels\n",
              sum / count, sum_fast / count, count);
  ASSERT_GT(count, 2000);
  EXPECT_LT(sum / count, 0.5) << "where planes do not grow, 0.69";
  EXPECT_LT(sum_fast / count, 1.2) << "without a face across the edge, 1.69";
}

TEST(Ldm, WallsOfANarrowHoleHoldUpToItsRim) {
  // A hole of 9 voxels' radius, tilted through a plate: near its rims no half-disc is plane.
  const Vector3d middle(32.2, 31.7, 32.3), axis = Vector3d(0.25, -0.4, 0.88).normalized();
  const Vector3d across = axis.unitOrthogonal();
  constexpr double kRadius = 9.0, kHalf = 17.0;
  struct At {
    Vector3d out;  // of the hole's axis
    double radius, along;
  };
  const auto local = [&](const Cell& c) {
    const Vector3d p = c.cast<double>() - middle;
    const Vector3d out = p - p.dot(axis) * axis;
    return At{out, out.norm(), p.dot(axis)};
  };
  const Workpiece workpiece(test::make_model({64, 64, 64}, 1e-4, [&](const Cell& c) {
    const At at = local(c);
    return at.radius >= kRadius && std::abs(at.along) <= kHalf &&
           std::abs(at.out.dot(across)) < 24.0;
  }));
  double sum = 0.0;
  int count = 0;
  for (const Cell& c : test::surface_cells(workpiece)) {
    const At at = local(c);
    const double from_rim = kHalf - std::abs(at.along);
    if (at.radius > kRadius + 1.0 || from_rim < 1.0 || from_rim > 3.0) continue;
    const Vector3d truth = -at.out.normalized();
    sum += test::angle_deg(estimate_ldm(workpiece, c, kNs, kTrace).normal.cast<double>(), truth);
    ++count;
  }
  std::printf("1 to 3 voxels from a hole's rim: ldm mean %.3f deg, %d voxels\n", sum / count,
              count);
  ASSERT_GT(count, 100);
  EXPECT_LT(sum / count, 8.0) << "without parts of balls, 9.9";
}

/// Of a method on a face through the middle of a grid, away from the grid's own faces.
struct FaceErrors {
  double sum_deg = 0.0;
  int count = 0, wide = 0;
  double mean_deg() const { return sum_deg / count; }
};
template <class Estimate>
void add_face(const Vector3d& tilted, const Estimate& estimate, FaceErrors& errors) {
  const Vector3d normal = tilted.normalized();
  const Workpiece workpiece(test::half_space({64, 64, 64}, 1e-4, normal, {31.6, 32.3, 32.1}));
  for (const Cell& c : test::surface_cells(workpiece)) {
    if ((c.array() < 18).any() || (c.array() > 45).any()) continue;  // the grid cuts maps off
    const SurfaceEstimate found = estimate(workpiece, c);
    errors.wide += found.looked_wide() ? 1 : 0;
    errors.sum_deg += test::angle_deg(found.normal.cast<double>(), normal);
    ++errors.count;
  }
}

TEST(Ldm, FacesAreSeenFartherThanTheMapReaches) {
  // Tilts at which 13 columns see few steps, and as many that are none.
  FaceErrors errors;
  for (const Vector3d& tilt : {Vector3d(0.11, 0.03, 1.0), Vector3d(0.27, -0.4, 1.0),
                               Vector3d(-0.62, 0.21, 1.0), Vector3d(0.05, -0.09, 1.0)}) {
    add_face(
        tilt,
        [](const Workpiece& w, const Cell& c) { return estimate_ldm_fast(w, c, kNs, kTrace); },
        errors);
  }
  std::printf("ldm_fast, planes: mean %.3f deg, %d voxels\n", errors.mean_deg(), errors.count);
  ASSERT_GT(errors.count, 2000);
  EXPECT_GT(errors.wide, errors.count * 3 / 4);
  EXPECT_LT(errors.mean_deg(), 0.15) << "without wide maps, 0.355";
}

TEST(Ldm, FacesAlongDiagonalsOfTheGridAreSeenFarther) {
  // Steps of one voxel a column, and in 13 columns one or two that break the pattern: a quadric
  // takes these for a curvature, and wide maps go out of the trace.
  for (const Vector3d& tilted : {Vector3d(0.72, -0.69, 0.055), Vector3d(0.591, 0.582, 0.559)}) {
    FaceErrors errors;
    add_face(
        tilted, [](const Workpiece& w, const Cell& c) { return estimate_ldm(w, c, kNs, kTrace); },
        errors);
    std::printf("ldm, a face along a diagonal: mean %.3f deg, %d voxels\n", errors.mean_deg(),
                errors.count);
    ASSERT_GT(errors.count, 500);
    EXPECT_GT(errors.wide, errors.count / 2);
    EXPECT_LT(errors.mean_deg(), 0.6) << "by maps that are not wide, 1.1";
  }
}

TEST(Ldm, ResidualsSayMoreThanLeastSquaresHears) {
  // Balls small enough for fits in balls and in tilted frames, and large enough for whole maps.
  struct Case {
    double radius, most_deg;
  };
  for (const Case& ball : {Case{16.0, 0.36}, Case{60.0, 0.28}}) {
    const int cells = 2 * static_cast<int>(ball.radius / 8.0 + 1.5) * 8;
    const Vector3d centre = Vector3d::Constant(0.5 * cells) + Vector3d(0.13, -0.29, 0.37);
    const Workpiece workpiece(
        test::ball(Eigen::Vector3i::Constant(cells), 1e-4, centre, ball.radius));
    const test::NormalErrors e = test::measure_errors(
        test::surface_cells(workpiece),
        [&](const Cell& c) { return estimate_ldm(workpiece, c, kNs, kTrace); },
        [&](const Cell& c) {
          const Vector3d out = c.cast<double>() - centre;
          return test::SurfaceTruth{out.normalized(), ball.radius - out.norm()};
        });
    std::printf("ldm, ball of %.0f voxels: mean %.3f deg, offset %.4f, %d voxels\n", ball.radius,
                e.mean_deg, e.mean_offset, e.voxels);
    EXPECT_LT(e.mean_deg, ball.most_deg);
  }
}

TEST(Ldm, ARoughSurfaceHasTheNormalsOfItsMean) {
  // As burrs leave it: voxels are there or gone up to so far from the surface. Smaller balls and
  // halves of them find edges in it that are none.
  const Vector3d centre(32.1, 31.8, 32.4);
  constexpr double kRadius = 26.0;
  for (const double noise : {0.4, 0.7}) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> off(-noise, noise);
    const Workpiece workpiece(test::make_model({64, 64, 64}, 1e-4, [&](const Cell& c) {
      return (c.cast<double>() - centre).norm() + off(random) <= kRadius;
    }));
    std::vector<Cell> cells = test::surface_cells(workpiece);
    std::erase_if(cells, [&](const Cell& c) {
      return std::abs((c.cast<double>() - centre).norm() - kRadius) > 2.0;
    });
    const test::NormalErrors e = test::measure_errors(
        cells, [&](const Cell& c) { return estimate_ldm(workpiece, c, kNs, kTrace); },
        [&](const Cell& c) {
          const Vector3d out = c.cast<double>() - centre;
          return test::SurfaceTruth{out.normalized(), kRadius - out.norm()};
        });
    std::printf("ldm, %.1f voxels rough: mean %.3f deg, offset %.4f, %d voxels\n", noise,
                e.mean_deg, e.mean_offset, e.voxels);
    ASSERT_GT(e.voxels, 5000);
    EXPECT_LT(e.mean_deg, noise < 0.5 ? 1.3 : 2.2) << "where edges are looked for, 6.9 and 8.0";
  }
}

}  // namespace
}  // namespace sulcus::ldm_test
