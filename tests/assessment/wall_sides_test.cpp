// Walls that lean by another angle on each side of the tooth: which is which, and by how much.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/assessment/preparation_shape.hpp"
#include "tests/assessment/lofted_solid.hpp"

namespace sulcus::wall_sides_test {
namespace {

using test::lofted_mesh;
using test::raised;
using test::Rectangle;
using test::Tapers;

const Rectangle kBottom{-3.6, 3.6, -3.1, 3.1, -3.0};

std::vector<Rectangle> block() { return {kBottom, raised(kBottom, 6.0, {})}; }

/// 1.8 mm deep; 2.8 x 2 mm at its floor.
std::vector<Rectangle> cavity(const Tapers& tapers) {
  const Rectangle floor{-1.5, 1.3, -1.1, 0.9, 1.2};
  return {kBottom, raised(kBottom, 6.0, {}), raised(floor, 1.8, tapers), floor};
}

/// A stump of 3 mm on a shoulder.
std::vector<Rectangle> crown(const Tapers& tapers) {
  const Rectangle foot{-2.6, 2.6, -2.2, 2.2, -1.0};
  const Tapers in{-tapers.mesial, -tapers.distal, -tapers.buccal, -tapers.lingual};
  return {kBottom, raised(kBottom, 2.0, {}), foot, raised(foot, 3.0, in)};
}

Eigen::Affine3d turned(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::Affine3d(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis.normalized()));
}

void expect_tapers(const PreparationShape& found, const Tapers& tapers, double within_deg) {
  const std::array<double, 4> expected{tapers.mesial, tapers.distal, tapers.buccal, tapers.lingual};
  for (std::size_t side = 0; side < 4; ++side) {
    SCOPED_TRACE("side " + std::to_string(side));
    ASSERT_TRUE(found.wall_deg[side]);
    EXPECT_NEAR(found.wall_deg[side]->value, expected[side], within_deg);
  }
}

constexpr Tapers kTapers{3.0, 8.0, -3.0, 5.0};

TEST(WallSides, OfACavityHaveEachItsTaperAndLieOnTheirSide) {
  for (const auto& [coarse, fine] : {std::array{1, 9}, std::array{9, 1}, std::array{40, 23}}) {
    const Eigen::Affine3d here = Eigen::Affine3d::Identity();
    const auto found = preparation_shape(lofted_mesh(block(), coarse, here),
                                         lofted_mesh(cavity(kTapers), fine, here), {});
    ASSERT_TRUE(found);
    expect_tapers(*found, kTapers, 0.05);
    EXPECT_NEAR(found->convergence_deg->value, 6.5, 2.0) << "between 11 and 2";
    const std::array<Eigen::Vector3d, 4> out{Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0),
                                             Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 1, 0)};
    const std::array<double, 4> at_mm{1.3, 1.5, 1.1, 0.9};  // at the floor
    for (std::size_t side = 0; side < 4; ++side) {
      EXPECT_NEAR(1e3 * found->wall_deg[side]->at_m.dot(out[side]), at_mm[side], 0.26) << side;
    }
  }
}

TEST(WallSides, OfACrownLikewise) {
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  const Tapers tapers{3.0, 10.0, 6.0, -2.0};
  const auto found =
      preparation_shape(lofted_mesh(block(), 5, here), lofted_mesh(crown(tapers), 8, here),
                        {.kind = AssessedKind::kCrown});
  ASSERT_TRUE(found);
  expect_tapers(*found, tapers, 0.05);
  EXPECT_GT(found->wall_deg[0]->at_m.x(), 2e-3);
  EXPECT_LT(found->wall_deg[2]->at_m.y(), -1.5e-3);
}

TEST(WallSides, AreTheSameWhereverTheToothStands) {
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(0.3, -1, 0.2), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 2, 3)}) {
    Eigen::Affine3d placed = turned(110.0, axis);
    placed.pretranslate(Eigen::Vector3d(0.01, -0.03, 0.02));
    const auto found =
        preparation_shape(lofted_mesh(block(), 3, placed), lofted_mesh(cavity(kTapers), 11, placed),
                          {.insertion = placed.linear().col(2),
                           .mesial = placed.linear().col(0),
                           .buccal = -placed.linear().col(1)});
    ASSERT_TRUE(found);
    expect_tapers(*found, kTapers, 0.05);
  }
}

TEST(WallSides, AreToldOfAToothThatIsTurnedALittle) {
  for (const Eigen::Affine3d& placed : {turned(25, {0, 0, 1}), turned(20, {1, -1, 0.3})}) {
    const auto found =
        preparation_shape(lofted_mesh(block(), 3, placed), lofted_mesh(cavity(kTapers), 11, placed),
                          {.insertion = placed.linear().col(2)});
    ASSERT_TRUE(found);
    expect_tapers(*found, kTapers, 0.05);
  }
}

TEST(WallSides, OfTheOtherHalfOfTheMouthAreMirrored) {
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  const auto found = preparation_shape(lofted_mesh(block(), 3, here),
                                       lofted_mesh(cavity(kTapers), 4, here), {.buccal{0, 1, 0}});
  ASSERT_TRUE(found);
  expect_tapers(*found, {3.0, 8.0, 5.0, -3.0}, 0.05);
}

TEST(WallSides, ThatWereNotCutHaveNone) {
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  // A slot from end to end, as a block of which both ends are one with the cavity's.
  std::vector<Rectangle> slot = cavity({0.0, 0.0, 3.0, 6.0});
  for (std::size_t i = 2; i < 4; ++i) slot[i].distal = -3.6, slot[i].mesial = 3.6;
  const auto found =
      preparation_shape(lofted_mesh(block(), 3, here), lofted_mesh(slot, 10, here), {});
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->wall_deg[0]);
  EXPECT_FALSE(found->wall_deg[1]);
  ASSERT_TRUE(found->wall_deg[2] && found->wall_deg[3]);
  EXPECT_NEAR(found->wall_deg[2]->value, 3.0, 0.05);
  EXPECT_NEAR(found->wall_deg[3]->value, 6.0, 0.05);
}

/// Thinner than what was looked at behind a wall once: it was none, and the others were what is
/// left.
TEST(WallSides, OfAThinWallAreKnownAndWhatIsLeftOfIt) {
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  for (const double left_mm : {0.05, 0.1, 0.2, 0.28}) {
    const Rectangle floor{-1.5, 3.6 - left_mm, -1.1, 0.9, 1.2};
    const std::vector<Rectangle> thin{kBottom, raised(kBottom, 6.0, {}), raised(floor, 1.8, {}),
                                      floor};
    const auto found =
        preparation_shape(lofted_mesh(block(), 3, here), lofted_mesh(thin, 12, here), {});
    ASSERT_TRUE(found && found->wall_left_mm) << left_mm;
    EXPECT_NEAR(found->wall_left_mm->value, left_mm, 0.03);
    EXPECT_NEAR(1e3 * found->wall_left_mm->at_m.x(), 3.6 - left_mm, 0.03);
    expect_tapers(*found, {}, 0.05);
  }
}

/// Of a tooth as wide as none is.
TEST(WallSides, ThatAreThickerThanIsLookedAtAreAtLeastThatThick) {
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  const Rectangle wide{-9.0, 9.0, -9.0, 9.0, -3.0}, floor{-1.0, 1.0, -1.0, 1.0, 1.2};
  const std::vector<Rectangle> before{wide, raised(wide, 6.0, {})};
  const std::vector<Rectangle> cut{wide, before.back(), raised(floor, 1.8, {}), floor};
  const auto found =
      preparation_shape(lofted_mesh(before, 3, here), lofted_mesh(cut, 12, here), {});
  ASSERT_TRUE(found && found->wall_left_mm);
  EXPECT_GT(found->wall_left_mm->value, 5.9);
  EXPECT_LT(found->wall_left_mm->value, 8.0);
}

TEST(WallSides, AreNotKnownAlongThePathOfInsertion) {
  const Eigen::Affine3d placed = turned(75, {0, 1, 0});  // z to mesial
  const auto found =
      preparation_shape(lofted_mesh(block(), 3, placed), lofted_mesh(cavity(kTapers), 11, placed),
                        {.insertion = placed.linear().col(2)});
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->wall_deg[0] || found->wall_deg[1]);
  EXPECT_NEAR(found->wall_deg[2]->value, -3.0, 0.05);
}

}  // namespace
}  // namespace sulcus::wall_sides_test
