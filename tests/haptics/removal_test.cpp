#include "haptics/removal.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/fault.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus {
namespace {

constexpr double kVoxel = 50e-6, kDt = 1e-3;

/// A block to cut at by hand: contacts with the powers that a test says.
class Removal : public ::testing::Test {
 protected:
  static constexpr double kFloat = 3e-7;  // powers are in single precision

  Removal() : workpiece_(make_block()), scratch_(HapticsSettings{}), state_(CuttingSettings{}) {
    tissues_[1].specific_energy_J_per_m3 = 0.65e9;
    edits_.reserve(scratch_.capacity);
  }

  /// 16^3 solid voxels; those with x >= 8 are of tissue 1.
  static Workpiece make_block() {
    VoxelModel model = test::block({16, 16, 16}, kVoxel, {0, 0, 0}, {16, 16, 16});
    auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
    for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
      tissues->set_uniform(leaf, model.grid.leaf_origin(leaf).x() >= 8);
    }
    model.tissues = tissues;
    return Workpiece(std::move(model));
  }

  void touch(const Cell& c, double power_W) {
    Contact contact;
    contact.cell = c;
    contact.tissue = workpiece_.tissue(c);
    // What is just enough stays so in single precision.
    contact.power_W = power_W > 0 ? std::nextafter(static_cast<float>(power_W), 1e9f) : 0.0f;
    scratch_.contacts.push_back(contact);
  }
  /// One tick with the contacts touched since the last.
  std::uint32_t run() {
    edits_.clear();
    const std::uint32_t faults =
        removal(workpiece_, tissues_, kDt, tick_++, scratch_, state_, edits_);
    scratch_.contacts.clear();
    return faults;
  }
  double needed_J(int tissue) const {
    return tissues_[static_cast<std::size_t>(tissue)].specific_energy_J_per_m3 *
           workpiece_.grid().voxel_volume_m3();
  }
  double energy(const Cell& c) const { return state_.part_cut.energy(voxel_key(c)); }
  double energy_of_all_voxels() const {
    double sum_J = 0.0;
    for (std::uint32_t v = 0; v < workpiece_.grid().cell_count(); ++v) {
      sum_J += energy(workpiece_.grid().cell_of_linear(v));
    }
    return sum_J;
  }
  void expect_energy_conserved() const {
    EXPECT_NEAR(state_.removed_J + energy_of_all_voxels() + state_.pool_J, state_.work_J,
                1e-12 * state_.work_J);
  }

  std::vector<TissueSettings> tissues_{2};
  Workpiece workpiece_;
  ContactScratch scratch_;
  RemovalState state_;
  std::vector<Edit> edits_;
  std::uint64_t tick_ = 70;
};

TEST_F(Removal, AVoxelGoesWhenItHasItsSpecificEnergyTimesItsVolume) {
  const Cell c(3, 4, 15);
  const double power_W = needed_J(0) / kDt / 3.5;
  for (int i = 0; i < 3; ++i) {
    touch(c, power_W);
    EXPECT_EQ(run(), 0u);
    EXPECT_TRUE(workpiece_.solid(c));
    EXPECT_NEAR(energy(c), (i + 1) * needed_J(0) / 3.5, kFloat * needed_J(0));
  }
  touch(c, power_W);
  run();
  EXPECT_FALSE(workpiece_.solid(c));
  EXPECT_EQ(energy(c), 0.0);
  EXPECT_EQ(state_.part_cut.size(), 0u);
  EXPECT_DOUBLE_EQ(state_.removed_J, needed_J(0));
  expect_energy_conserved();
}

TEST_F(Removal, EachTissueNeedsItsOwnEnergy) {
  const Cell hard(3, 4, 15), soft(12, 4, 15);
  touch(hard, needed_J(1) / kDt);
  touch(soft, needed_J(1) / kDt);
  run();
  EXPECT_TRUE(workpiece_.solid(hard));
  EXPECT_FALSE(workpiece_.solid(soft));
  EXPECT_EQ(state_.removed_voxels[0], 0u);
  EXPECT_EQ(state_.removed_voxels[1], 1u);
}

TEST_F(Removal, EditsSayTickVoxelAndCause) {
  const Cell a(3, 4, 15), b(12, 4, 15);
  touch(a, 2 * needed_J(0) / kDt);
  touch(b, 2 * needed_J(1) / kDt);
  run();
  ASSERT_EQ(edits_.size(), 2u);
  EXPECT_EQ(edits_[0].voxel, workpiece_.grid().linear(a));
  EXPECT_EQ(edits_[1].voxel, workpiece_.grid().linear(b));
  for (const Edit& edit : edits_) {
    EXPECT_EQ(edit.tick, 70u);
    EXPECT_EQ(edit.body, 0u);
    EXPECT_EQ(edit.cause, EditCause::kCut);
  }
}

TEST_F(Removal, WhatAVoxelDoesNotNeedFlowsToTheOthersInContact) {
  const Cell felled(3, 4, 15), left(2, 4, 15), right(4, 4, 15);
  touch(felled, 1.5 * needed_J(0) / kDt);
  touch(left, 0.1 * needed_J(0) / kDt);
  touch(right, 0.2 * needed_J(0) / kDt);
  run();
  EXPECT_FALSE(workpiece_.solid(felled));
  EXPECT_NEAR(energy(left), 0.35 * needed_J(0), kFloat * needed_J(0));
  EXPECT_NEAR(energy(right), 0.45 * needed_J(0), kFloat * needed_J(0));
  EXPECT_EQ(state_.pool_J, 0.0);
  expect_energy_conserved();
}

TEST_F(Removal, ExcessFellsTheNextInTheSameTick) {
  const Cell first(3, 4, 15), second(4, 4, 15);
  touch(first, 1.95 * needed_J(0) / kDt);
  touch(second, 0.1 * needed_J(0) / kDt);
  run();
  EXPECT_FALSE(workpiece_.solid(first));
  EXPECT_FALSE(workpiece_.solid(second));
  EXPECT_EQ(edits_.size(), 2u);
  EXPECT_NEAR(state_.pool_J, 0.05 * needed_J(0), kFloat * needed_J(0));
  expect_energy_conserved();
}

TEST_F(Removal, ContactsThatDoNotRubGetNothing) {
  const Cell felled(3, 4, 15), pressed(4, 4, 15);
  touch(felled, 1.5 * needed_J(0) / kDt);
  touch(pressed, 0.0);
  run();
  EXPECT_EQ(energy(pressed), 0.0);
  EXPECT_NEAR(state_.pool_J, 0.5 * needed_J(0), kFloat * needed_J(0));
}

TEST_F(Removal, WhatNoneCanTakeWaitsForTheNextContact) {
  touch({3, 4, 15}, 2.5 * needed_J(0) / kDt);
  run();
  EXPECT_NEAR(state_.pool_J, 1.5 * needed_J(0), kFloat * needed_J(0));
  for (int i = 0; i < 5; ++i) run();  // the burr is lifted
  EXPECT_NEAR(state_.pool_J, 1.5 * needed_J(0), kFloat * needed_J(0));

  const Cell next(9, 9, 15);
  touch(next, 0.1 * needed_J(1) / kDt);
  run();
  EXPECT_FALSE(workpiece_.solid(next));
  expect_energy_conserved();
}

TEST_F(Removal, EnergyIsConservedOverManyTicks) {
  std::mt19937 random(3);
  std::uint64_t edits = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<Cell> surface = test::surface_cells(workpiece_);
    test::shuffle(surface, random);
    surface.resize(std::min<std::size_t>(surface.size(), random() % 30));
    for (const Cell& c : surface) {
      // Mostly part cuts, now and then a flood that fells several at once.
      const double share = static_cast<double>(random() % 1000) / 1000.0;
      touch(c, (random() % 8 == 0 ? 6.0 : 0.5) * share * needed_J(0) / kDt);
    }
    EXPECT_EQ(run(), 0u);
    edits += edits_.size();
    if (i % 20 == 0) expect_energy_conserved();
  }
  expect_energy_conserved();
  EXPECT_GT(edits, 500u);
  EXPECT_EQ(state_.removed_voxels[0] + state_.removed_voxels[1], edits);
  EXPECT_EQ(workpiece_.solid_voxels(), 4096 - edits);
  EXPECT_NEAR(state_.removed_J,
              static_cast<double>(state_.removed_voxels[0]) * needed_J(0) +
                  static_cast<double>(state_.removed_voxels[1]) * needed_J(1),
              1e-12 * state_.removed_J);
  EXPECT_NEAR(state_.stored_J(), energy_of_all_voxels() + state_.pool_J, 1e-12 * state_.work_J);
}

TEST_F(Removal, AFullStateKeepsTheEnergyInThePoolAndSaysSo) {
  state_ = RemovalState(CuttingSettings{1});
  touch({3, 4, 15}, 0.1 * needed_J(0) / kDt);
  touch({4, 4, 15}, 0.1 * needed_J(0) / kDt);
  EXPECT_EQ(run(), kFaultCutStateFull);
  EXPECT_EQ(state_.part_cut.size(), 1u);
  expect_energy_conserved();
  EXPECT_NEAR(state_.work_J, 0.2 * needed_J(0), kFloat * needed_J(0));
}

TEST_F(Removal, NothingTouchedNothingDone) {
  const std::uint64_t hash = workpiece_.hash();
  EXPECT_EQ(run(), 0u);
  EXPECT_EQ(workpiece_.hash(), hash);
  EXPECT_TRUE(edits_.empty());
  EXPECT_EQ(state_.work_J, 0.0);
}

TEST_F(Removal, WhatIsLooseLeavesWithTheEnergyItHadStored) {
  const Cell part_cut(3, 4, 15), other(4, 4, 15), gone(5, 4, 15);
  touch(part_cut, 0.4 * needed_J(0) / kDt);
  run();
  workpiece_.remove(gone);
  const std::uint64_t solid = workpiece_.solid_voxels();
  std::vector<std::uint32_t> voxels;
  for (const Cell& c : {part_cut, other, gone}) voxels.push_back(workpiece_.grid().linear(c));
  edits_.clear();
  remove_loose(workpiece_, voxels, 99, state_, edits_);
  ASSERT_EQ(edits_.size(), 2u) << "what is gone already does not go again";
  EXPECT_EQ(edits_[1].voxel, voxels[1]);
  for (const Edit& edit : edits_) {
    EXPECT_EQ(edit.tick, 99u);
    EXPECT_EQ(edit.cause, EditCause::kLoose);
  }
  EXPECT_EQ(workpiece_.solid_voxels(), solid - 2);
  EXPECT_EQ(state_.part_cut.size(), 0u);
  EXPECT_NEAR(state_.carried_J, 0.4 * needed_J(0), kFloat * needed_J(0));
  EXPECT_EQ(state_.removed_J, 0.0);
  EXPECT_NEAR(state_.stored_J(), state_.work_J, 1e-12 * state_.work_J);
}

}  // namespace
}  // namespace sulcus
