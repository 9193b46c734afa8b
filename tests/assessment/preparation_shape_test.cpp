#include "engine/assessment/preparation_shape.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/assessment/insertion_frame.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "tests/assessment/turned_solid.hpp"
#include "tests/support/shapes.hpp"

// Truth by construction: solids of revolution of known taper, depth and width, at five attitudes in
// the grid.

namespace sulcus::preparation_shape_test {
namespace {

using test::Profile;

double tan_deg(double degrees) { return std::tan(degrees * std::numbers::pi / 180.0); }

/// A block, as it was.
Profile block() { return {{0, -3}, {3.5, -3}, {3.5, 3}, {0, 3}}; }

/// With a round cavity in its upper face: radius at the floor, depth, taper of a wall.
Profile cavity(double radius, double depth, double taper_deg) {
  const double top = radius + depth * tan_deg(taper_deg);
  return {{0, -3}, {3.5, -3}, {3.5, 3}, {top, 3}, {radius, 3 - depth}, {0, 3 - depth}};
}

/// A crown's stump: 1 mm off its top, a shoulder 4 mm below the top of the block, which falls
/// outward by so many degrees.
Profile crown(double margin, double taper_deg, double slope_deg = 0.0) {
  const double foot = 3.5 - margin, head = foot - 3.0 * tan_deg(taper_deg);
  return {{0, -3},    {3.5, -3}, {3.5, -1.0 - margin * tan_deg(slope_deg)},
          {foot, -1}, {head, 2}, {0, 2}};
}

struct Attitude {
  std::string name;
  Eigen::Affine3d placed;
};
std::vector<Attitude> attitudes() {
  std::vector<Attitude> all;
  const auto add = [&](const char* name, double degrees, const Eigen::Vector3d& axis) {
    all.push_back({name, Eigen::Affine3d(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0,
                                                           axis.normalized()))});
  };
  add("upright", 0, {0, 0, 1});
  add("on its side", 90, {1, 0, 0});
  add("leaning", 17, {0, 1, 0});
  add("askew", 33, {1, 2, 0.5});
  add("upside down and askew", 160, {1, -0.4, 0.3});
  return all;
}

class ShapeOfVoxels : public ::testing::TestWithParam<int> {
 protected:
  static constexpr double kVoxel_mm = 0.05;
  const Attitude at_ = attitudes()[static_cast<std::size_t>(GetParam())];

  TriangleMesh surface(const Profile& profile) const {
    return closed_surface(test::turned_voxels(profile, kVoxel_mm, 4.8, at_.placed));
  }
  std::optional<PreparationShape> shape(const Profile& after, AssessedKind kind) const {
    return preparation_shape(surface(block()), surface(after),
                             {.kind = kind, .insertion = at_.placed.linear().col(2)});
  }
};

TEST_P(ShapeOfVoxels, ACavityHasItsTaperDepthAndWidth) {
  double depth = 1.0;
  for (const double convergence : {0.0, 4.0, 6.0, 10.0, 20.0}) {
    SCOPED_TRACE(at_.name + ", " + std::to_string(convergence) + " degrees");
    const auto found = shape(cavity(1.2, depth, 0.5 * convergence), AssessedKind::kCavity);
    ASSERT_TRUE(found && found->convergence_deg && found->depth_mm && found->isthmus_mm);
    EXPECT_NEAR(found->convergence_deg->value, convergence, 0.5);
    EXPECT_NEAR(found->depth_mm->value, depth, 0.5 * kVoxel_mm);
    const double halfway = 2.4 + depth * tan_deg(0.5 * convergence);
    EXPECT_NEAR(found->isthmus_mm->value, halfway, 0.5 * kVoxel_mm);
    EXPECT_EQ(found->undercut_mm2.value, 0.0);
    const double top = halfway + depth * tan_deg(0.5 * convergence);
    EXPECT_NEAR(found->removed_mm3,
                std::numbers::pi * depth / 12.0 * (2.4 * 2.4 + 2.4 * top + top * top), 0.15);
    depth = depth == 2.0 ? 1.5 : depth + 0.5;
  }
}

TEST_P(ShapeOfVoxels, ACrownHasItsTaperDepthAndMargin) {
  double margin = 0.6;
  for (const double convergence : {0.0, 6.0, 20.0}) {
    SCOPED_TRACE(at_.name + ", " + std::to_string(convergence) + " degrees");
    const auto found = shape(crown(margin, 0.5 * convergence), AssessedKind::kCrown);
    ASSERT_TRUE(found && found->convergence_deg && found->depth_mm && found->margin_mm);
    EXPECT_NEAR(found->convergence_deg->value, convergence, 0.5);
    EXPECT_NEAR(found->depth_mm->value, 1.0, 0.5 * kVoxel_mm);
    EXPECT_NEAR(found->margin_mm->value, margin, 0.5 * kVoxel_mm);
    EXPECT_EQ(found->undercut_mm2.value, 0.0);
    margin += 0.2;
  }
}

TEST_P(ShapeOfVoxels, ACrownsFinishLineHasItsSlope) {
  for (const double slope : {0.0, 10.0, 25.0}) {
    SCOPED_TRACE(at_.name + ", " + std::to_string(slope) + " degrees");
    const auto found = shape(crown(1.2, 3.0, slope), AssessedKind::kCrown);
    ASSERT_TRUE(found && found->margin_slope_deg);
    EXPECT_NEAR(found->margin_slope_deg->value, slope, 2.0);
  }
}

/// Of a tooth that is wider higher up, as teeth are above their neck.
TEST_P(ShapeOfVoxels, ACrownsFinishLineIsTheStumpsAlsoBelowTheEquator) {
  SCOPED_TRACE(at_.name);
  const Profile tooth{{0, -3}, {3.2, -3}, {3.2, -1.2}, {3.7, 0.5}, {3.5, 3}, {0, 3}};
  const Profile stump{{0, -3}, {3.2, -3}, {3.2, -1.2}, {2.2, -1.2}, {2.0, 2}, {0, 2}};
  const auto found =
      preparation_shape(surface(tooth), surface(stump),
                        {.kind = AssessedKind::kCrown, .insertion = at_.placed.linear().col(2)});
  ASSERT_TRUE(found && found->margin_mm && found->depth_mm && found->margin_slope_deg);
  EXPECT_NEAR(found->margin_mm->value, 1.0, 0.5 * kVoxel_mm);
  EXPECT_NEAR(found->depth_mm->value, 1.0, 0.5 * kVoxel_mm);
  EXPECT_NEAR(found->greatest_depth_mm->value, 1.0, 1.5 * kVoxel_mm) << "not that of the shoulder";
  EXPECT_NEAR(found->margin_slope_deg->value, 0.0, 2.0);
  // Its top as it was.
  const Profile sides{{0, -3}, {3.2, -3}, {3.2, -1.2}, {2.2, -1.2}, {2.0, 3}, {0, 3}};
  const auto axial =
      preparation_shape(surface(tooth), surface(sides),
                        {.kind = AssessedKind::kCrown, .insertion = at_.placed.linear().col(2)});
  ASSERT_TRUE(axial && axial->margin_mm && axial->convergence_deg);
  EXPECT_NEAR(axial->margin_mm->value, 1.0, 0.5 * kVoxel_mm);
  EXPECT_FALSE(axial->depth_mm);
}

TEST_P(ShapeOfVoxels, ALedgeIsAnUndercutAndARoughWallIsNone) {
  SCOPED_TRACE(at_.name);
  // 0.1 mm further out below a rim.
  const Profile ledge{{0, -3}, {3.5, -3}, {3.5, 3}, {1.2, 3}, {1.2, 2}, {1.3, 2}, {1.3, 1}, {0, 1}};
  const auto found = shape(ledge, AssessedKind::kCavity);
  ASSERT_TRUE(found);
  const double area = std::numbers::pi * (1.3 * 1.3 - 1.2 * 1.2);
  EXPECT_NEAR(found->undercut_mm2.value, area, 0.2 * area);
  // Grooves of 0.05 mm.
  Profile rough{{0, -3}, {3.5, -3}, {3.5, 3}};
  for (int i = 0; i < 20; ++i) rough.emplace_back(i % 2 ? 1.2 : 1.25, 3.0 - 0.1 * i);
  rough.emplace_back(1.2, 1.0);
  rough.emplace_back(0.0, 1.0);
  const auto none = shape(rough, AssessedKind::kCavity);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->undercut_mm2.value, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Attitudes, ShapeOfVoxels, ::testing::Range(0, 5));

TEST(ShapeOfTwoCavities, IsAsWideAsEachOfThem) {
  constexpr double kVoxel_m = 0.05e-3;
  const auto block_with = [&](int pits) {
    return closed_surface(test::make_model({96, 64, 48}, kVoxel_m, [&](const Cell& c) {
      if ((c.array() < 4).any() || c.x() >= 92 || c.y() >= 60 || c.z() >= 44) return false;
      bool pit = false;
      for (int n = 0; n < pits; ++n) {
        pit = pit || std::hypot(c.x() - 47.5 + (n == 0 ? -20.0 : 20.0), c.y() - 31.5) < 11.0;
      }
      return !(pit && c.z() >= 24);  // 1 mm deep, 1.1 mm wide, 2 mm apart
    }));
  };
  const auto found = preparation_shape(block_with(0), block_with(2), {});
  ASSERT_TRUE(found && found->isthmus_mm && found->width_mm);
  EXPECT_NEAR(found->isthmus_mm->value, 1.1, 0.05);
  EXPECT_NEAR(found->width_mm->value, 1.1, 0.05);
}

/// With a pit over it or without, however deep that is: 1 mm wide, right through the block.
TEST(ShapeOfATunnel, IsAnUndercutFromEndToEnd) {
  constexpr double kVoxel_m = 0.05e-3;
  const auto block_with = [&](bool tunnel, int pit) {
    return closed_surface(test::make_model({96, 64, 48}, kVoxel_m, [&](const Cell& c) {
      if ((c.array() < 4).any() || c.x() >= 92 || c.y() >= 60 || c.z() >= 44) return false;
      const bool in_tunnel = c.y() >= 20 && c.y() < 40 && c.z() >= 10 && c.z() < 22;
      const bool in_pit = std::hypot(c.x() - 47.5, c.y() - 29.5) < 9.0 && c.z() >= 44 - pit;
      return !(tunnel && in_tunnel) && !in_pit;
    }));
  };
  const TriangleMesh before = block_with(false, 0);
  double bottom_m = 1.0;
  for (const auto& p : before.positions) bottom_m = std::min(bottom_m, double{p.z()});
  for (const int pit : {0, 12}) {  // its floor is above the tunnel
    const auto found = preparation_shape(before, block_with(true, pit), {});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->undercut_mm2.value, 4.4 * 1.0, 0.1 * 4.4) << pit;
    EXPECT_NEAR(found->undercut_mm2.at_m.z() - bottom_m, 12 * kVoxel_m, kVoxel_m) << pit;
  }
}

class ShapeOfMeshes : public ::testing::Test {
 protected:
  /// Of other corners to the circle before and after.
  static PreparationShape shape(const Profile& before, const Profile& after, AssessedKind kind,
                                const Eigen::Affine3d& placed) {
    return preparation_shape(test::turned_mesh(before, 200, placed),
                             test::turned_mesh(after, 331, placed),
                             {.kind = kind, .insertion = placed.linear().col(2)})
        .value();
  }
};

TEST_F(ShapeOfMeshes, AreMeasuredAsTheyAreWhereverTheyStand) {
  Eigen::Affine3d placed(Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -1, 0.2).normalized()));
  placed.pretranslate(Eigen::Vector3d(0.01, -0.03, 0.02));
  const auto found = shape(block(), cavity(1.0, 1.5, 3.0), AssessedKind::kCavity, placed);
  EXPECT_NEAR(found.convergence_deg->value, 6.0, 0.05);
  EXPECT_NEAR(found.depth_mm->value, 1.5, 0.005);
  EXPECT_NEAR(found.isthmus_mm->value, 2.0 + 1.5 * tan_deg(3.0), 0.03);
  EXPECT_LT(found.roughness_um->value, 2.0);
  EXPECT_EQ(found.undercut_mm2.value, 0.0);
  EXPECT_NEAR(found.wall_left_mm->value, 2.5 - 0.75 * tan_deg(3.0), 0.04);
  // Places are in the meshes' own space: the floor's.
  const Eigen::Vector3d at = placed.inverse() * found.depth_mm->at_m;
  EXPECT_NEAR(at.z(), 1.5e-3, 1e-5);
  const auto stump = shape(block(), crown(0.8, 6.0), AssessedKind::kCrown, placed);
  EXPECT_NEAR(stump.convergence_deg->value, 12.0, 0.05);
  EXPECT_NEAR(stump.margin_mm->value, 0.8, 0.03);
  EXPECT_NEAR(stump.margin_slope_deg->value, 0.0, 0.1);
  const auto bevelled = shape(block(), crown(0.8, 6.0, 20.0), AssessedKind::kCrown, placed);
  EXPECT_NEAR(bevelled.margin_slope_deg->value, 20.0, 0.2);
  EXPECT_NEAR(stump.depth_mm->value, 1.0, 0.005);
}

/// Steep faces further away than is looked at, beyond a valley.
TEST_F(ShapeOfMeshes, WallsAreNotThoseOfTeethFarAway) {
  const Profile jaw{{0, -6}, {9.8, -6}, {9.8, 2}, {9.7, 2}, {9.1, -4}, {9, -4}, {8.6, 2}, {0, 2}};
  Profile cut = jaw;
  cut.back() = {1.3, 2};
  cut.insert(cut.end(), {{1.2, 0.5}, {0, 0.5}});
  const auto found = shape(jaw, cut, AssessedKind::kCavity, Eigen::Affine3d::Identity());
  const double taper = std::atan(0.1 / 1.5) * 180.0 / std::numbers::pi;
  EXPECT_NEAR(found.convergence_deg->value, 2.0 * taper, 0.05);
  for (const auto& side : found.wall_deg) EXPECT_NEAR(side->value, taper, 0.05);
}

/// As scans do, that were laid over each other.
TEST_F(ShapeOfMeshes, AToothThatIsALittleOffHasNoUndercutAtItsRoot) {
  const Profile tooth{{0, -9}, {1.0, -9}, {3.5, -2}, {4.0, 1}, {3.0, 3}, {0, 3}};
  const Profile cut{{0, -9},  {1.0, -9}, {3.5, -2},  {4.0, 1},
                    {3.0, 3}, {1.2, 3},  {1.1, 1.5}, {0, 1.5}};
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  const Eigen::Affine3d off(Eigen::Translation3d(0.03e-3, -0.02e-3, 0.02e-3));
  const auto found =
      preparation_shape(test::turned_mesh(tooth, 200, here), test::turned_mesh(cut, 331, off), {});
  ASSERT_TRUE(found && found->depth_mm && found->convergence_deg);
  EXPECT_EQ(found->undercut_mm2.value, 0.0);
  EXPECT_NEAR(found->depth_mm->value, 1.5, 0.03);
  EXPECT_NEAR(found->convergence_deg->value, 2.0 * std::atan(0.1 / 1.5) * 180.0 / std::numbers::pi,
              0.1);
  EXPECT_NEAR(found->isthmus_mm->value, 2.3, 0.03);
}

/// Which rays far apart hit between those that can be seen.
TEST_F(ShapeOfMeshes, ARoughWallIsNoUndercutHoweverFarApartTheRaysAre) {
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  const TriangleMesh before = test::turned_mesh(block(), 200, here);
  const auto undercut_mm2 = [&](double overhang_mm, double pitch_mm) {
    const double wide = 1.2 + overhang_mm;
    const Profile ledge{{0, -3},  {3.5, -3}, {3.5, 3},  {1.2, 3},
                        {1.2, 2}, {wide, 2}, {wide, 1}, {0, 1}};
    return preparation_shape(before, test::turned_mesh(ledge, 331, here), {.pitch_mm = pitch_mm})
        .value()
        .undercut_mm2.value;
  };
  for (const double pitch_mm : {0.02, 0.08, 0.1, 0.2, 0.5}) {
    EXPECT_EQ(undercut_mm2(0.06, pitch_mm), 0.0) << pitch_mm;
  }
  const double area = std::numbers::pi * (1.7 * 1.7 - 1.2 * 1.2);
  for (const double pitch_mm : {0.02, 0.1, 0.2}) {
    EXPECT_NEAR(undercut_mm2(0.5, pitch_mm), area, 0.15 * area) << pitch_mm;
  }
}

TEST_F(ShapeOfMeshes, NothingIsRemovedWhereOnlyTheTrianglesDiffer) {
  const auto none =
      preparation_shape(test::turned_mesh(block(), 90, Eigen::Affine3d::Identity()),
                        test::turned_mesh(block(), 331, Eigen::Affine3d::Identity()), {});
  EXPECT_FALSE(none);
}

TEST_F(ShapeOfMeshes, WhatDoesNotOverlieIsTold) {
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  const Eigen::Affine3d there(Eigen::Translation3d(0.4e-3, 0, 0));
  const TriangleMesh before = test::turned_mesh(block(), 200, here);
  const auto outside = [&](const TriangleMesh& after) {
    return share_outside(before, after, {0, 0, 1});
  };
  EXPECT_LT(outside(test::turned_mesh(cavity(1, 1, 3), 331, here)).value(), 0.005);
  EXPECT_GT(outside(test::turned_mesh(cavity(1, 1, 3), 331, there)).value(), 0.03);
  EXPECT_FALSE(outside({})) << "nothing is left";
}

}  // namespace
}  // namespace sulcus::preparation_shape_test
