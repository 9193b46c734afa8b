// What both tiers of the local distance map promise.
#include <cstdio>

#include <gtest/gtest.h>

#include "engine/normals/coarse_normal.hpp"
#include "engine/normals/ldm.hpp"
#include "engine/normals/ldm_fast.hpp"
#include "tests/support/normal_errors.hpp"

namespace sulcus::ldm_tiers_test {
namespace {

using test::estimate_ldm, test::estimate_ldm_fast;

using Eigen::Vector3d;
using Eigen::Vector3i;
using test::NormalErrors;

constexpr int kNs = 6, kTrace = 12;

struct Tier {
  const char* name;
  SurfaceEstimate (*estimate)(const Workpiece&, const Cell&, int, int, const Eigen::Vector3f&);
};
void PrintTo(const Tier& tier, std::ostream* out) { *out << tier.name; }

class LdmTiers : public ::testing::TestWithParam<Tier> {
 protected:
  static SurfaceEstimate estimate(const Workpiece& workpiece, const Cell& c,
                                  int neighbourhood = kNs, int trace = kTrace) {
    return GetParam().estimate(workpiece, c, neighbourhood, trace, Eigen::Vector3f::Zero());
  }
  static auto of(const Workpiece& workpiece, int neighbourhood = kNs) {
    return [&workpiece, neighbourhood](const Cell& c) {
      return estimate(workpiece, c, neighbourhood);
    };
  }

  static void print(const char* what, const NormalErrors& e) {
    std::printf("%s, %s: mean %.3f deg, max %.2f deg, offset %.3f voxel, %d voxels, %d undefined\n",
                GetParam().name, what, e.mean_deg, e.max_deg, e.mean_offset, e.voxels, e.undefined);
  }

  static NormalErrors sphere_errors(int neighbourhood) {
    constexpr double kRadius = 50.0;
    const Vector3d centre(55.5, 55.5, 55.5);
    const Workpiece workpiece(test::ball({112, 112, 112}, 1e-4, centre, kRadius));
    return test::measure_errors(test::surface_cells(workpiece), of(workpiece, neighbourhood),
                                [&](const Cell& c) {
                                  const Vector3d out = c.cast<double>() - centre;
                                  return test::SurfaceTruth{out.normalized(), kRadius - out.norm()};
                                });
  }
};

INSTANTIATE_TEST_SUITE_P(
    Both, LdmTiers,
    ::testing::Values(Tier{"ldm", static_cast<decltype(Tier::estimate)>(estimate_ldm)},
                      Tier{"ldm_fast", static_cast<decltype(Tier::estimate)>(estimate_ldm_fast)}),
    [](const auto& tier) { return std::string(tier.param.name); });

TEST_P(LdmTiers, SphereIsWithinHalfADegree) {
  const NormalErrors e = sphere_errors(kNs);
  print("sphere of 50 voxels, NS 6", e);
  EXPECT_EQ(e.undefined, 0);
  EXPECT_LT(e.mean_deg, 0.45);
  // Across (1, 1, 1) columns step by more than the map follows, and few rings are left.
  EXPECT_LT(e.max_deg, 15.0);
  EXPECT_LT(e.mean_offset, 0.15);
}

TEST_P(LdmTiers, AWiderNeighbourhoodIsMoreAccurateOnASphere) {
  const NormalErrors narrow = sphere_errors(3), wide = sphere_errors(8);
  print("sphere of 50 voxels, NS 3", narrow);
  print("sphere of 50 voxels, NS 8", wide);
  EXPECT_LT(wide.mean_deg, 0.5 * narrow.mean_deg);
}

TEST_P(LdmTiers, PlanesAcrossAnAxisAreExact) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int sign : {-1, 1}) {
      const Vector3d normal = sign * Vector3d::Unit(axis);
      const Workpiece workpiece(
          test::half_space({40, 40, 40}, 1e-4, normal, Vector3d::Constant(19.5)));
      const std::vector<Cell> cells = test::inner_surface(workpiece, 10);
      ASSERT_EQ(cells.size(), 400u);
      for (const Cell& c : cells) {
        const SurfaceEstimate e = estimate(workpiece, c);
        ASSERT_TRUE(e.defined);
        ASSERT_EQ(e.normal, normal.cast<float>());
        ASSERT_EQ(e.offset, 0.5f);
      }
    }
  }
}

TEST_P(LdmTiers, TiltedPlanesAreWithinADegreeButForPlateaus) {
  const Vector3d through(23.6, 24.1, 23.8);
  double worst_deg = 0.0, worst_offset = 0.0;
  for (const Vector3d& normal : test::tilted_normals()) {
    const Workpiece workpiece(test::half_space({48, 48, 48}, 1e-4, normal, through));
    const NormalErrors e =
        test::measure_errors(test::inner_surface(workpiece, 14), of(workpiece), [&](const Cell& c) {
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
  std::printf("%s, tilted planes, worst of means: %.3f deg, offset %.3f voxel\n", GetParam().name,
              worst_deg, worst_offset);
}

TEST_P(LdmTiers, ThinPlatesNeverGiveNaN) {
  for (const double thickness : {1.0, 2.0, 3.0}) {
    double error = 0.0;
    int voxels = 0, undefined = 0;
    for (const Vector3d& normal : test::tilted_normals()) {
      const Workpiece workpiece = test::plate(40, thickness, normal);
      for (const Cell& c : test::surface_cells(workpiece)) {
        const SurfaceEstimate e = estimate(workpiece, c);
        ASSERT_TRUE(test::is_unit_or_undefined(e));
      }
      for (const Cell& c : test::inner_surface(workpiece, 12)) {
        const SurfaceEstimate e = estimate(workpiece, c);
        undefined += !e.defined;
        if (!e.defined) continue;
        const double deg = test::angle_deg(e.normal.cast<double>(), normal);
        error += std::min(deg, 180.0 - deg);
        ++voxels;
      }
    }
    error /= std::max(1, voxels);
    std::printf("%s, plates of %.0f: mean %.2f deg to the nearer sign, %d voxels, %d undefined\n",
                GetParam().name, thickness, error, voxels, undefined);
    if (thickness >= 2.0) {
      EXPECT_LT(error, 3.0) << thickness;
    }
  }
}

TEST_P(LdmTiers, APlateOfTwoHasItsTwoSides) {
  for (const Vector3d& normal : test::tilted_normals()) {
    const Workpiece workpiece = test::plate(40, 2.0, normal);
    const Vector3d centre = Vector3d(20.13, 20.29, 20.41);
    int right = 0, wrong = 0;
    for (const Cell& c : test::inner_surface(workpiece, 12)) {
      const double side = normal.dot(c.cast<double>() - centre);
      if (std::abs(side) < 0.4) continue;  // in the middle: of either side
      const SurfaceEstimate e = estimate(workpiece, c);
      const bool same = e.defined && side * e.normal.cast<double>().dot(normal) > 0.0;
      (same ? right : wrong) += 1;
    }
    EXPECT_GT(right, 250);
    EXPECT_LT(wrong, 0.02 * right) << normal.transpose();
  }
}

TEST_P(LdmTiers, EveryPatternOfTheSixNeighboursGivesAUnitNormalOrNone) {
  const Cell at(12, 12, 12);
  for (int pattern = 0; pattern < 64; ++pattern) {
    const Workpiece workpiece = test::pattern_workpiece(pattern, at);
    const SurfaceEstimate e = estimate(workpiece, at);
    EXPECT_TRUE(test::is_unit_or_undefined(e)) << pattern;
    EXPECT_TRUE(test::same_bits(e, estimate(workpiece, at))) << pattern;
  }
}

TEST_P(LdmTiers, SymmetricSurroundingsHaveNoNormal) {
  const Cell at(12, 12, 12);
  // Nothing exposed, each opposing pair, two pairs, all six: the centre has no side.
  for (int pattern : {0, 0b000011, 0b001100, 0b110000, 0b001111, 0b110011, 0b111100, 0b111111}) {
    EXPECT_FALSE(estimate(test::pattern_workpiece(pattern, at), at).defined) << pattern;
  }
}

TEST_P(LdmTiers, RaggedShapesGiveAUnitNormalOrNoneAtEveryNeighbourhood) {
  const Workpiece workpiece(test::random_blobs({40, 24, 32}, 21));
  for (int ns : {1, 2, 6, kMaxNeighbourhood}) {
    for (int trace : {1, 5, kMaxTrace}) {
      for (const Cell& c : test::surface_cells(workpiece)) {
        ASSERT_TRUE(test::is_unit_or_undefined(estimate(workpiece, c, ns, trace)))
            << c.transpose() << " NS " << ns << " trace " << trace;
      }
    }
  }
}

TEST_P(LdmTiers, MirroredShapesHaveMirroredNormals) {
  const VoxelModel model = test::two_balls();
  const Workpiece workpiece{VoxelModel(model)};
  for (int axis = 0; axis < 3; ++axis) {
    const Workpiece mirror(test::mirrored(model, axis));
    int voxels = 0, off = 0;
    for (const Cell& c : test::surface_cells(workpiece)) {
      Cell image = c;
      image[axis] = model.grid.cells[axis] - 1 - c[axis];
      const SurfaceEstimate a = estimate(workpiece, c);
      SurfaceEstimate b = estimate(mirror, image);
      b.normal[axis] = -b.normal[axis];
      ++voxels;
      // Where two axes are equally dominant, the last bits of a sum choose between them.
      off += a.defined != b.defined || !a.normal.isApprox(b.normal, 1e-4f) ||
             std::abs(a.offset - b.offset) > 1e-4f;
    }
    std::printf("%s, mirrored across %d: %d of %d differ\n", GetParam().name, axis, off, voxels);
    EXPECT_LE(off, voxels / 500);
  }
}

TEST_P(LdmTiers, TheFarSideOfAWallDoesNotShowThrough) {
  // A wall of 3 voxels with a step behind it: the near side is a plane as if the wall were thick.
  const Workpiece workpiece(test::make_model({40, 40, 40}, 1e-4, [](const Cell& c) {
    return c.z() < 20 && c.z() >= (c.x() < 20 ? 17 : 10);
  }));
  for (int x = 12; x < 28; ++x) {
    const SurfaceEstimate e = estimate(workpiece, {x, 20, 19});
    EXPECT_EQ(e.normal, Eigen::Vector3f(0, 0, 1)) << x;
    EXPECT_EQ(e.offset, 0.5f) << x;
  }
}

TEST_P(LdmTiers, NoNormalPointsAwayFromTheToolWhereTheCoarseOneDoesNot) {
  const Workpiece workpiece(test::random_blobs({40, 32, 48}, 9));
  int vetoed = 0;
  for (const Cell& c : test::surface_cells(workpiece)) {
    const Eigen::Vector3f coarse = coarse_normal(workpiece, c).cast<float>();
    // Nearly across the coarse normal, on its side.
    const Eigen::Vector3f tool = coarse.cross(Eigen::Vector3f(0.3f, -0.5f, 0.8f)) + 0.05f * coarse;
    if (coarse == Eigen::Vector3f::Zero() || coarse.dot(tool) <= 0.0f) continue;
    const SurfaceEstimate free = estimate(workpiece, c);
    const SurfaceEstimate told = GetParam().estimate(workpiece, c, kNs, kTrace, tool);
    ASSERT_TRUE(told.defined);
    EXPECT_GE(told.normal.dot(tool), 0.0f) << c.transpose();
    vetoed += free.normal.dot(tool) < 0.0f;
  }
  EXPECT_GT(vetoed, 100);
}

TEST_P(LdmTiers, AtConcaveEdgesTheToolIsHeardThoughTheCoarseNormalPointsAway) {
  const Workpiece workpiece(test::random_blobs({40, 32, 48}, 9));
  int voxels = 0;
  for (const Cell& c : test::surface_cells(workpiece)) {
    const Eigen::Vector3f coarse = coarse_normal(workpiece, c).cast<float>().normalized();
    const Eigen::Vector3f across = coarse.cross(Eigen::Vector3f(0.3f, -0.5f, 0.8f)).normalized();
    if (!(across.norm() > 0.9f) || coarse.norm() < 0.9f) continue;
    // 115 degrees from it, and 125, as on the far side of a wall.
    const Eigen::Vector3f tool = 0.906f * across - 0.423f * coarse;
    const SurfaceEstimate told = GetParam().estimate(workpiece, c, kNs, kTrace, tool);
    ASSERT_TRUE(test::is_unit_or_undefined(told) && told.defined);
    EXPECT_GE(told.normal.dot(tool), 0.0f) << c.transpose();
    const SurfaceEstimate free = estimate(workpiece, c);
    const Eigen::Vector3f behind = 0.819f * across - 0.574f * coarse;
    EXPECT_TRUE(test::same_bits(free, GetParam().estimate(workpiece, c, kNs, kTrace, behind)));
    ++voxels;
  }
  EXPECT_GT(voxels, 1000);
}

}  // namespace
}  // namespace sulcus::ldm_tiers_test
