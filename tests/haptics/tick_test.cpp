#include "haptics/tick.hpp"

#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/allocation_count.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 50e-6;

/// Poses from a list, and the wrenches that came back.
class ListDevice final : public Device {
 public:
  explicit ListDevice(std::vector<Pose> list) : poses(std::move(list)) {
    applied.reserve(poses.size() + 10);
  }
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    return poses[std::min<std::size_t>(tick, poses.size() - 1)];
  }
  void apply(const Wrench& wrench) noexcept override { applied.push_back(wrench); }

  std::vector<Pose> poses;
  std::vector<Wrench> applied;
};

Scene make_scene(bool cutting) {
  Scene scene;
  scene.tissues = test::one_tissue();
  scene.tissues[0].specific_energy_J_per_m3 = 0.05e9;  // soft, so that voxels go within a few ticks
  if (cutting) scene.cutting.emplace();
  return scene;
}

const Burr& burr() {
  static const Burr round = make_burr(test::small_burr(), kVoxel);
  return round;
}

/// Down into a flat block and along it, aslant.
std::vector<Pose> path(int ticks) {
  std::vector<Pose> poses;
  const Vector3d axis = Vector3d(0.5, 0.2, 1).normalized();
  for (int i = 0; i < ticks; ++i) {
    const double down_m = std::min(i, 60) * 5e-6;
    poses.push_back(test::pose_along(Vector3d(-0.3e-3 + i * 2e-6, 0.1e-3, 0.1e-3 - down_m), axis));
  }
  return poses;
}

/// A scene in the middle of being run.
struct TickRun {
  explicit TickRun(bool cutting, const VoxelModel& start = test::block({64, 64, 64}, kVoxel,
                                                                       {0, 0, 0}, {64, 64, 32}))
      : scene(make_scene(cutting)),
        context{scene, burr()},
        state(initial_state(scene, {Workpiece(start)})),
        scratch(scene) {}
  const Workpiece& workpiece() const { return state.workpiece().solid; }
  RemovalState& removal() { return *state.workpiece().removal; }
  void replace(const VoxelModel& start) { state.bodies = make_bodies(scene, {Workpiece(start)}); }
  /// From the start again, after the scene was changed.
  void begin_again(const Pose& start = {}) {
    state = initial_state(scene, {workpiece()}, start);
    scratch = TickScratch(scene);
  }
  TickRecord step(Device& device) {
    const TickRecord record = tick(context, device, state, scratch);
    edits.insert(edits.end(), scratch.edits.begin(), scratch.edits.end());
    return record;
  }
  std::vector<TickRecord> steps(Device& device, int count) {
    std::vector<TickRecord> records;
    for (int i = 0; i < count; ++i) records.push_back(step(device));
    return records;
  }

  Scene scene;
  TickContext context;
  SimulationState state;
  TickScratch scratch;
  std::vector<Edit> edits;
};

bool same_bytes(const std::vector<TickRecord>& a, const std::vector<TickRecord>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

Vector3d vector(const double v[3]) { return {v[0], v[1], v[2]}; }

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
  const TickRecord record = tick(run.context, device, run.state, run.scratch);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GT(record.contacts, 50u);
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
    const TickRecord record = run.step(device);
    EXPECT_EQ(record.tick, i);
    EXPECT_DOUBLE_EQ(record.time_s, static_cast<double>(i) * 1e-3);
    EXPECT_EQ(run.state.tick, i + 1);
  }
}

TEST(Tick, TheToolFollowsTheDeviceAndTheDeviceGetsTheContactsWrench) {
  TickRun run(false);
  ListDevice device(path(150));
  const std::vector<TickRecord> records = run.steps(device, 150);
  ASSERT_EQ(device.applied.size(), 150u);
  for (std::size_t i = 0; i < 150; ++i) {
    const TickRecord& r = records[i];
    EXPECT_EQ(vector(r.device_position_m), device.poses[i].position);
    EXPECT_EQ(vector(r.tool_position_m), device.poses[i].position);
    EXPECT_EQ(r.tool_orientation[0], device.poses[i].orientation.w());
    EXPECT_EQ(r.tool_orientation[1], device.poses[i].orientation.x());
    EXPECT_EQ(r.tool_orientation[3], device.poses[i].orientation.z());
    EXPECT_EQ(vector(r.force_N), device.applied[i].force_N);
    EXPECT_EQ(vector(r.torque_Nm), device.applied[i].torque_Nm);
    EXPECT_EQ(vector(r.contact_force_N), device.applied[i].force_N);
  }
  EXPECT_EQ(records[0].contacts, 0u);
  EXPECT_EQ(vector(records[0].force_N), Vector3d(0, 0, 0));
  EXPECT_GT(records[149].contacts, 50u);
  EXPECT_GT(records[149].leaves, 0u);
  EXPECT_GE(records[149].tested, records[149].contacts);
  EXPECT_GT(records[149].force_N[2], 1.0);
}

TEST(Tick, WithoutCuttingNothingIsRemovedAndNoMemoryIsHeldForIt) {
  TickRun run(false);
  const std::uint64_t hash = run.workpiece().hash();
  ListDevice device(path(200));
  const std::vector<TickRecord> records = run.steps(device, 200);
  EXPECT_FALSE(run.state.workpiece().removal);
  EXPECT_EQ(run.scratch.edits.capacity(), 0u);
  EXPECT_TRUE(run.edits.empty());
  EXPECT_EQ(run.workpiece().hash(), hash);
  for (const TickRecord& r : records) EXPECT_EQ(r.removed, 0u);
}

TEST(Tick, WithoutCuttingThereIsNoTangentialForce) {
  TickRun run(false);
  std::vector<Pose> poses;
  for (int i = 0; i < 3; ++i) poses.push_back(test::upright({i * 50e-6, 0, -0.1e-3}));
  ListDevice device(poses);
  for (const TickRecord& r : run.steps(device, 3)) {
    EXPECT_EQ(r.force_N[0], 0.0);
    EXPECT_EQ(r.force_N[1], 0.0);
  }
}

TEST(Tick, CuttingRemovesWhatTheEditsSay) {
  TickRun run(true);
  const std::uint64_t solid = run.workpiece().solid_voxels();
  ListDevice device(path(300));
  std::uint64_t removed = 0;
  for (int i = 0; i < 300; ++i) {
    const TickRecord record = run.step(device);
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
  const TickRecord first = tick(context, device, run.state, run.scratch);
  EXPECT_EQ(first.force_N[0], 0.0) << "where it came from is not known";
  for (int i = 1; i < 3; ++i) {
    const TickRecord next = tick(context, device, run.state, run.scratch);
    EXPECT_NEAR(next.force_N[0], -0.3 * next.force_N[2], 3e-7 * next.force_N[2]);
    EXPECT_NEAR(next.force_N[1], 0.0, 1e-9);
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
    const TickRecord r = tick(context, device, run.state, run.scratch);
    // 50 rad/s on 0.65 mm: 33 mm/s, fast enough for all of beta.
    EXPECT_NEAR(r.force_N[0], 0.3 * r.force_N[2], 0.02 * r.force_N[2]) << i;
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
  const std::vector<TickRecord> records = run.steps(device, 40);
  EXPECT_EQ(records.front().contacts, 0u);
  for (const std::size_t i : {std::size_t{19}, std::size_t{39}}) {
    EXPECT_NEAR(records[i].force_N[2], 0.5, 0.01) << i;
    EXPECT_EQ(vector(records[i].device_position_m), poses[i].position);
    EXPECT_EQ(records[i].tool_position_m[0], poses[i].position.x());
    EXPECT_LT(records[i].tool_position_m[2], 0.0);
  }
  // 20 mm/s on the way.
  EXPECT_NEAR(records[0].tool_position_m[2], 80e-6, 1e-9);
  EXPECT_NEAR(records[1].tool_position_m[2], 60e-6, 1e-9);
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
    const TickRecord record = run.step(device);
    const CuttingRecord& cut = run.scratch.cutting;
    EXPECT_EQ(cut.tick, record.tick);
    EXPECT_EQ(cut.spindle_rad_per_s, before);
    EXPECT_GE(cut.work_J, work_J);
    EXPECT_EQ(vector(cut.tangential_force_N).norm() > 0.0, record.contacts > 0 && before > 0.0)
        << i;
    work_J = cut.work_J;
  }
  EXPECT_LT(*run.state.spindle_rad_per_s, 0.99 * free_rad_per_s);
  TickRun constant(true);
  ListDevice again(path(100));
  constant.steps(again, 100);
  EXPECT_EQ(constant.scratch.cutting.spindle_rad_per_s, free_rad_per_s);
  EXPECT_FALSE(constant.state.spindle_rad_per_s);
}

TEST(Tick, APoseThatIsNotFiniteGivesNoForceAFaultAndLeavesTheToolWhereItWas) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr int kBad = 50;  // on the way down, under force
  for (int kind = 0; kind < 4; ++kind) {
    TickRun run(true);
    std::vector<Pose> poses = path(kBad + 10);
    Pose& bad = poses[kBad];
    if (kind == 0) bad.position.y() = kNan;
    if (kind == 1) bad.position.x() = -kInf;
    if (kind == 2) bad.orientation.w() = kNan;
    if (kind == 3) bad.orientation.z() = kInf;
    ListDevice device(poses);
    const TickRecord last = run.steps(device, kBad).back();
    ASSERT_GT(last.force_N[2], 0.1);
    const std::uint64_t hash = run.workpiece().hash();
    const TickRecord r = run.step(device);
    EXPECT_EQ(r.faults, kFaultNotFinite);
    EXPECT_EQ(run.scratch.cutting.tick, r.tick) << "its row goes with the tick's";
    EXPECT_EQ(device.applied.back().force_N, Vector3d(0, 0, 0));
    EXPECT_EQ(device.applied.back().torque_Nm, Vector3d(0, 0, 0));
    EXPECT_EQ(vector(r.force_N), Vector3d(0, 0, 0));
    EXPECT_EQ(vector(r.contact_force_N), Vector3d(0, 0, 0));
    EXPECT_EQ(vector(r.tool_position_m), vector(last.tool_position_m));
    EXPECT_EQ(vector(r.device_position_m), vector(last.tool_position_m)) << "a record is finite";
    EXPECT_EQ(r.removed, 0u);
    EXPECT_EQ(r.contacts, 0u);
    EXPECT_EQ(run.workpiece().hash(), hash);
    EXPECT_EQ(r.tick, std::uint64_t{kBad});
    EXPECT_EQ(run.state.tick, std::uint64_t{kBad} + 1);
    EXPECT_EQ(run.step(device).faults, 0u) << "whether to go on is the caller's";
  }
}

TEST(Tick, AFirstPoseThatIsNotFiniteIsSurvived) {
  TickRun run(true);
  std::vector<Pose> poses = path(2);
  poses[0].position.x() = std::numeric_limits<double>::quiet_NaN();
  ListDevice device(poses);
  const TickRecord r = run.step(device);
  EXPECT_EQ(r.faults, kFaultNotFinite);
  EXPECT_TRUE(vector(r.tool_position_m).allFinite());
  EXPECT_FALSE(run.state.has_pose);
}

TEST(Tick, BodiesOutOfReachAreNotTouched) {
  TickRun run(true);
  const std::uint64_t hash = run.workpiece().hash();
  std::vector<Pose> poses = path(200);
  for (Pose& pose : poses) pose.position.z() += 1.8e-3;  // above the grid
  ListDevice device(poses);
  for (const TickRecord& r : run.steps(device, 200)) {
    EXPECT_EQ(r.leaves, 0u);
    EXPECT_EQ(vector(r.force_N), Vector3d(0, 0, 0));
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
    std::vector<TickRecord> records[2];
    std::uint64_t volume[2], state[2];
    for (int i : {0, 1}) {
      TickRun run(cutting);
      ListDevice device(path(300));
      records[i] = run.steps(device, 300);
      volume[i] = run.workpiece().hash();
      state[i] = run.state.hash();
    }
    EXPECT_TRUE(same_bytes(records[0], records[1]));
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
  const std::vector<TickRecord> records = run.steps(scripted, 250);
  ASSERT_GT(run.edits.size(), 100u);

  std::vector<std::optional<Pose>> poses;
  for (const TickRecord& r : records) {
    poses.push_back(pose_of(r.device_position_m, r.device_orientation));
  }
  PlaybackDevice playback(poses);
  TickRun again(true);
  EXPECT_TRUE(same_bytes(again.steps(playback, 250), records));
  EXPECT_EQ(again.workpiece().hash(), run.workpiece().hash());
  EXPECT_EQ(again.state.hash(), run.state.hash());
}

/// Behind a coupling, as stiff as tissues are there.
struct CoupledTickRun : TickRun {
  explicit CoupledTickRun(bool cutting) : TickRun(cutting) {
    scene.coupling.emplace();
    scene.tissues[0].stiffness_N_per_m *= 10.0;
  }
};

TEST(Tick, BehindACouplingTheToolStaysOutAndTheDeviceFeelsTheStretch) {
  CoupledTickRun run(false);
  std::vector<Pose> poses;
  for (int i = 0; i <= 1100; ++i) poses.push_back(test::upright({0, 0, 0.1e-3 - i * 1e-6}));
  ListDevice device(poses);
  const TickRecord last = run.steps(device, 1100).back();
  const double stretch_m = last.tool_position_m[2] - last.device_position_m[2];
  EXPECT_GT(last.tool_position_m[2], -1.5 * kVoxel);
  EXPECT_NEAR(last.force_N[2], run.scene.coupling->stiffness_N_per_m * stretch_m, 1e-9);
  EXPECT_NEAR(last.contact_force_N[2], last.force_N[2], 0.01 * last.force_N[2]);
  EXPECT_GE(run.scratch.port.evaluations, 1u);
}

TEST(Tick, ACouplingAllocatesNothingAndReplaysToTheSameBits) {
  CoupledTickRun run(true), again(true);
  // Fast enough that every budget is used.
  std::vector<Pose> poses;
  for (int i = 0; i < 200; ++i) poses.push_back(test::upright({i * 5e-6, 0, 0.4e-3 - i * 10e-6}));
  ListDevice a(poses), b(poses);
  std::vector<TickRecord> records;
  records.reserve(200);
  records.push_back(run.step(a));
  const std::uint64_t before = test::allocation_count();
  for (int i = 1; i < 200; ++i) {
    records.push_back(tick(run.context, a, run.state, run.scratch));
  }
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GT(run.removal().removed_J, 0.0);
  EXPECT_TRUE(same_bytes(again.steps(b, 200), records));
  EXPECT_EQ(again.state.hash(), run.state.hash());
}

TEST(Tick, ADeviceThatHasNeverAnsweredPutsTheToolNowhere) {
  TickRun run(false);
  const std::vector<std::optional<Pose>> poses{std::nullopt, test::upright({0, 0, 1e-3})};
  PlaybackDevice device(poses);
  const TickRecord silent = run.step(device);
  EXPECT_EQ(silent.faults, kFaultDeviceSilent);
  EXPECT_FALSE(run.state.has_pose);
  EXPECT_EQ(run.step(device).faults, 0u);
  EXPECT_EQ(run.state.tool.position.z(), 1e-3);
}

/// A pose, or none, for each tick; the last for ever.
class SilentDevice final : public Device {
 public:
  explicit SilentDevice(std::vector<std::optional<Pose>> list) : poses(std::move(list)) {}
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    return poses[std::min<std::size_t>(tick, poses.size() - 1)];
  }
  void apply(const Wrench& wrench) noexcept override { last = wrench; }

  std::vector<std::optional<Pose>> poses;
  Wrench last;
};

std::vector<std::optional<Pose>> with_none(std::vector<Pose> poses) {
  return {poses.begin(), poses.end()};
}

TEST(Tick, AJumpIsNoSlidingWithAndWithoutACoupling) {
  for (const bool coupled : {false, true}) {
    TickRun run(true);
    if (coupled) run.scene.coupling.emplace();
    // 5.5 mm aside at once, into the block where the burr has never been, the spindle standing.
    Burr still = burr();
    still.speed_rad_per_s = 0.0;
    const TickContext context{run.scene, still};
    run.replace(test::block({160, 64, 64}, kVoxel, {0, 0, 0}, {160, 64, 32}));
    SilentDevice device({test::upright({-2.5e-3, 0, 0.1e-3}), test::upright({3.0e-3, 0, -0.1e-3})});
    const auto step = [&] { return tick(context, device, run.state, run.scratch); };
    step();
    for (int i = 0; i < 2; ++i) {
      const TickRecord jumped = step();
      EXPECT_EQ((jumped.faults & kFaultDeviceJumped) != 0, i == 0);
      EXPECT_EQ(jumped.removed, 0u);
      EXPECT_EQ(run.removal().work_J, 0.0) << "nothing has slid";
      EXPECT_EQ(vector(run.scratch.cutting.tangential_force_N), Vector3d(0, 0, 0));
    }
    if (!coupled) {
      EXPECT_GT(run.scratch.bodies[0].contact.contacts.size(), 0u) << "it was in contact";
    }
  }
}

TEST(Tick, AStepOf4MmIntoTheBlockIsToldAndOneInAirIsNot) {
  TickRun run(false);
  run.replace(test::block({160, 64, 64}, kVoxel, {0, 0, 0}, {160, 64, 32}));
  SilentDevice device({test::upright({-2e-3, 0, 2e-3}), test::upright({2e-3, 0, 2e-3}),
                       test::upright({2e-3, 0, 0.01e-3}), test::upright({2e-3, 0, -0.2e-3}),
                       test::upright({1.8e-3, 0, -0.2e-3})});
  std::vector<std::uint64_t> told;
  for (int i = 0; i < 5; ++i) told.push_back(run.step(device).faults);
  const std::vector<std::uint64_t> expected{0, 0, 0, kFaultStepTooLong, 0};
  EXPECT_EQ(told, expected) << "4 voxels deeper at once; along the surface as far as it likes";
}

TEST(Tick, AWallOfOneVoxelIsNotCrossedInSilenceAtAnySpeed) {
  for (const double speed_m_per_s : {10e-3, 0.1, 1.0, 3.0}) {
    TickRun run(false);
    run.replace(test::block({64, 64, 64}, kVoxel, {0, 0, 32}, {64, 64, 33}));
    std::vector<Pose> poses;
    const double step_m = speed_m_per_s * 1e-3;
    for (double z = 1.5e-3; z > -2.5e-3; z -= step_m) poses.push_back(test::upright({0, 0, z}));
    ListDevice device(poses);
    std::uint64_t told = 0;
    for (const TickRecord& r : run.steps(device, static_cast<int>(poses.size()))) told |= r.faults;
    EXPECT_NE(told & (kFaultStepTooLong | kFaultToolInside), 0u) << speed_m_per_s;
  }
}

TEST(Tick, AToolPutIntoTheMiddleOfABlockIsToldThatItIsInside) {
  TickRun run(false);
  run.replace(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {64, 64, 48}));
  SilentDevice device({test::upright({0, 0, -0.4e-3})});
  EXPECT_EQ(run.step(device).faults, kFaultToolInside);
}

TEST(Tick, AFreeSlideFasterThanTheCouplingsStepsIsTold) {
  // 4 steps of half a voxel of 50 um: 100 mm/s.
  for (const double speed_m_per_s : {20e-3, 60e-3, 150e-3, 400e-3}) {
    TickRun run(false);
    run.scene.coupling.emplace();
    run.scene.tissues[0].stiffness_N_per_m *= 10.0;
    run.replace(test::block({320, 64, 64}, kVoxel, {0, 0, 0}, {320, 64, 32}));
    std::vector<Pose> poses;
    for (int i = 0; i < 200; ++i) poses.push_back(test::upright({-7e-3, 0, 0.05e-3 - i * 1e-6}));
    const double step_m = speed_m_per_s * 1e-3;
    for (double x = -7e-3; x < 6e-3; x += step_m) poses.push_back(test::upright({x, 0, -0.15e-3}));
    ListDevice device(poses);
    int told = 0;
    for (const TickRecord& r : run.steps(device, static_cast<int>(poses.size()))) {
      told += (r.faults & kFaultStepTooLong) != 0 ? 1 : 0;
    }
    EXPECT_EQ(told > 0, speed_m_per_s > 100e-3) << speed_m_per_s << ": " << told;
  }
}

TEST(Tick, ASilentDeviceGoesOnCuttingFor20MsAndNoLonger) {
  for (const bool coupled : {false, true}) {
    TickRun run(true);
    run.scene.spindle.emplace();
    if (coupled) {
      run.scene.coupling.emplace();
      run.scene.tissues[0].stiffness_N_per_m *= 10.0;
    }
    run.scene.tissues[0].specific_energy_J_per_m3 = 0.5e9;
    run.begin_again();
    std::vector<std::optional<Pose>> poses = with_none(path(61));
    poses.push_back(std::nullopt);
    SilentDevice device(poses);
    for (int i = 0; i < 61; ++i) run.step(device);
    std::uint32_t bridged = 0, after = 0;
    for (int i = 0; i < 20; ++i) bridged += run.step(device).removed;
    const Pose stood = run.state.tool;
    const double work_J = run.removal().work_J;
    for (int i = 0; i < 200; ++i) {
      const TickRecord silent = run.step(device);
      after += silent.removed;
      EXPECT_TRUE(silent.faults & kFaultDeviceSilent);
      EXPECT_EQ(vector(silent.tool_position_m), stood.position);
      EXPECT_EQ(run.scratch.cutting.spindle_rad_per_s, 0.0);
      EXPECT_EQ(run.scratch.cutting.tick, silent.tick);
      EXPECT_EQ(vector(run.scratch.cutting.tangential_force_N), Vector3d(0, 0, 0));
    }
    EXPECT_GT(bridged, 0u);
    EXPECT_EQ(after, 0u);
    EXPECT_EQ(run.removal().work_J, work_J);
    EXPECT_EQ(*run.state.spindle_rad_per_s, 0.0);

    // It comes back elsewhere: that way is none that it has slid, and then the spindle runs up.
    device.poses.back() = test::upright({-0.1e-3, 0.1e-3, -0.2e-3});
    const TickRecord back = run.step(device);
    EXPECT_EQ(back.removed, 0u);
    EXPECT_EQ(run.removal().work_J, work_J);
    for (int i = 0; i < 30; ++i) run.step(device);
    EXPECT_GT(*run.state.spindle_rad_per_s, 0.0);
    EXPECT_GT(run.removal().work_J, work_J);
  }
}

TEST(Tick, AForceThatIsNotFiniteCutsNothingAndLeavesTheBooksAsTheyWere) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  TickRun run(true);
  run.scene.spindle.emplace();
  run.begin_again();
  ListDevice device(path(200));
  run.steps(device, 100);
  ASSERT_GT(run.edits.size(), 0u);
  const std::uint64_t volume = run.workpiece().hash();
  const RemovalState before = run.removal();
  const double spindle = *run.state.spindle_rad_per_s;
  run.scene.tissues[0].stiffness_N_per_m = kInf;
  const TickRecord r = run.step(device);
  EXPECT_TRUE(r.faults & kFaultNotFinite);
  EXPECT_EQ(r.removed, 0u);
  EXPECT_EQ(run.workpiece().hash(), volume);
  EXPECT_EQ(run.removal().hash(), before.hash());
  EXPECT_EQ(*run.state.spindle_rad_per_s, spindle);
  EXPECT_EQ(vector(r.force_N), Vector3d(0, 0, 0));
  EXPECT_TRUE(vector(run.scratch.cutting.tangential_force_N).allFinite());
}

TEST(Tick, APowerThatIsNotFiniteCutsNothing) {
  // The forces are finite, and what they do is too much for a float.
  TickRun run(true);
  Burr fast = burr();
  fast.speed_rad_per_s = 1e30;
  const TickContext context{run.scene, burr()}, too_fast{run.scene, fast};
  ListDevice device(path(200));
  for (int i = 0; i < 100; ++i) tick(context, device, run.state, run.scratch);
  const std::uint64_t volume = run.workpiece().hash(), books = run.removal().hash();
  const TickRecord r = tick(too_fast, device, run.state, run.scratch);
  EXPECT_TRUE(r.faults & kFaultNotFinite);
  EXPECT_EQ(run.workpiece().hash(), volume);
  EXPECT_EQ(run.removal().hash(), books);
  EXPECT_EQ(vector(r.force_N), Vector3d(0, 0, 0));
}

TEST(Tick, BeforeTheFirstPoseTheToolIsWhereItIsToStart) {
  TickRun run(false);
  const Pose start = test::upright({1e-3, 2e-3, 3e-3});
  run.begin_again(start);
  SilentDevice device({std::nullopt});
  const TickRecord r = run.step(device);
  EXPECT_EQ(vector(r.tool_position_m), start.position);
  EXPECT_EQ(vector(r.device_position_m), start.position);
  EXPECT_EQ(r.tool_orientation[0], start.orientation.w());
  EXPECT_EQ(r.contacts, 0u);
}

TEST(Tick, WhetherItIsTimedChangesNoResult) {
  TickRun timed(true), plain(true);
  static std::uint64_t now = 0;
  timed.scratch = TickScratch(timed.scene, StageClock([]() noexcept { return now += 5; }));
  ListDevice a(path(200)), b(path(200));
  EXPECT_TRUE(same_bytes(timed.steps(a, 200), plain.steps(b, 200)));
  for (int stage = 0; stage < kStageCount; ++stage) {
    EXPECT_GT(timed.scratch.stage_ns(static_cast<Stage>(stage)), 0u) << kStageNames[stage];
  }
}

}  // namespace
}  // namespace sulcus
