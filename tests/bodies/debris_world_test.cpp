#include "engine/bodies/debris_world.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::debris_world_test {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 50e-6, kDt = 1e-3;
const Eigen::Vector3i kCells(64, 64, 64);  // 3.2 mm; the bottom at z = -1.6 mm

VoxelModel tooth(const Cell& from, const Cell& to) { return test::block(kCells, kVoxel, from, to); }
VoxelModel no_tooth() { return tooth({0, 0, 0}, {0, 0, 0}); }

/// The voxels of a box, `to` exclusive.
std::vector<std::uint32_t> box(const Cell& from, const Cell& to) {
  const VoxelModel model = tooth(from, to);
  std::vector<std::uint32_t> voxels;
  for (const Cell& c : test::solid_cells(model)) voxels.push_back(model.grid.linear(c));
  return voxels;
}

DebrisWorld world() { return DebrisWorld(no_tooth().grid, {}); }

void run(DebrisWorld& debris, int steps, const VoxelModel& solid) {
  for (int i = 0; i < steps; ++i) debris.step(kDt, solid);
}

double height(const DebrisWorld& debris, std::size_t piece = 0) {
  return debris.pose(piece).position.z();
}

TEST(DebrisWorld, APieceStartsWhereItsVoxelsAre) {
  DebrisWorld debris = world();
  debris.add(box({20, 20, 40}, {30, 28, 44}));
  EXPECT_TRUE(debris.pose(0).position.isZero(1e-12));
  EXPECT_TRUE(debris.pose(0).orientation.isApprox(Eigen::Quaterniond::Identity(), 1e-12));
}

TEST(DebrisWorld, ItFallsAsBodiesDo) {
  DebrisWorld debris = world();
  debris.add(box({28, 28, 54}, {36, 36, 62}));
  run(debris, 20, no_tooth());
  // Velocities are taken at the end of a step, a quarter of a tick long.
  EXPECT_NEAR(height(debris), -0.5 * 9.81 * 20e-3 * 20.25e-3, 1e-9);
  EXPECT_NEAR(debris.pose(0).position.head<2>().norm(), 0.0, 1e-9);
}

TEST(DebrisWorld, ItComesToRestOnTheFloorAndSleeps) {
  DebrisWorld debris = world();
  debris.add(box({28, 28, 30}, {36, 36, 38}));
  run(debris, 3000, no_tooth());
  EXPECT_NEAR(height(debris), -30 * kVoxel, 0.5 * kVoxel);
  EXPECT_TRUE(debris.at_rest(0));
  const Pose before = debris.pose(0);
  run(debris, 100, no_tooth());
  EXPECT_EQ(debris.pose(0).position, before.position);
}

TEST(DebrisWorld, TheFloorMayBeHigher) {
  LoosePiecesSettings settings;
  settings.floor_m = -0.5e-3;
  DebrisWorld debris(no_tooth().grid, settings);
  debris.add(box({28, 28, 40}, {36, 36, 48}));
  run(debris, 1000, no_tooth());
  EXPECT_NEAR(height(debris), -0.5e-3 - (40 - 32) * kVoxel, 0.5 * kVoxel);
}

TEST(DebrisWorld, ItComesToRestOnAnotherBodyWhichMayBeTurned) {
  // A plate of a quarter of the height, standing on its side, turned to lie well below the grid of
  // the tooth.
  const VoxelModel plate = tooth({24, 0, 0}, {40, 64, 64});
  const Pose place{{0.5e-3, 0, -5e-3}, rotation_xyz({0, 0.5 * M_PI, 0})};
  LoosePiecesSettings settings;
  settings.floor_m = -10e-3;
  DebrisWorld debris(no_tooth().grid, settings, {{&plate, place}});
  debris.add(box({28, 28, 40}, {36, 36, 48}));
  run(debris, 2000, no_tooth());
  EXPECT_TRUE(debris.at_rest(0));
  const double top_m = -5e-3 + 8 * kVoxel, bottom_of_piece_m = (40 - 32) * kVoxel;
  EXPECT_NEAR(height(debris), top_m - bottom_of_piece_m, 0.5 * kVoxel);
}

TEST(DebrisWorld, ItComesToRestOnTheToothAndFallsOnWhenThatIsCutAway) {
  const VoxelModel step = tooth({16, 16, 0}, {48, 48, 20});
  DebrisWorld debris = world();
  debris.add(box({28, 28, 30}, {36, 36, 38}));
  run(debris, 3000, step);
  EXPECT_NEAR(height(debris), -10 * kVoxel, 0.5 * kVoxel);
  ASSERT_TRUE(debris.at_rest(0));
  debris.wake(Eigen::AlignedBox3d(Vector3d(0, 0, -12.1 * kVoxel), Vector3d(0, 0, -12 * kVoxel)),
              kVoxel);
  run(debris, 3000, no_tooth());
  EXPECT_NEAR(height(debris), -30 * kVoxel, 0.5 * kVoxel);
}

TEST(DebrisWorld, PiecesLieOnEachOther) {
  DebrisWorld debris = world();
  debris.add(box({26, 26, 4}, {38, 38, 12}));
  debris.add(box({28, 28, 30}, {36, 36, 38}));
  run(debris, 3000, no_tooth());
  EXPECT_NEAR(height(debris, 0), -4 * kVoxel, 0.5 * kVoxel);
  EXPECT_NEAR(height(debris, 1), -(30 - 8) * kVoxel, kVoxel);
}

TEST(DebrisWorld, ARodThatStandsTooSlantTips) {
  // A staircase: its centre lies beyond its foot.
  std::vector<std::uint32_t> voxels;
  const VoxelGrid grid = no_tooth().grid;
  for (int k = 0; k < 24; ++k) {
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        voxels.push_back(grid.linear({20 + i + k / 2, 30 + j, k}));
      }
    }
  }
  DebrisWorld debris = world();
  debris.add(voxels);
  run(debris, 1500, no_tooth());
  const Vector3d up = debris.pose(0).direction(Vector3d(0.447, 0, 0.894));
  EXPECT_LT(std::abs(up.z()), 0.3) << "it lies";
  EXPECT_GT(up.x(), 0.9) << "to the side it leaned to";
}

TEST(DebrisWorld, TheSameCallsGiveTheSameBitsAndARestoredWorldGoesOnAsARebuiltOne) {
  const VoxelModel step = tooth({16, 16, 0}, {34, 48, 20});
  const auto make = [] {
    DebrisWorld debris = world();
    debris.add(box({28, 28, 40}, {36, 36, 46}));
    debris.add(box({30, 26, 50}, {38, 36, 54}));
    return debris;
  };
  DebrisWorld a = make(), b = make();
  // To just before the world is rebuilt.
  run(a, static_cast<int>(DebrisWorld::kRebuildEvery) - 1, step);
  run(b, static_cast<int>(DebrisWorld::kRebuildEvery) - 1, step);
  const DebrisWorld::State state = a.save();
  DebrisWorld c = world();
  c.restore(state);
  for (DebrisWorld* debris : {&a, &b, &c}) run(*debris, 200, step);
  for (std::size_t piece : {0u, 1u}) {
    EXPECT_GT(a.pose(piece).position.norm(), 2 * kVoxel);
    for (const DebrisWorld* other : {&b, &c}) {
      EXPECT_EQ(a.pose(piece).position, other->pose(piece).position);
      EXPECT_EQ(a.pose(piece).orientation.coeffs(), other->pose(piece).orientation.coeffs());
    }
  }
}

TEST(DebrisWorld, WhatMovesWhenTheWorldIsRebuiltGoesOn) {
  DebrisWorld debris = world();
  run(debris, static_cast<int>(DebrisWorld::kRebuildEvery) - 10, no_tooth());
  debris.add(box({28, 28, 54}, {36, 36, 62}));
  run(debris, 20, no_tooth());
  EXPECT_NEAR(height(debris), -0.5 * 9.81 * 20e-3 * 20.25e-3, 1e-9);

  // Turning as well: nothing of what was saved is lost.
  debris.add(box({30, 30, 20}, {50, 34, 24}));
  run(debris, 30, tooth({44, 28, 0}, {52, 36, 18}));
  const DebrisWorld::State saved = debris.save();
  ASSERT_GT(saved.pieces[1].turning_rad_per_s.norm(), 1.0);
  DebrisWorld other = world();
  other.restore(saved);
  const DebrisWorld::State again = other.save();
  EXPECT_EQ(again.steps, saved.steps);
  for (std::size_t i = 0; i < 2; ++i) {
    const DebrisWorld::PieceState &a = saved.pieces[i], &b = again.pieces[i];
    EXPECT_EQ(a.voxels, b.voxels);
    EXPECT_EQ(a.position_mm, b.position_mm);
    EXPECT_EQ(a.axes, b.axes);
    EXPECT_EQ(a.velocity_mm_per_s, b.velocity_mm_per_s);
    EXPECT_EQ(a.turning_rad_per_s, b.turning_rad_per_s);
    EXPECT_EQ(a.slow_s, b.slow_s);
    EXPECT_EQ(a.activation, b.activation);
  }
}

}  // namespace
}  // namespace sulcus::debris_world_test
