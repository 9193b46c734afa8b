#include "engine/normals/ldm.hpp"

#include <cstdio>

#include <gtest/gtest.h>

#include "tests/support/normal_errors.hpp"

namespace sulcus {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;
using test::NormalErrors;

constexpr int kNs = 6, kTrace = 12;

auto ldm_of(const Workpiece& workpiece, int neighbourhood = kNs) {
  return [&workpiece, neighbourhood](const Cell& c) {
    return estimate_ldm(workpiece, c, neighbourhood, kTrace);
  };
}

void print(const char* what, const NormalErrors& e) {
  std::printf("ldm, %s: mean %.3f deg, max %.2f deg, offset %.3f voxel, %d voxels, %d undefined\n",
              what, e.mean_deg, e.max_deg, e.mean_offset, e.voxels, e.undefined);
}

NormalErrors sphere_errors(int neighbourhood) {
  constexpr double kRadius = 50.0;
  const Vector3d centre(55.5, 55.5, 55.5);
  const Workpiece workpiece(test::ball({112, 112, 112}, 1e-4, centre, kRadius));
  return test::measure_errors(test::surface_cells(workpiece), ldm_of(workpiece, neighbourhood),
                              [&](const Cell& c) {
                                const Vector3d out = c.cast<double>() - centre;
                                return test::SurfaceTruth{out.normalized(), kRadius - out.norm()};
                              });
}

TEST(Ldm, SphereIsWithinHalfADegree) {
  const NormalErrors e = sphere_errors(kNs);
  print("sphere of 50 voxels, NS 6", e);
  EXPECT_EQ(e.undefined, 0);
  EXPECT_LT(e.mean_deg, 0.45);
  // Across (1, 1, 1) columns step by more than the map follows, and few rings are left.
  EXPECT_LT(e.max_deg, 15.0);
  EXPECT_LT(e.mean_offset, 0.15);
}

TEST(Ldm, AWiderNeighbourhoodIsMoreAccurateOnASphere) {
  const NormalErrors narrow = sphere_errors(3), wide = sphere_errors(8);
  print("sphere of 50 voxels, NS 3", narrow);
  print("sphere of 50 voxels, NS 8", wide);
  EXPECT_LT(wide.mean_deg, 0.5 * narrow.mean_deg);
}

TEST(Ldm, PlanesAcrossAnAxisAreExact) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int sign : {-1, 1}) {
      const Vector3d normal = sign * Vector3d::Unit(axis);
      const Workpiece workpiece(
          test::half_space({40, 40, 40}, 1e-4, normal, Vector3d::Constant(19.5)));
      const std::vector<Cell> cells = test::inner_surface(workpiece, 10);
      ASSERT_EQ(cells.size(), 400u);
      for (const Cell& c : cells) {
        const SurfaceEstimate e = estimate_ldm(workpiece, c, kNs, kTrace);
        ASSERT_TRUE(e.defined);
        ASSERT_EQ(e.normal, normal.cast<float>());
        ASSERT_EQ(e.offset, 0.5f);
      }
    }
  }
}

TEST(Ldm, TiltedPlanesAreWithinADegreeButForPlateaus) {
  const Vector3d through(23.6, 24.1, 23.8);
  double worst_deg = 0.0, worst_offset = 0.0;
  for (const Vector3d& normal : test::tilted_normals()) {
    const Workpiece workpiece(test::half_space({48, 48, 48}, 1e-4, normal, through));
    const NormalErrors e = test::measure_errors(
        test::inner_surface(workpiece, 14), ldm_of(workpiece), [&](const Cell& c) {
          return test::SurfaceTruth{normal, -normal.dot(c.cast<double>() - through)};
        });
    ASSERT_GT(e.voxels, 300);
    EXPECT_EQ(e.undefined, 0);
    // A plane that is tilted by less than a step in a window is flat there.
    const bool plateaus = normal.cwiseAbs().maxCoeff() > std::cos(0.1);
    EXPECT_LT(e.mean_deg, plateaus ? 2.0 : 1.0) << normal.transpose();
    EXPECT_LT(e.mean_offset, 0.15) << normal.transpose();
    worst_deg = std::max(worst_deg, e.mean_deg);
    worst_offset = std::max(worst_offset, e.mean_offset);
  }
  std::printf("ldm, tilted planes, worst of means: %.3f deg, offset %.3f voxel\n", worst_deg,
              worst_offset);
}

TEST(Ldm, ThinPlatesNeverGiveNaN) {
  for (const double thickness : {1.0, 2.0, 3.0}) {
    double error = 0.0;
    int voxels = 0, undefined = 0;
    for (const Vector3d& normal : test::tilted_normals()) {
      const Workpiece workpiece = test::plate(40, thickness, normal);
      for (const Cell& c : test::surface_cells(workpiece)) {
        const SurfaceEstimate e = estimate_ldm(workpiece, c, kNs, kTrace);
        ASSERT_TRUE(test::is_unit_or_undefined(e));
      }
      for (const Cell& c : test::inner_surface(workpiece, 12)) {
        const SurfaceEstimate e = estimate_ldm(workpiece, c, kNs, kTrace);
        undefined += !e.defined;
        if (!e.defined) continue;
        const double deg = test::angle_deg(e.normal.cast<double>(), normal);
        error += std::min(deg, 180.0 - deg);
        ++voxels;
      }
    }
    error /= std::max(1, voxels);
    std::printf("ldm, plates of %.0f: mean %.2f deg to the nearer sign, %d voxels, %d undefined\n",
                thickness, error, voxels, undefined);
    if (thickness >= 2.0) {
      EXPECT_LT(error, 3.0) << thickness;
    }
  }
}

TEST(Ldm, APlateOfTwoHasItsTwoSides) {
  for (const Vector3d& normal : test::tilted_normals()) {
    const Workpiece workpiece = test::plate(40, 2.0, normal);
    const Vector3d centre = Vector3d(20.13, 20.29, 20.41);
    int right = 0, wrong = 0;
    for (const Cell& c : test::inner_surface(workpiece, 12)) {
      const double side = normal.dot(c.cast<double>() - centre);
      if (std::abs(side) < 0.4) continue;  // in the middle: of either side
      const SurfaceEstimate e = estimate_ldm(workpiece, c, kNs, kTrace);
      const bool same = e.defined && side * e.normal.cast<double>().dot(normal) > 0.0;
      (same ? right : wrong) += 1;
    }
    EXPECT_GT(right, 250);
    EXPECT_LT(wrong, 0.02 * right) << normal.transpose();
  }
}

TEST(Ldm, EveryPatternOfTheSixNeighboursGivesAUnitNormalOrNone) {
  const Cell at(12, 12, 12);
  for (int pattern = 0; pattern < 64; ++pattern) {
    const Workpiece workpiece = test::pattern_workpiece(pattern, at);
    const SurfaceEstimate e = estimate_ldm(workpiece, at, kNs, kTrace);
    EXPECT_TRUE(test::is_unit_or_undefined(e)) << pattern;
    EXPECT_TRUE(test::same_bits(e, estimate_ldm(workpiece, at, kNs, kTrace))) << pattern;
  }
}

TEST(Ldm, SymmetricSurroundingsHaveNoNormal) {
  const Cell at(12, 12, 12);
  // Nothing exposed, each opposing pair, two pairs, all six: the centre has no side.
  for (int pattern : {0, 0b000011, 0b001100, 0b110000, 0b001111, 0b110011, 0b111100, 0b111111}) {
    EXPECT_FALSE(estimate_ldm(test::pattern_workpiece(pattern, at), at, kNs, kTrace).defined)
        << pattern;
  }
}

TEST(Ldm, RaggedShapesGiveAUnitNormalOrNoneAtEveryNeighbourhood) {
  const Workpiece workpiece(test::random_blobs({40, 24, 32}, 21));
  for (int ns : {1, 2, 6, kMaxNeighbourhood}) {
    for (int trace : {1, 5, kMaxTrace}) {
      for (const Cell& c : test::surface_cells(workpiece)) {
        ASSERT_TRUE(test::is_unit_or_undefined(estimate_ldm(workpiece, c, ns, trace)))
            << c.transpose() << " NS " << ns << " trace " << trace;
      }
    }
  }
}

TEST(Ldm, MirroredShapesHaveMirroredNormals) {
  const VoxelModel model = test::two_balls();
  const Workpiece workpiece{VoxelModel(model)};
  for (int axis = 0; axis < 3; ++axis) {
    const Workpiece mirror(test::mirrored(model, axis));
    int voxels = 0, off = 0;
    for (const Cell& c : test::surface_cells(workpiece)) {
      Cell image = c;
      image[axis] = model.grid.cells[axis] - 1 - c[axis];
      const SurfaceEstimate a = estimate_ldm(workpiece, c, kNs, kTrace);
      SurfaceEstimate b = estimate_ldm(mirror, image, kNs, kTrace);
      b.normal[axis] = -b.normal[axis];
      ++voxels;
      // Where two axes are equally dominant, the last bits of a sum choose between them.
      off += a.defined != b.defined || !a.normal.isApprox(b.normal, 1e-4f) ||
             std::abs(a.offset - b.offset) > 1e-4f;
    }
    std::printf("ldm, mirrored across %d: %d of %d differ\n", axis, off, voxels);
    EXPECT_LE(off, voxels / 500);
  }
}

TEST(Ldm, TheFarSideOfAWallDoesNotShowThrough) {
  // A wall of 3 voxels with a step behind it: the near side is a plane as if the wall were thick.
  const Workpiece workpiece(test::make_model({40, 40, 40}, 1e-4, [](const Cell& c) {
    return c.z() < 20 && c.z() >= (c.x() < 20 ? 17 : 10);
  }));
  for (int x = 12; x < 28; ++x) {
    const SurfaceEstimate e = estimate_ldm(workpiece, {x, 20, 19}, kNs, kTrace);
    EXPECT_EQ(e.normal, Eigen::Vector3f(0, 0, 1)) << x;
    EXPECT_EQ(e.offset, 0.5f) << x;
  }
}

TEST(Ldm, QueriesTogetherAreAnsweredAsOneByOne) {
  const Workpiece workpiece(test::random_blobs({40, 32, 48}, 9));
  std::vector<VoxelQuery> queries;
  for (const Cell& c : test::surface_cells(workpiece)) {
    queries.push_back({c, Eigen::Vector3f(0.3f, -0.2f, static_cast<float>(c.x() % 3) - 1.0f)});
  }
  queries.resize(queries.size() / 8 * 8 + 3);  // and a rest
  std::vector<SurfaceEstimate> together(queries.size());
  estimate_ldm(workpiece, queries, kNs, kTrace, together);
  for (std::size_t k = 0; k < queries.size(); ++k) {
    ASSERT_TRUE(test::same_bits(
        together[k], estimate_ldm(workpiece, queries[k].voxel, kNs, kTrace, queries[k].outward)))
        << k;
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
  // A block aslant: 2 to 10 voxels from an edge, where a centred window sees two faces.
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
  double sum = 0.0;
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
    ++count;
  }
  std::printf("ldm, 2 to 10 voxels from an edge: mean %.3f deg, %d voxels\n", sum / count, count);
  ASSERT_GT(count, 2000);
  EXPECT_LT(sum / count, 0.8);
}

}  // namespace
}  // namespace sulcus
