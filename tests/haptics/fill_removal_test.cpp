#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/fault.hpp"
#include "haptics/removal.hpp"
#include "tests/haptics/tick_run.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::fill_removal_test {
namespace {

constexpr double kVoxel = 50e-6, kDt = 1e-3;

/// Removal from a block with fractions: contacts with powers and depths that a test says.
class FillRemoval : public ::testing::Test {
 protected:
  FillRemoval()
      : workpiece_(make_block()),
        start_(workpiece_.model()),
        scratch_(HapticsSettings{}),
        state_(CuttingSettings{}) {
    tissues_[1].specific_energy_J_per_m3 = 0.65e9;
    edits_.reserve(4 * scratch_.capacity);
    workpiece_.reserve_fills(64);
  }

  /// 16^3 voxels, the upper layer half full; those with z < 8 are of tissue 1.
  static Workpiece make_block() {
    VoxelModel model = test::filled_model(
        {16, 16, 16}, kVoxel, [](const Cell& c) { return c.z() == 15 ? 128 : int{kFullLevel}; });
    auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
    for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
      tissues->set_uniform(leaf, model.grid.leaf_origin(leaf).z() < 8);
    }
    model.tissues = tissues;
    return Workpiece(std::move(model));
  }

  void touch(const Cell& c, double power_W, double depth_m,
             const Eigen::Vector3f& normal = Eigen::Vector3f::UnitZ()) {
    Contact contact;
    contact.cell = c;
    contact.tissue = workpiece_.tissue(c);
    contact.normal = normal;
    contact.depth_m = static_cast<float>(depth_m);
    contact.power_W = static_cast<float>(power_W);
    scratch_.contacts.push_back(contact);
    work_J_[contact.tissue] += static_cast<double>(contact.power_W) * kDt;
  }
  std::uint32_t run() {
    edits_.clear();
    const std::uint32_t faults =
        removal(workpiece_, tissues_, kDt, tick_++, scratch_, removing_, state_, edits_);
    scratch_.contacts.clear();
    return faults;
  }
  double level_J(std::size_t tissue) const {
    return tissues_[tissue].specific_energy_J_per_m3 * workpiece_.grid().voxel_volume_m3() / 255.0;
  }
  /// What the levels that are gone have taken, from the voxels themselves.
  double gone_J(std::size_t tissue) const {
    double sum = 0.0;
    for (std::uint32_t v = 0; v < start_.grid.cell_count(); ++v) {
      const Cell c = start_.grid.cell_of_linear(v);
      if (start_.tissue(c) == tissue) sum += start_.level(c) - workpiece_.level(c);
    }
    return sum * level_J(tissue);
  }
  void expect_balances() const {
    const auto stored = state_.stored_by_tissue_J(workpiece_);
    for (std::size_t t = 0; t < 2; ++t) {
      const TissueEnergy& energy = state_.by_tissue[t];
      EXPECT_NEAR(energy.work_J, work_J_[t], 1e-12 * work_J_[t]);
      EXPECT_NEAR(energy.removed_J, gone_J(t), 1e-9 * gone_J(t));
      EXPECT_NEAR(energy.removed_J + stored[t] + energy.heat_J, energy.work_J,
                  1e-9 * energy.work_J);
    }
  }

  Workpiece workpiece_;
  VoxelModel start_;
  ContactScratch scratch_;
  RemovalState state_;
  std::vector<TissueSettings> tissues_{test::one_tissue()[0], test::one_tissue()[0]};
  std::vector<double> removing_;
  std::vector<Edit> edits_;
  std::array<double, 2> work_J_{};
  std::uint64_t tick_ = 0;
};

TEST_F(FillRemoval, AVoxelSinksWithTheWorkDoneOnIt) {
  const double enough_J = 40.25 * level_J(0);
  touch({3, 3, 15}, enough_J / kDt, kVoxel);
  EXPECT_EQ(run(), 0u);
  EXPECT_EQ(workpiece_.level({3, 3, 15}), 128 - 40);
  ASSERT_EQ(edits_.size(), 1u);
  EXPECT_EQ(edits_[0].level, 88);
  EXPECT_FALSE(edits_[0].is_gone());
  EXPECT_NEAR(state_.stored_J(), 0.25 * level_J(0), 1e-3 * level_J(0));
  touch({3, 3, 15}, 0.76 * level_J(0) / kDt, kVoxel);  // with what waited it is a level
  run();
  EXPECT_EQ(workpiece_.level({3, 3, 15}), 87);
  expect_balances();
}

TEST_F(FillRemoval, WhatAVoxelDoesNotNeedSinksTheOneBeneath) {
  touch({3, 3, 15}, 200.5 * level_J(0) / kDt, 2 * kVoxel);
  run();
  EXPECT_FALSE(workpiece_.solid({3, 3, 15}));
  EXPECT_EQ(workpiece_.level({3, 3, 14}), 255 - 72);
  EXPECT_EQ(state_.removed_voxels[0], 1u);
  ASSERT_EQ(edits_.size(), 2u);
  EXPECT_TRUE(edits_[0].is_gone());
  EXPECT_EQ(edits_[1].level, 255 - 72);
  EXPECT_EQ(state_.heat_J, 0.0);
  expect_balances();
}

TEST_F(FillRemoval, OnAnEdgeHalfGoesAlongEachAxis) {
  // Along the upper edge at x = 15: 200 levels, of which the voxel has 128. Another at y = 0, where
  // the normal is nearest to both by rounding alone.
  touch({15, 5, 15}, 200.5 * level_J(0) / kDt, 2 * kVoxel,
        Eigen::Vector3f(1.0f, 0.0f, 1.0f).normalized());
  touch({5, 0, 15}, 200.5 * level_J(0) / kDt, 2 * kVoxel,
        Eigen::Vector3f(0.0f, -1.0f - 1e-6f, 1.0f).normalized());
  EXPECT_EQ(run(), 0u);
  EXPECT_EQ(workpiece_.level({15, 5, 14}), 255 - 36);
  EXPECT_EQ(workpiece_.level({14, 5, 15}), 128 - 36);
  EXPECT_EQ(workpiece_.level({5, 0, 14}), 255 - 36);
  EXPECT_EQ(workpiece_.level({5, 1, 15}), 128 - 36);
  EXPECT_EQ(state_.heat_J, 0.0);
  expect_balances();
}

TEST_F(FillRemoval, AColumnThatMeetsOneThatIsGoneGoesOnBeneathIt) {
  // Both are gone, and the column of the one that leans goes through the other's voxel.
  const Eigen::Vector3f aside = Eigen::Vector3f(1.0f, 0.0f, 0.3f).normalized();
  touch({15, 5, 15}, 150.5 * level_J(0) / kDt, 3 * kVoxel, aside);
  touch({14, 5, 15}, 130.5 * level_J(0) / kDt, 2 * kVoxel);
  EXPECT_EQ(run(), 0u);
  EXPECT_EQ(workpiece_.level({13, 5, 15}), 128 - 22);
  EXPECT_EQ(workpiece_.level({14, 5, 14}), 255 - 2);
  EXPECT_EQ(state_.heat_J, 0.0);
  expect_balances();
}

TEST_F(FillRemoval, TheOrderOfTheContactsDoesNotMatter) {
  struct Touch {
    Cell cell;
    double levels;
    Eigen::Vector3f normal;
  };
  const Eigen::Vector3f up = Eigen::Vector3f::UnitZ(), aside = Eigen::Vector3f::UnitX();
  const std::vector<Touch> touches{
      {{15, 5, 15}, 170.5, aside}, {{14, 5, 15}, 130.5, up}, {{13, 5, 15}, 60.5, up},
      {{15, 6, 15}, 90.5, aside},  {{14, 6, 15}, 128.5, up}, {{15, 5, 14}, 300.5, aside},
      {{14, 5, 14}, 20.5, up},     {{7, 7, 15}, 400.5, up},  {{7, 7, 14}, 700.5, up}};
  std::vector<std::size_t> order(touches.size());
  std::iota(order.begin(), order.end(), 0u);
  std::mt19937 random(5);
  VoxelModel first;
  for (int round = 0; round < 20; ++round) {
    workpiece_ = Workpiece(start_);
    workpiece_.reserve_fills(64);
    state_ = RemovalState(CuttingSettings{});
    work_J_ = {};
    for (const std::size_t i : order) {
      touch(touches[i].cell, touches[i].levels * level_J(0) / kDt, 3 * kVoxel, touches[i].normal);
    }
    EXPECT_EQ(run(), 0u);
    expect_balances();
    if (round == 0) first = workpiece_.model();
    for (std::uint32_t v = 0; v < start_.grid.cell_count(); ++v) {
      const Cell c = start_.grid.cell_of_linear(v);
      ASSERT_EQ(workpiece_.level(c), first.level(c)) << c.transpose() << " in round " << round;
    }
    std::shuffle(order.begin(), order.end(), random);
  }
}

TEST_F(FillRemoval, WhatIsNoShareOfTheWorkIsHeat) {
  removing_ = {0.25, 1.0};
  touch({3, 3, 15}, 160.0 * level_J(0) / kDt, kVoxel);
  run();
  EXPECT_EQ(128 - workpiece_.level({3, 3, 15}), 40);
  EXPECT_NEAR(state_.by_tissue[0].heat_J, 120.0 * level_J(0), 1e-3 * level_J(0));
  expect_balances();
}

TEST_F(FillRemoval, NoMoreGoesThanLiesInTheBurr) {
  touch({3, 3, 15}, 1e6 * level_J(0) / kDt, 0.31 * kVoxel);
  run();
  EXPECT_EQ(workpiece_.level({3, 3, 15}), 128 - std::lround(0.31 * 255));
  EXPECT_NEAR(state_.heat_J, (1e6 - static_cast<double>(std::lround(0.31 * 255))) * level_J(0),
              level_J(0));
  // A column along z stands for more of a surface that is tilted: it is deeper.
  touch({8, 8, 15}, 1e6 * level_J(0) / kDt, 0.31 * kVoxel, Eigen::Vector3f(0.6f, 0.0f, 0.8f));
  run();
  EXPECT_EQ(workpiece_.level({8, 8, 15}), 128 - std::lround(0.31 * 255 / 0.8));
  expect_balances();
}

TEST_F(FillRemoval, TheWorkOnATissuePaysForNoOther) {
  for (int n = 0; n < 8; ++n) touch({5, 5, 15 - n}, 400.0 * level_J(0) / kDt, 20 * kVoxel);
  run();
  EXPECT_FALSE(workpiece_.solid({5, 5, 8}));
  EXPECT_EQ(workpiece_.level({5, 5, 7}), kFullLevel);
  EXPECT_GT(state_.heat_J, 0.0);
  EXPECT_EQ(state_.by_tissue[1].work_J, 0.0);
  expect_balances();
}

TEST_F(FillRemoval, BalancesWhateverIsTouched) {
  std::mt19937 random(8);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int tick = 0; tick < 400; ++tick) {
    for (int n = 0; n < 20; ++n) {
      const Cell c(below(16), below(16), below(16));
      if (!workpiece_.solid(c)) continue;
      const Eigen::Vector3f normal =
          Eigen::Vector3f(float(below(21)) - 10.0f, float(below(21)) - 10.0f,
                          float(below(21)) - 9.5f)
              .normalized();
      touch(c, below(900) * level_J(0) / kDt, below(300) * 0.01 * kVoxel, normal);
    }
    run();
  }
  EXPECT_GT(state_.removed_voxels[0] + state_.removed_voxels[1], 500u);
  state_.part_cut.for_each([&](std::uint32_t key, double) {
    EXPECT_TRUE(workpiece_.solid(cell_of_key(key))) << "energy waits in a voxel that is gone";
  });
  expect_balances();
}

TEST_F(FillRemoval, WithoutRoomItIsHeatAndAFault) {
  workpiece_ = Workpiece([&] {
    VoxelModel model = test::block({16, 16, 16}, kVoxel, {0, 0, 0}, {16, 16, 16});
    model.fills.emplace(model.grid.leaf_count(), std::vector<LeafLevels>{});
    return model;
  }());
  touch({3, 3, 15}, 40.0 * level_J(0) / kDt, kVoxel);
  EXPECT_EQ(run(), kFaultCutStateFull);
  EXPECT_EQ(workpiece_.level({3, 3, 15}), kFullLevel);
  EXPECT_NEAR(state_.heat_J, 40.0 * level_J(0), 1e-5 * level_J(0) * 40);
}

/// A block with a surface between two layers, with fractions.
VoxelModel filled_block() {
  return test::filled_model({64, 64, 64}, test::kTickVoxel, [](const Cell& c) {
    return c.z() < 31 ? 255 : c.z() == 31 ? 140 : 0;
  });
}

TEST(FillTick, KeptNormalsAreThoseFoundAnew) {
  test::TickRun kept(true, filled_block()), anew(true, filled_block());
  for (test::TickRun* run : {&kept, &anew}) {
    run->scene.workpiece.surface = SurfaceKind::kFractions;
    run->scene.haptics.keep_normals = run == &kept;
    run->begin_again();
    run->replace(filled_block());
  }
  test::ListDevice first(test::path(300)), second(test::path(300));
  std::uint64_t removed = 0;
  for (int t = 0; t < 300; ++t) {
    const TickResult a = kept.step(first), b = anew.step(second);
    ASSERT_EQ(a.contact.wrench.force_N, b.contact.wrench.force_N) << t;
    removed += a.removed;
  }
  EXPECT_GT(removed, 100u);
  EXPECT_EQ(kept.workpiece().hash(), anew.workpiece().hash());
}

TEST(FillTick, EditsAreTheShape) {
  test::TickRun run(true, filled_block());
  run.scene.workpiece.surface = SurfaceKind::kFractions;
  run.begin_again();
  run.replace(filled_block());
  test::ListDevice device(test::path(300));
  run.steps(device, 300);
  VoxelModel copy = filled_block();
  copy.fills->reserve(copy.grid.leaf_count());
  for (const Edit& edit : run.edits) {
    copy.set_level(copy.grid.cell_of_linear(edit.voxel), edit.level);
  }
  EXPECT_EQ(Workpiece(std::move(copy)).hash(), run.workpiece().hash());
}

}  // namespace
}  // namespace sulcus::fill_removal_test
