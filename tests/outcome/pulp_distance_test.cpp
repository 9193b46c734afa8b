#include "engine/outcome/pulp_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/units.hpp"
#include "engine/outcome/preparation_progress.hpp"
#include "engine/shapes/build_shape.hpp"
#include "tests/outcome/labelled_model.hpp"

namespace sulcus::pulp_distance_test {
namespace {

std::uint32_t least_over_all(const Cell& c, const std::vector<Cell>& pulp) {
  int least = std::numeric_limits<int>::max();
  for (const Cell& p : pulp) least = std::min(least, (c - p).squaredNorm());
  return static_cast<std::uint32_t>(least);
}

VoxelSet set_of(const VoxelGrid& grid, const std::vector<Cell>& cells) {
  VoxelSet set(grid);
  for (const Cell& c : cells) set.insert(c);
  return set;
}

/// Cells of a grid, each anew.
Cell random_cell(const VoxelGrid& grid, std::mt19937& random) {
  return grid.cell_of_linear(static_cast<std::uint32_t>(random() % grid.cell_count()));
}

TEST(PulpDistance, IsThatOfAllPairsWhateverThePulp) {
  std::mt19937 random(4);
  const VoxelGrid grid{{64, 40, 152}, 1e-4};
  for (const std::size_t count : {1u, 2u, 5u, 40u, 900u}) {
    std::vector<Cell> pulp;
    while (pulp.size() < count) pulp.push_back(random_cell(grid, random));
    for (int trial = 0; trial < 40; ++trial) {
      PulpDistance distance(set_of(grid, pulp));
      EXPECT_FALSE(distance.least_squared());
      std::uint32_t least = std::numeric_limits<std::uint32_t>::max();
      for (int n = 0; n < 5; ++n) {
        const Cell c = random_cell(grid, random);
        least = std::min(least, least_over_all(c, pulp));
        distance.remove(c);
        ASSERT_EQ(distance.least_squared(), least) << count << ": " << c.transpose();
      }
    }
  }
}

TEST(PulpDistance, HoldsAcrossTheLargestGrid) {
  const VoxelGrid grid{{1024, 1024, 1024}, 1e-5};
  PulpDistance far(set_of(grid, {{0, 0, 0}}));
  far.remove({1023, 1023, 1023});
  EXPECT_EQ(far.least_squared(), 3u * 1023 * 1023);
  PulpDistance two(set_of(grid, {{0, 0, 3}, {0, 0, 1020}}));
  two.remove({0, 0, 500});
  EXPECT_EQ(two.least_squared(), 497u * 497u);
  two.remove({0, 0, 700});
  EXPECT_EQ(two.least_squared(), 320u * 320u);
}

/// A bore into the molar's crown, voxel by voxel from above, at random within a layer.
TEST(PulpDistance, OfABoreIsThatOfAllPairsAtRandomTicks) {
  Scene scene;
  scene.workpiece.shape = ShapeKind::kMolar;
  scene.workpiece.voxel_m = 0.15e-3;
  scene.workpiece.cells = {96, 88, 160};
  scene.tissues = test::tissues_named({"enamel", "dentine", "pulp"});
  const VoxelModel molar = build_shape(scene);
  std::vector<Cell> bore, pulp;
  for (const Cell& c : test::solid_cells(molar)) {
    const Eigen::Vector3d p = molar.grid.centre_world(c) / kMillimetre;
    const Eigen::Vector3d across = p - Eigen::Vector3d(0.9 + 0.3 * (p.z() - 4), -0.2, p.z());
    if (p.z() > 2.6 && across.norm() < 0.9) bore.push_back(c);
    if (molar.tissue(c) == 2) pulp.push_back(c);
  }
  std::mt19937 random(9);
  std::ranges::shuffle(bore, random);
  std::ranges::stable_sort(bore, [](const Cell& a, const Cell& b) { return a.z() > b.z(); });
  ASSERT_GT(bore.size(), 1000u);
  PreparationProgress progress(molar, scene.tissues, 1.0e-3);
  std::uint32_t least = std::numeric_limits<std::uint32_t>::max();
  std::optional<std::uint64_t> near;
  int compared = 0;
  for (std::size_t n = 0; n < bore.size(); ++n) {
    progress.add(test::edit_of(molar, bore[n], n));
    least = std::min(least, least_over_all(bore[n], pulp));
    const double wall_m = molar.grid.voxel_m * std::max(0.0, std::sqrt(least) - 1.0);
    if (!near && wall_m < 1.0e-3) near = n;
    EXPECT_EQ(progress.pulp_near_tick(), near) << n;
    if (random() % bore.size() >= 200) continue;
    ASSERT_TRUE(progress.wall_over_pulp_m());
    EXPECT_NEAR(*progress.wall_over_pulp_m(), wall_m, 1e-12) << n;
    ++compared;
  }
  EXPECT_GE(compared, 100);
  EXPECT_TRUE(near);
  EXPECT_LT(progress.memory_bytes(), std::size_t{4} << 20);
}

TEST(PulpDistance, IsNotKeptOfATissueThatIsNotThere) {
  const VoxelModel block = test::block({16, 16, 16}, 1e-4, {0, 0, 0}, {16, 16, 16});
  PreparationProgress without(block, test::tissues_named({"dentine"}));
  PreparationProgress none_there(block, test::tissues_named({"dentine", "pulp"}), 1e-3);
  for (PreparationProgress* progress : {&without, &none_there}) {
    progress->add(test::edit_of(block, {3, 3, 15}));
    EXPECT_FALSE(progress->wall_over_pulp_m());
    EXPECT_FALSE(progress->pulp_near_tick());
  }
}

}  // namespace
}  // namespace sulcus::pulp_distance_test
