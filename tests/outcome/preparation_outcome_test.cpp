#include "engine/outcome/preparation_outcome.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/core/units.hpp"
#include "engine/outcome/goal.hpp"
#include "engine/shapes/build_shape.hpp"
#include "tests/outcome/labelled_model.hpp"
#include "tests/support/filled_model.hpp"

namespace sulcus::preparation_outcome_test {
namespace {

constexpr double kVoxel = 1e-4;
constexpr std::uint8_t kDentine = 0, kPulp = 1;
const std::vector<TissueSettings> kTissues = test::tissues_named({"dentine", "pulp"});

/// A preparation of a tooth: its outcome, and the tooth afterwards.
struct Prepared {
  Prepared(const VoxelModel& start, const std::vector<Cell>& removed,
           const std::vector<TissueSettings>& tissues,
           const std::optional<GoalSettings>& goal = std::nullopt)
      : outcome(start, tissues,
                goal ? std::optional(target_voxels(Goal(*goal), start)) : std::nullopt),
        end(start) {
    for (const Cell& c : removed) {
      outcome.add(test::edit_of(start, c));
      end.set(c, false);
    }
  }
  PreparationOutcome outcome;
  VoxelModel end;
};

/// A full block of 3.2 mm with pulp below z = 8.
VoxelModel pulp_block() {
  return test::labelled(test::block({32, 32, 32}, kVoxel, {0, 0, 0}, {32, 32, 32}),
                        [](const Cell& c) { return c.z() < 8 ? kPulp : kDentine; });
}

TEST(PreparationOutcome, TheWallOverThePulpIsWhatStandsBetween) {
  const VoxelModel model = pulp_block();
  const auto wall_m = [&](const std::vector<Cell>& removed) {
    return Prepared(model, removed, kTissues).outcome.progress().wall_over_pulp_m();
  };
  EXPECT_FALSE(wall_m({})) << "nothing was removed";
  EXPECT_NEAR(*wall_m({{5, 5, 20}, {9, 9, 11}, {9, 9, 12}}), 3 * kVoxel, 1e-12);
  EXPECT_NEAR(*wall_m({{9, 9, 9}}), 1 * kVoxel, 1e-12);
  EXPECT_EQ(*wall_m({{9, 9, 8}}), 0.0) << "exposed";
  EXPECT_EQ(*wall_m({{9, 9, 3}}), 0.0) << "in the pulp";
  EXPECT_FALSE(Prepared(model, {{9, 9, 9}}, test::tissues_named({"enamel", "dentine"}))
                   .outcome.progress()
                   .wall_over_pulp_m())
      << "no pulp is named";
}

TEST(PreparationOutcome, TheWallOverThePulpIsThatOfAllPairs) {
  Scene scene;
  scene.workpiece.shape = ShapeKind::kMolar;
  scene.workpiece.voxel_m = 0.2e-3;
  scene.workpiece.cells = {64, 56, 104};
  scene.tissues = test::tissues_named({"enamel", "dentine", "pulp"});
  const VoxelModel molar = build_shape(scene);
  // A slanting bore into the crown, and a notch at the neck.
  const std::vector<Cell> solid = test::solid_cells(molar);
  std::vector<Cell> bore, notch, pulp;
  for (const Cell& c : solid) {
    const Eigen::Vector3d p = molar.grid.centre_world(c) / kMillimetre;
    const Eigen::Vector3d across = p - Eigen::Vector3d(0.3 + 0.4 * (p.z() - 4), -0.2, p.z());
    if (p.z() > 3.3 && across.norm() < 0.8) bore.push_back(c);
    if (p.y() < -3.4 && std::abs(p.z() - 1.0) < 0.5) notch.push_back(c);
    if (molar.tissue(c) == 2) pulp.push_back(c);
  }
  for (const auto& removed : {bore, notch}) {
    ASSERT_GT(removed.size(), 50u);
    int least = std::numeric_limits<int>::max();
    for (const Cell& a : removed) {
      for (const Cell& b : pulp) least = std::min(least, (a - b).squaredNorm());
    }
    ASSERT_GT(least, 1);
    const Prepared prepared(molar, removed, scene.tissues);
    EXPECT_NEAR(*prepared.outcome.progress().wall_over_pulp_m(),
                scene.workpiece.voxel_m * (std::sqrt(least) - 1.0), 1e-12);
  }
}

/// A goal of the whole voxels `lower` to `upper`, `upper` exclusive.
GoalSettings goal_of(const VoxelGrid& grid, const Cell& lower, const Cell& upper) {
  const Eigen::Vector3d size = (upper - lower).cast<double>();
  GoalSettings goal;
  goal.size_m = grid.voxel_m * size;
  goal.position_m =
      grid.world_from_index(lower.cast<double>() + 0.5 * size - Eigen::Vector3d::Constant(0.5));
  return goal;
}

std::vector<Cell> cells_of(const Cell& lower, const Cell& upper) {
  return test::solid_cells(test::block({32, 32, 32}, kVoxel, lower, upper));
}

TEST(PreparationOutcome, WithoutAGoalThereAreNoFiguresOfOne) {
  const VoxelModel model = pulp_block();
  const Prepared prepared(model, {{9, 9, 20}}, kTissues);
  EXPECT_FALSE(prepared.outcome.goal_figures(prepared.end));
}

TEST(PreparationOutcome, AGoalThatIsMetHasADiceOfOne) {
  const VoxelModel model = pulp_block();
  const Cell lower(8, 8, 20), upper(20, 24, 32);
  const Prepared prepared(model, cells_of(lower, upper), kTissues,
                          goal_of(model.grid, lower, upper));
  const GoalFigures figures = *prepared.outcome.goal_figures(prepared.end);
  EXPECT_EQ(figures.target_volume, 12.0 * 16 * 12);
  EXPECT_EQ(figures.dice, 1.0);
  EXPECT_EQ(figures.excess_volume + figures.missing_volume, 0.0);
  EXPECT_EQ(figures.excess.max_m, 0.0);
  EXPECT_EQ(figures.missing->max_m, 0.0);
}

TEST(PreparationOutcome, AFloorTooDeepOrTooHighReachesThatFar) {
  const VoxelModel model = pulp_block();
  const Cell lower(8, 8, 20), upper(20, 24, 32);
  const GoalSettings goal = goal_of(model.grid, lower, upper);
  const Prepared deep(model, cells_of({8, 8, 17}, upper), kTissues, goal);
  const GoalFigures too_deep = *deep.outcome.goal_figures(deep.end);
  EXPECT_EQ(too_deep.excess_volume, 12.0 * 16 * 3);
  EXPECT_EQ(too_deep.missing_volume, 0.0);
  EXPECT_NEAR(too_deep.excess.max_m, 3 * kVoxel, 1e-12);
  const auto cell_at = [&](const Reach& reach) -> Cell {
    return model.grid.index_from_world(reach.furthest_m.value()).array().round().cast<int>();
  };
  EXPECT_EQ(cell_at(too_deep.excess).z(), 17);
  EXPECT_FALSE(too_deep.missing->furthest_m);
  EXPECT_NEAR(too_deep.dice, 2.0 * 12 / (12 + 15), 1e-12);

  const Prepared high(model, cells_of({8, 8, 25}, upper), kTissues, goal);
  const GoalFigures too_high = *high.outcome.goal_figures(high.end);
  EXPECT_EQ(too_high.excess_volume, 0.0);
  EXPECT_EQ(too_high.missing_volume, 12.0 * 16 * 5);
  EXPECT_NEAR(too_high.missing->max_m, 5 * kVoxel, 1e-12);
  EXPECT_EQ(cell_at(*too_high.missing).z(), 24);
  EXPECT_NEAR(too_high.dice, 2.0 * 7 / (12 + 7), 1e-12);
}

TEST(PreparationOutcome, ATargetOfTheWholeToothHasNoWalls) {
  const VoxelModel model = pulp_block();
  const Prepared prepared(model, cells_of({0, 0, 16}, {32, 32, 32}), kTissues,
                          goal_of(model.grid, {0, 0, 0}, {32, 32, 32}));
  const GoalFigures figures = *prepared.outcome.goal_figures(prepared.end);
  EXPECT_EQ(figures.missing_volume, 32.0 * 32 * 16);
  EXPECT_FALSE(figures.missing);
}

/// Of each voxel of `from` to the nearest of `to`, over all pairs; rising.
std::vector<double> plain_distances_m(const std::vector<Cell>& from, const std::vector<Cell>& to) {
  std::vector<double> distances;
  for (const Cell& a : from) {
    int least = std::numeric_limits<int>::max();
    for (const Cell& b : to) least = std::min(least, (a - b).squaredNorm());
    distances.push_back(kVoxel * std::sqrt(least));
  }
  std::ranges::sort(distances);
  return distances;
}

/// The part of `distances` up to p95 is 95 % of them, and no less would do.
void expect_reach(const Reach& reach, const std::vector<double>& distances) {
  EXPECT_NEAR(reach.max_m, distances.back(), 1e-12);
  const auto up_to = [&](double limit) {
    const auto end = std::ranges::upper_bound(distances, limit);
    return static_cast<double>(end - distances.begin()) / static_cast<double>(distances.size());
  };
  EXPECT_GE(up_to(reach.p95_m + 1e-9), 0.95);
  EXPECT_LT(up_to(reach.p95_m - 1e-9), 0.95);
}

TEST(PreparationOutcome, ReachesAreThoseOfAllPairs) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const VoxelModel model = test::random_blobs({32, 32, 32}, seed, kVoxel);
    GoalSettings settings = goal_of(model.grid, {6, 4, 8}, {25, 22, 30});
    settings.rotation = Eigen::Vector3d(10, 20, 30) * kDegree;
    const Goal goal(settings);
    const Eigen::Vector3d centre(14.0 + seed, 17, 18);
    std::vector<Cell> removed, target, outside, excess, missing;
    for (const Cell& c : test::solid_cells(model)) {
      const bool wanted = goal.contains(model.grid.centre_world(c));
      const bool gone = (c.cast<double>() - centre).norm() < 12;
      (wanted ? target : outside).push_back(c);
      if (gone) removed.push_back(c);
      if (gone && !wanted) excess.push_back(c);
      if (!gone && wanted) missing.push_back(c);
    }
    ASSERT_GT(excess.size(), 20u);
    ASSERT_GT(missing.size(), 20u);
    const Prepared prepared(model, removed, test::tissues_named({"enamel"}), settings);
    const GoalFigures figures = *prepared.outcome.goal_figures(prepared.end);
    EXPECT_EQ(figures.target_volume, static_cast<double>(target.size()));
    EXPECT_EQ(figures.excess_volume, static_cast<double>(excess.size()));
    EXPECT_EQ(figures.missing_volume, static_cast<double>(missing.size()));
    const auto both = static_cast<double>(target.size() - missing.size());
    const auto sum = static_cast<double>(target.size() + removed.size());
    EXPECT_NEAR(figures.dice, 2.0 * both / sum, 1e-12);
    expect_reach(figures.excess, plain_distances_m(excess, target));
    ASSERT_TRUE(figures.missing);
    expect_reach(*figures.missing, plain_distances_m(missing, outside));
  }
}

TEST(PreparationOutcome, FractionsCountByWhatIsFilled) {
  // Cut down to lower levels, and some to nothing.
  const VoxelModel start = test::filled_anyhow(test::random_blobs({32, 32, 32}, 4, kVoxel), 5);
  const GoalSettings settings = goal_of(start.grid, {6, 4, 8}, {25, 22, 30});
  const Goal goal(settings);
  PreparationOutcome outcome(start, test::tissues_named({"enamel"}), target_voxels(goal, start));
  VoxelModel end = start;
  double target = 0.0, removed = 0.0, excess = 0.0, missing = 0.0;
  for (const Cell& c : test::solid_cells(start)) {
    const bool wanted = goal.contains(start.grid.centre_world(c));
    const FillLevel before = start.level(c);
    FillLevel after = before;
    if (c.z() >= 12) {
      Edit edit = test::edit_of(start, c);
      edit.level = after = c.x() % 3 == 0 ? 0 : static_cast<FillLevel>(before / 2);
      outcome.add(edit);
      end.fills->reserve(1);
      end.fills->set(end.grid.leaf_of(c), leaf_place(c), after,
                     start.leaves[start.grid.leaf_of(c)]);
      if (after == 0) end.set(c, false);
    }
    const double cut = (before - after) / 255.0;
    removed += cut;
    if (wanted) {
      target += before / 255.0;
      missing += after / 255.0;
    } else {
      excess += cut;
    }
  }
  ASSERT_GT(excess, 100.0);
  ASSERT_GT(missing, 100.0);
  const GoalFigures figures = *outcome.goal_figures(end);
  EXPECT_NEAR(figures.target_volume, target, 1e-6);
  EXPECT_NEAR(figures.excess_volume, excess, 1e-6);
  EXPECT_NEAR(figures.missing_volume, missing, 1e-6);
  EXPECT_NEAR(figures.dice, 2.0 * (target - missing) / (target + removed), 1e-9);
}

}  // namespace
}  // namespace sulcus::preparation_outcome_test
