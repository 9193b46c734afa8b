#include "haptics/removal.hpp"

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/fault.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::removal_test {
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
    work_of_J_[contact.tissue] += static_cast<double>(contact.power_W) * kDt;
  }
  /// One tick with the contacts touched since the last.
  std::uint32_t run() {
    edits_.clear();
    const std::uint32_t faults =
        removal(workpiece_, tissues_, kDt, tick_++, scratch_, removing_, state_, edits_);
    scratch_.contacts.clear();
    for (const Edit& edit : edits_) {
      ++edits_of_[workpiece_.tissue(workpiece_.grid().cell_of_linear(edit.voxel))];
    }
    return faults;
  }
  double needed_J(std::size_t tissue) const {
    return tissues_[tissue].specific_energy_J_per_m3 * workpiece_.grid().voxel_volume_m3();
  }
  double energy(const Cell& c) const { return state_.part_cut.energy(voxel_key(c)); }
  double energy_of_all_voxels() const {
    double sum_J = 0.0;
    for (std::uint32_t v = 0; v < workpiece_.grid().cell_count(); ++v) {
      sum_J += energy(workpiece_.grid().cell_of_linear(v));
    }
    return sum_J;
  }
  /// In all and of each tissue, with what the test itself has counted of work and removed voxels.
  void expect_energy_conserved() const {
    EXPECT_NEAR(state_.removed_J + energy_of_all_voxels() + state_.heat_J, state_.work_J,
                1e-12 * state_.work_J);
    const std::array<double, 256> stored_J = state_.stored_by_tissue_J(workpiece_);
    for (const std::size_t tissue : {0u, 1u}) {
      const double removed_J = static_cast<double>(edits_of_[tissue]) * needed_J(tissue);
      EXPECT_NEAR(removed_J + stored_J[tissue] + state_.by_tissue[tissue].heat_J,
                  work_of_J_[tissue], 1e-12 * work_of_J_[tissue])
          << tissue;
      EXPECT_NEAR(state_.by_tissue[tissue].removed_J, removed_J, 1e-12 * removed_J);
      EXPECT_NEAR(state_.by_tissue[tissue].work_J, work_of_J_[tissue], 1e-12 * work_of_J_[tissue]);
    }
  }

  std::vector<TissueSettings> tissues_{2};
  std::vector<double> removing_;
  Workpiece workpiece_;
  ContactScratch scratch_;
  RemovalState state_;
  std::vector<Edit> edits_;
  std::uint64_t tick_ = 70;
  std::array<double, 2> work_of_J_{};  // by tissue, of what was touched
  std::array<std::uint64_t, 2> edits_of_{};
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

TEST_F(Removal, WhatAVoxelDoesNotNeedIsHeatOfItsTissueAndCutsNoOther) {
  const Cell felled(12, 4, 15), soft(13, 4, 15), hard(3, 4, 15);
  touch(felled, 1.5 * needed_J(1) / kDt);
  touch(soft, 0.1 * needed_J(1) / kDt);
  touch(hard, 0.2 * needed_J(0) / kDt);
  run();
  EXPECT_FALSE(workpiece_.solid(felled));
  EXPECT_NEAR(energy(soft), 0.1 * needed_J(1), kFloat * needed_J(1));
  EXPECT_NEAR(energy(hard), 0.2 * needed_J(0), kFloat * needed_J(0));
  EXPECT_NEAR(state_.heat_J, 0.5 * needed_J(1), kFloat * needed_J(1));
  EXPECT_EQ(state_.by_tissue[1].heat_J, state_.heat_J);
  EXPECT_EQ(state_.by_tissue[0].heat_J, 0.0);
  expect_energy_conserved();
}

TEST_F(Removal, WhatWasLostDoesNotCutTheNextContact) {
  touch({3, 4, 15}, 2.5 * needed_J(0) / kDt);
  run();
  EXPECT_NEAR(state_.heat_J, 1.5 * needed_J(0), kFloat * needed_J(0));
  for (int i = 0; i < 5; ++i) run();  // the burr is lifted
  const Cell next(9, 9, 15);
  touch(next, 0.1 * needed_J(1) / kDt);
  run();
  EXPECT_TRUE(workpiece_.solid(next));
  EXPECT_NEAR(energy(next), 0.1 * needed_J(1), kFloat * needed_J(1));
  EXPECT_NEAR(state_.heat_J, 1.5 * needed_J(0), kFloat * needed_J(0));
  expect_energy_conserved();
}

TEST_F(Removal, ContactsThatDoNotRubGetNothing) {
  const Cell felled(3, 4, 15), pressed(4, 4, 15);
  touch(felled, 1.5 * needed_J(0) / kDt);
  touch(pressed, 0.0);
  run();
  EXPECT_EQ(energy(pressed), 0.0);
  EXPECT_TRUE(workpiece_.solid(pressed));
}

TEST_F(Removal, EnergyIsConservedOverManyTicks) {
  std::mt19937 random(3);
  std::uint64_t edits = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<Cell> surface = test::surface_cells(workpiece_);
    test::shuffle(surface, random);
    surface.resize(std::min<std::size_t>(surface.size(), random() % 30));
    for (const Cell& c : surface) {
      // Mostly part cuts, now and then far more than a voxel needs.
      const double share = static_cast<double>(random() % 1000) / 1000.0;
      touch(c, (random() % 4 == 0 ? 6.0 : 0.5) * share * needed_J(0) / kDt);
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
  EXPECT_NEAR(state_.stored_J(), energy_of_all_voxels(), 1e-12 * state_.work_J);
}

TEST_F(Removal, WhatIsNoShareOfTheWorkIsHeatOfItsTissue) {
  removing_ = {0.25, 0.5};
  const Cell hard(3, 4, 15), soft(12, 4, 15);
  touch(hard, 2.0 * needed_J(0) / kDt);
  touch(soft, 2.0 * needed_J(1) / kDt);
  EXPECT_EQ(run(), 0u);
  EXPECT_TRUE(workpiece_.solid(hard));
  EXPECT_NEAR(energy(hard), 0.5 * needed_J(0), kFloat * needed_J(0));
  EXPECT_FALSE(workpiece_.solid(soft));
  EXPECT_NEAR(state_.by_tissue[0].heat_J, 1.5 * needed_J(0), 2 * kFloat * needed_J(0));
  EXPECT_NEAR(state_.by_tissue[1].heat_J, 1.0 * needed_J(1), 2 * kFloat * needed_J(1));
  expect_energy_conserved();
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    for (double& share : removing_) share = static_cast<double>(random() % 1000) / 1000.0;
    for (const Cell& c : test::surface_cells(workpiece_)) {
      if (random() % 8 == 0) touch(c, 3.0 * needed_J(0) / kDt);
    }
    run();
  }
  EXPECT_GT(state_.removed_voxels[0], 100u);
  expect_energy_conserved();
}

TEST_F(Removal, WhatAFullStateHasNoRoomForIsHeatAndItSaysSo) {
  state_ = RemovalState(CuttingSettings{1});
  touch({3, 4, 15}, 0.1 * needed_J(0) / kDt);
  touch({4, 4, 15}, 0.1 * needed_J(0) / kDt);
  EXPECT_EQ(run(), kFaultCutStateFull);
  EXPECT_EQ(state_.part_cut.size(), 1u);
  EXPECT_NEAR(state_.heat_J, 0.1 * needed_J(0), kFloat * needed_J(0));
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
  EXPECT_EQ(state_.by_tissue[0].carried_J, state_.carried_J);
  EXPECT_EQ(state_.removed_J, 0.0);
  EXPECT_NEAR(state_.stored_J(), state_.work_J, 1e-12 * state_.work_J);
  EXPECT_NEAR(state_.stored_by_tissue_J(workpiece_)[0], state_.work_J, 1e-12 * state_.work_J);
}

}  // namespace
}  // namespace sulcus::removal_test
