#include "haptics/cut_state.hpp"

#include <map>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::cut_state_test {
namespace {

TEST(CutState, KnowsNothingAtFirst) {
  const CutState state(10);
  EXPECT_EQ(state.energy(0), 0.0);
  EXPECT_EQ(state.size(), 0u);
  EXPECT_EQ(state.hash(), 0u);
}

TEST(CutState, AnswersAsAMapDoesUnderRandomChanges) {
  for (std::uint32_t capacity : {1u, 7u, 64u, 300u}) {
    CutState state(capacity);
    std::map<std::uint32_t, double> expected;
    std::mt19937 random(capacity);
    // Few distinct voxels, so that runs of the table collide, are erased from the middle, and wrap.
    for (int step = 0; step < 30000; ++step) {
      const std::uint32_t voxel = static_cast<std::uint32_t>(random() % (2 * capacity)) * 8;
      const double energy_J =
          random() % 3 == 0 ? 0.0 : static_cast<double>(random()) * 1e-12 + 1e-9;
      const bool fits = expected.contains(voxel) || expected.size() < capacity || energy_J == 0.0;
      ASSERT_EQ(state.set_energy(voxel, energy_J), fits);
      if (fits && energy_J == 0.0) expected.erase(voxel);
      if (fits && energy_J != 0.0) expected[voxel] = energy_J;
      ASSERT_EQ(state.size(), expected.size());
      if (step % 50 != 0) continue;
      for (std::uint32_t v = 0; v < 16 * capacity; ++v) {
        const auto found = expected.find(v);
        ASSERT_EQ(state.energy(v), found == expected.end() ? 0.0 : found->second) << v;
      }
      std::map<std::uint32_t, double> visited;
      state.for_each([&](std::uint32_t v, double stored_J) {
        ASSERT_TRUE(visited.emplace(v, stored_J).second);
      });
      ASSERT_EQ(visited, expected);
    }
    state.clear();
    EXPECT_EQ(state.size(), 0u);
    EXPECT_EQ(state.hash(), 0u);
    for (std::uint32_t v = 0; v < 16 * capacity; ++v) {
      ASSERT_EQ(state.energy(v), 0.0);
    }
  }
}

TEST(CutState, HoldsTheFirstAndTheLastVoxelOfTheLargestGrid) {
  CutState state(2);
  EXPECT_TRUE(state.set_energy(0, 1.0));
  EXPECT_TRUE(state.set_energy((1u << 30) - 1, 2.0));
  EXPECT_EQ(state.energy(0), 1.0);
  EXPECT_EQ(state.energy((1u << 30) - 1), 2.0);
}

TEST(CutState, FullItRefusesNewVoxelsOnly) {
  CutState state(3);
  for (std::uint32_t v = 0; v < 3; ++v) EXPECT_TRUE(state.set_energy(v, 1.0));
  const std::uint64_t hash = state.hash();
  EXPECT_FALSE(state.set_energy(3, 1.0));
  EXPECT_EQ(state.energy(3), 0.0);
  EXPECT_EQ(state.hash(), hash);
  EXPECT_TRUE(state.set_energy(1, 2.0));
  EXPECT_TRUE(state.set_energy(2, 0.0));
  EXPECT_TRUE(state.set_energy(3, 1.0));
}

TEST(CutState, HashDependsOnWhatIsStoredAndNotOnItsHistory) {
  std::mt19937 random(5);
  std::vector<std::pair<std::uint32_t, double>> entries;
  for (std::uint32_t i = 0; i < 200; ++i) {
    entries.push_back({i * 3, static_cast<double>(random()) * 1e-12 + 1e-9});
  }
  CutState one(256), other(1000);
  for (const auto& [voxel, energy_J] : entries) one.set_energy(voxel, energy_J);
  test::shuffle(entries, random);
  for (const auto& [voxel, energy_J] : entries) {
    other.set_energy(voxel + 1, 5.0);         // a stranger that comes and goes
    other.set_energy(voxel, energy_J * 2.0);  // and another value first
    other.set_energy(voxel + 1, 0.0);
    other.set_energy(voxel, energy_J);
  }
  EXPECT_EQ(one.hash(), other.hash());
  other.set_energy(entries[0].first, entries[0].second * 1.0000001);
  EXPECT_NE(one.hash(), other.hash());
  for (const auto& [voxel, energy_J] : entries) one.set_energy(voxel, 0.0);
  EXPECT_EQ(one.hash(), 0u);
}

TEST(CutState, HashTellsWhichVoxelHoldsWhat) {
  CutState one(4), other(4);
  one.set_energy(1, 0.5);
  one.set_energy(2, 0.7);
  other.set_energy(1, 0.7);
  other.set_energy(2, 0.5);
  EXPECT_NE(one.hash(), other.hash());
}

}  // namespace
}  // namespace sulcus::cut_state_test
