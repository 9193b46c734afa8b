#include "haptics/tick.hpp"

#include <array>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/haptics/tick_run.hpp"
#include "tests/support/allocation_count.hpp"

namespace sulcus::tick_test {
namespace {

using Eigen::Vector3d;
using namespace test;

constexpr double kVoxel = kTickVoxel;

TEST(AllocationCount, CountsEveryWayOfTakingMemory) {
  const auto taken = [](const auto& take) {
    const std::uint64_t before = test::allocation_count();
    take();
    return test::allocation_count() - before;
  };
  // Known to no one else, a block may be optimised away.
  const auto keep = [](const void* block) { asm volatile("" : : "r"(block) : "memory"); };
  EXPECT_EQ(taken([] {}), 0u);
  EXPECT_EQ(taken([&] { keep(std::make_unique<int>(1).get()); }), 1u);
  EXPECT_EQ(taken([&] { keep(std::vector<int>(100).data()); }), 1u);
  EXPECT_EQ(taken([&] {
              void* block = std::malloc(10);
              keep(block);
              std::free(block);
            }),
            1u);
  EXPECT_EQ(taken([&] { keep(Eigen::VectorXd::Zero(100).eval().data()); }), 1u);
  struct alignas(64) Line {
    char bytes[64];
  };
  EXPECT_EQ(taken([&] { keep(std::vector<Line>(3).data()); }), 1u);
}

TEST(Tick, AllocatesNothing) {
  for (const bool cutting : {false, true}) {
    TickRun run(cutting);
    ListDevice device(path(200));
    run.step(device);  // tables are made once, on first use
    std::uint64_t removed = 0;
    const std::uint64_t before = test::allocation_count();
    for (int i = 1; i < 200; ++i) {
      removed += tick(run.context, device, run.state, run.scratch).removed;
    }
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_EQ(removed > 100, cutting) << removed;
  }
}

TEST(Tick, TheFirstTickAllocatesNothingEither) {
  TickRun run(true);
  ListDevice device(path(200));
  device.poses[0] = device.poses[150];
  const std::uint64_t before = test::allocation_count();
  const TickResult record = tick(run.context, device, run.state, run.scratch);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GT(record.contact.contacts, 50u);
}

TEST(Tick, NothingIsAllocatedForALoadASpindleOrLoosePiecesEither) {
  TickRun run(true);
  run.scene.trajectory.load_N = 0.5;
  run.scene.spindle.emplace();
  run.scene.loose_pieces.emplace();
  run.begin_again();
  // As if all of the block's far corner had come loose.
  std::vector<std::uint32_t> loose;
  for (const Cell& c : test::solid_cells(run.workpiece().model())) {
    if (loose.size() < TickScratch::kMaxLoose) loose.push_back(run.workpiece().grid().linear(c));
  }
  ListDevice device(path(60));
  run.step(device);
  const std::uint64_t before = test::allocation_count();
  for (int i = 1; i < 60; ++i) {
    tick(run.context, device, run.state, run.scratch,
         i == 40 ? std::span<const std::uint32_t>(loose) : std::span<const std::uint32_t>{});
    if (i == 40) {
      EXPECT_GE(run.scratch.edits.size(), loose.size());
    }
  }
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(Tick, NumbersRiseByOneFromNought) {
  TickRun run(true);
  ListDevice device(path(20));
  for (std::uint64_t i = 0; i < 20; ++i) {
    const TickResult record = run.step(device);
    EXPECT_EQ(record.tick, i);
    EXPECT_EQ(run.state.tick, i + 1);
  }
}

TEST(Tick, TheToolFollowsTheDeviceAndTheDeviceGetsTheContactsWrench) {
  TickRun run(false);
  ListDevice device(path(150));
  const std::vector<TickResult> records = run.steps(device, 150);
  ASSERT_EQ(device.applied.size(), 150u);
  for (std::size_t i = 0; i < 150; ++i) {
    const TickResult& r = records[i];
    EXPECT_EQ(r.device.position, device.poses[i].position);
    EXPECT_EQ(r.tool.position, device.poses[i].position);
    EXPECT_EQ(r.tool.orientation.w(), device.poses[i].orientation.w());
    EXPECT_EQ(r.tool.orientation.x(), device.poses[i].orientation.x());
    EXPECT_EQ(r.tool.orientation.z(), device.poses[i].orientation.z());
    EXPECT_EQ(r.sent.force_N, device.applied[i].force_N);
    EXPECT_EQ(r.sent.torque_Nm, device.applied[i].torque_Nm);
    EXPECT_EQ(r.contact.wrench.force_N, device.applied[i].force_N);
  }
  EXPECT_EQ(records[0].contact.contacts, 0u);
  EXPECT_EQ(records[0].sent.force_N, Vector3d(0, 0, 0));
  EXPECT_GT(records[149].contact.contacts, 50u);
  EXPECT_GT(records[149].contact.leaves, 0u);
  EXPECT_GE(records[149].contact.tested, records[149].contact.contacts);
  EXPECT_GT(records[149].sent.force_N.z(), 1.0);
}

TEST(Tick, WithoutCuttingNothingIsRemovedAndNoMemoryIsHeldForIt) {
  TickRun run(false);
  const std::uint64_t hash = run.workpiece().hash();
  ListDevice device(path(200));
  const std::vector<TickResult> records = run.steps(device, 200);
  EXPECT_FALSE(run.state.workpiece().removal);
  EXPECT_EQ(run.scratch.edits.capacity(), 0u);
  EXPECT_TRUE(run.edits.empty());
  EXPECT_EQ(run.workpiece().hash(), hash);
  for (const TickResult& r : records) EXPECT_EQ(r.removed, 0u);
}

TEST(Tick, WithoutCuttingThereIsNoTangentialForce) {
  TickRun run(false);
  std::vector<Pose> poses;
  for (int i = 0; i < 3; ++i) poses.push_back(test::upright({i * 50e-6, 0, -0.1e-3}));
  ListDevice device(poses);
  for (const TickResult& r : run.steps(device, 3)) {
    EXPECT_EQ(r.sent.force_N.x(), 0.0);
    EXPECT_EQ(r.sent.force_N.y(), 0.0);
  }
}

TEST(Tick, CuttingRemovesWhatTheEditsSay) {
  TickRun run(true);
  const std::uint64_t solid = run.workpiece().solid_voxels();
  ListDevice device(path(300));
  std::uint64_t removed = 0;
  for (int i = 0; i < 300; ++i) {
    const TickResult record = run.step(device);
    ASSERT_EQ(record.removed, run.scratch.edits.size());
    for (const Edit& edit : run.scratch.edits) {
      ASSERT_EQ(edit.tick, record.tick);
      ASSERT_FALSE(run.workpiece().solid(run.workpiece().grid().cell_of_linear(edit.voxel)));
    }
    removed += record.removed;
    ASSERT_EQ(record.faults, 0u);
  }
  EXPECT_GT(removed, 300u);
  EXPECT_EQ(run.workpiece().solid_voxels(), solid - removed);
  EXPECT_EQ(run.removal().removed_voxels[0], removed);

  // The shape follows from the edits.
  VoxelModel copy = test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {64, 64, 32});
  for (const Edit& edit : run.edits) copy.set(copy.grid.cell_of_linear(edit.voxel), false);
  EXPECT_EQ(Workpiece(std::move(copy)).hash(), run.workpiece().hash());
}

TEST(Tick, TheToolsMotionSinceTheLastTickDragsOnIt) {
  TickRun run(true);
  Burr still = burr();
  still.speed_rad_per_s = 0.0;
  run.scene.tissues[0].specific_energy_J_per_m3 = 1e15;  // nothing is cut
  const TickContext context{run.scene, still};
  std::vector<Pose> poses;
  for (int i = 0; i < 3; ++i) poses.push_back(test::upright({i * 20e-6, 0, -0.1e-3}));  // 20 mm/s
  ListDevice device(poses);
  const TickResult first = tick(context, device, run.state, run.scratch);
  EXPECT_EQ(first.sent.force_N.x(), 0.0) << "where it came from is not known";
  for (int i = 1; i < 3; ++i) {
    const TickResult next = tick(context, device, run.state, run.scratch);
    EXPECT_NEAR(next.sent.force_N.x(), -0.3 * next.sent.force_N.z(), 3e-7 * next.sent.force_N.z());
    EXPECT_NEAR(next.sent.force_N.y(), 0.0, 1e-9);
  }
}

TEST(Tick, TurningTheHandpieceDragsOnIt) {
  TickRun run(true);
  Burr still = burr();
  still.speed_rad_per_s = 0.0;
  run.scene.tissues[0].specific_energy_J_per_m3 = 1e15;
  const TickContext context{run.scene, still};
  // About the head's centre, so that only the turn moves the surface in contact: 0.05 rad a tick
  // about +y, 50 rad/s, sweep the lowest point towards -x.
  std::vector<Pose> poses;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.05 * i, Vector3d::UnitY()));
    Pose pose;
    pose.orientation = turn * orientation_along(Vector3d::UnitZ());
    if (i == 2) pose.orientation.coeffs() = -pose.orientation.coeffs();  // the same, said otherwise
    pose.position = Vector3d(0, 0, 0.6e-3) - pose.direction(Vector3d(0, 0.7e-3, 0));
    poses.push_back(pose);
  }
  ListDevice device(poses);
  tick(context, device, run.state, run.scratch);
  for (int i = 1; i < 3; ++i) {
    const TickResult r = tick(context, device, run.state, run.scratch);
    // 50 rad/s on 0.65 mm: 33 mm/s, fast enough for all of beta.
    EXPECT_NEAR(r.sent.force_N.x(), 0.3 * r.sent.force_N.z(), 0.02 * r.sent.force_N.z()) << i;
  }
}

TEST(Tick, UnderALoadTheToolGoesOnUntilTheContactHoldsIt) {
  Scene scene = make_scene(false);
  scene.trajectory.load_N = 0.5;
  TickRun run(false);
  run.scene.trajectory = scene.trajectory;
  run.begin_again();
  // Above the block, at rest; then aside, where the load is held again.
  std::vector<Pose> poses(20, test::upright({0, 0, 0.1e-3}));
  poses.resize(40, test::upright({0.1e-3, 0, 0.15e-3}));
  ListDevice device(poses);
  const std::vector<TickResult> records = run.steps(device, 40);
  EXPECT_EQ(records.front().contact.contacts, 0u);
  for (const std::size_t i : {std::size_t{19}, std::size_t{39}}) {
    EXPECT_NEAR(records[i].sent.force_N.z(), 0.5, 0.01) << i;
    EXPECT_EQ(records[i].device.position, poses[i].position);
    EXPECT_EQ(records[i].tool.position.x(), poses[i].position.x());
    EXPECT_LT(records[i].tool.position.z(), 0.0);
  }
  // 20 mm/s on the way.
  EXPECT_NEAR(records[0].tool.position.z(), 80e-6, 1e-9);
  EXPECT_NEAR(records[1].tool.position.z(), 60e-6, 1e-9);
}

TEST(Tick, WhatWasCutIsRecordedAndBrakesTheSpindle) {
  TickRun run(true);
  run.scene.spindle.emplace();
  run.begin_again();
  const double free_rad_per_s = burr().speed_rad_per_s;
  ListDevice device(path(100));
  double work_J = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double before = *run.state.spindle_rad_per_s;
    const TickResult record = run.step(device);
    EXPECT_EQ(record.spindle_rad_per_s, before);
    EXPECT_GE(run.state.work_J(), work_J);
    EXPECT_EQ(record.contact.tangential.force_N.norm() > 0.0,
              record.contact.contacts > 0 && before > 0.0)
        << i;
    work_J = run.state.work_J();
  }
  EXPECT_LT(*run.state.spindle_rad_per_s, 0.99 * free_rad_per_s);
  TickRun constant(true);
  ListDevice again(path(100));
  EXPECT_EQ(constant.steps(again, 100).back().spindle_rad_per_s, free_rad_per_s);
  EXPECT_FALSE(constant.state.spindle_rad_per_s);
}

/// Dentine over enamel, in voxels of 20 um, cut down through at 300,000 rpm behind a coupling.
class Sandwich : public ::testing::Test {
 protected:
  static constexpr double kFine = 20e-6, kDt = 1e-3;
  static constexpr int kSoftFrom = 32;  // of the voxels' z

  Sandwich() : run_(true, layers()), fast_(make_burr(small_burr(BurrShape::kRound, 1e-3), kFine)) {
    run_.scene.tissues = {TissueSettings{}, TissueSettings{}};
    run_.scene.tissues[0].specific_energy_J_per_m3 = 3.5e9;
    run_.scene.tissues[1].specific_energy_J_per_m3 = 0.65e9;
    run_.scene.coupling.emplace();
    for (TissueSettings& tissue : run_.scene.tissues) tissue.stiffness_N_per_m = 300e3;
    fast_.speed_rad_per_s = 300e3 * 2.0 * std::numbers::pi / 60.0;
  }
  static VoxelModel layers() {
    VoxelModel model = test::block({64, 64, 64}, kFine, {0, 0, 0}, {64, 64, 44});
    auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
    for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
      tissues->set_uniform(leaf, model.grid.leaf_origin(leaf).z() >= kSoftFrom);
    }
    model.tissues = tissues;
    return model;
  }
  void step(Device& device) {
    const TickContext context{run_.scene, fast_};
    tick(context, device, run_.state, run_.scratch);
    for (const Contact& contact : run_.scratch.bodies[0].contact.contacts) {
      work_J_[contact.tissue] += static_cast<double>(contact.power_W) * kDt;
    }
    for (const Edit& edit : run_.scratch.edits) {
      const Cell cell = run_.workpiece().grid().cell_of_linear(edit.voxel);
      const std::size_t tissue = cell.z() >= kSoftFrom;
      removed_J_[tissue] +=
          run_.scene.tissues[tissue].specific_energy_J_per_m3 * kFine * kFine * kFine;
    }
  }

  TickRun run_;
  Burr fast_;
  // By tissue, from the contacts' powers and from the edits.
  std::array<double, 2> work_J_{}, removed_J_{};
};

TEST_F(Sandwich, WhatIsWorkedOnSoftTissueCutsNoHardTissueBelowIt) {
  std::vector<Pose> poses;
  for (int i = 0; i <= 800; ++i) poses.push_back(test::upright({0, 0, 0.26e-3 - i * 1e-6}));
  ListDevice device(poses);
  for (int i = 0; i <= 800; ++i) {
    step(device);
    for (const std::size_t tissue : {0u, 1u}) {
      ASSERT_LE(removed_J_[tissue], work_J_[tissue] * (1 + 1e-9))
          << "tissue " << tissue << ", " << i;
    }
  }
  const RemovalState& state = run_.removal();
  std::array<double, 2> stored_J{};
  state.part_cut.for_each([&](std::uint32_t key, double energy_J) {
    stored_J[cell_of_key(key).z() >= kSoftFrom] += energy_J;
  });
  for (const std::size_t tissue : {0u, 1u}) {
    EXPECT_GT(removed_J_[tissue], 0.0) << tissue;
    EXPECT_GT(state.by_tissue[tissue].heat_J, 0.0) << tissue;
    EXPECT_NEAR(removed_J_[tissue] + stored_J[tissue] + state.by_tissue[tissue].heat_J,
                work_J_[tissue], 1e-6 * work_J_[tissue])
        << tissue;
  }
  EXPECT_NEAR(state.removed_J + state.stored_J() + state.heat_J, work_J_[0] + work_J_[1],
              1e-6 * state.work_J);
}

TEST(Tick, BodiesOutOfReachAreNotTouched) {
  TickRun run(true);
  const std::uint64_t hash = run.workpiece().hash();
  std::vector<Pose> poses = path(200);
  for (Pose& pose : poses) pose.position.z() += 1.8e-3;  // above the grid
  ListDevice device(poses);
  for (const TickResult& r : run.steps(device, 200)) {
    EXPECT_EQ(r.contact.leaves, 0u);
    EXPECT_EQ(r.sent.force_N, Vector3d(0, 0, 0));
  }
  EXPECT_EQ(run.workpiece().hash(), hash);
}

TEST(Tick, ParentsOfWhatIsCutAwayAreSwitchedOff) {
  // A burr wider than the pillar it cuts away.
  TickRun run(true);
  run.scene.tissues[0].specific_energy_J_per_m3 = 1e5;
  run.replace(test::block({64, 64, 64}, kVoxel, {28, 28, 16}, {36, 36, 48}));
  std::vector<Pose> poses;
  const Vector3d axis = Vector3d(0.5, 0, 1).normalized();
  for (int i = 0; i < 400; ++i)
    poses.push_back(test::pose_along({0.1e-3, 0, 0.9e-3 - i * 5e-6}, axis));
  ListDevice device(poses);
  run.steps(device, 400);
  ASSERT_EQ(run.workpiece().solid_voxels(), 0u);
  EXPECT_EQ(run.workpiece().octree().node(0).status, ChildStatus::kNone);
}

TEST(Tick, TheSameRunTwiceGivesTheSameBits) {
  for (const bool cutting : {false, true}) {
    std::vector<TickResult> records[2];
    std::uint64_t volume[2], state[2];
    for (int i : {0, 1}) {
      TickRun run(cutting);
      ListDevice device(path(300));
      records[i] = run.steps(device, 300);
      volume[i] = run.workpiece().hash();
      state[i] = run.state.hash();
    }
    EXPECT_TRUE(same(records[0], records[1]));
    EXPECT_EQ(volume[0], volume[1]);
    EXPECT_EQ(state[0], state[1]);
  }
}

TEST(Tick, ARunPlayedBackFromItsRecordsGivesTheSameBits) {
  TickRun run(true);
  TrajectorySettings settings;
  settings.points_m = {Vector3d(-0.4e-3, 0, 0.05e-3), Vector3d(-0.3e-3, 0, -0.15e-3),
                       Vector3d(0.4e-3, 0.1e-3, -0.15e-3)};
  settings.axis = Vector3d(0.3, 0.1, 1).normalized();
  settings.speed_m_per_s = 4e-3;
  const Trajectory trajectory = make_trajectory(settings);
  ScriptedDevice scripted(trajectory, run.scene.haptics.rate_hz);
  const std::vector<TickResult> records = run.steps(scripted, 250);
  ASSERT_GT(run.edits.size(), 100u);

  std::vector<std::optional<Pose>> poses;
  for (const TickResult& r : records) {
    poses.push_back(r.device);
  }
  PlaybackDevice playback(poses);
  TickRun again(true);
  EXPECT_TRUE(same(again.steps(playback, 250), records));
  EXPECT_EQ(again.workpiece().hash(), run.workpiece().hash());
  EXPECT_EQ(again.state.hash(), run.state.hash());
}

TEST(Tick, BehindACouplingTheToolStaysOutAndTheDeviceFeelsTheStretch) {
  CoupledTickRun run(false);
  std::vector<Pose> poses;
  for (int i = 0; i <= 1100; ++i) poses.push_back(test::upright({0, 0, 0.1e-3 - i * 1e-6}));
  ListDevice device(poses);
  const TickResult last = run.steps(device, 1100).back();
  const double stretch_m = last.tool.position.z() - last.device.position.z();
  EXPECT_GT(last.tool.position.z(), -1.5 * kVoxel);
  EXPECT_NEAR(last.sent.force_N.z(), run.scene.coupling->stiffness_N_per_m * stretch_m, 1e-9);
  EXPECT_NEAR(last.contact.wrench.force_N.z(), last.sent.force_N.z(), 0.01 * last.sent.force_N.z());
  EXPECT_GE(last.evaluations, 1u);
}

TEST(Tick, ACouplingAllocatesNothingAndReplaysToTheSameBits) {
  CoupledTickRun run(true), again(true);
  // Fast enough that every budget is used.
  std::vector<Pose> poses;
  for (int i = 0; i < 200; ++i) poses.push_back(test::upright({i * 5e-6, 0, 0.4e-3 - i * 10e-6}));
  ListDevice a(poses), b(poses);
  std::vector<TickResult> records;
  records.reserve(200);
  records.push_back(run.step(a));
  const std::uint64_t before = test::allocation_count();
  for (int i = 1; i < 200; ++i) {
    records.push_back(tick(run.context, a, run.state, run.scratch));
  }
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GT(run.removal().removed_J, 0.0);
  EXPECT_TRUE(same(again.steps(b, 200), records));
  EXPECT_EQ(again.state.hash(), run.state.hash());
}

TEST(Tick, WhetherItIsTimedChangesNoResult) {
  TickRun timed(true), plain(true);
  static std::uint64_t now = 0;
  timed.scratch = TickScratch(timed.scene, StageClock([]() noexcept { return now += 5; }));
  ListDevice a(path(200)), b(path(200));
  EXPECT_TRUE(same(timed.steps(a, 200), plain.steps(b, 200)));
  for (int stage = 0; stage < kStageCount; ++stage) {
    EXPECT_GT(timed.scratch.stage_ns(static_cast<Stage>(stage)), 0u) << kStageNames[stage];
  }
}

}  // namespace
}  // namespace sulcus::tick_test
