#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/fault.hpp"
#include "tests/haptics/tick_run.hpp"

// What may be wrong in a tick: poses and forces that are not finite, a device that is silent or
// jumps, and steps that are too long.

namespace sulcus::tick_faults_test {
namespace {

using Eigen::Vector3d;
using namespace test;

constexpr double kVoxel = kTickVoxel;

TEST(TickFaults, APoseThatIsNotFiniteGivesNoForceAFaultAndLeavesTheToolWhereItWas) {
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
    const TickResult last = run.steps(device, kBad).back();
    ASSERT_GT(last.sent.force_N.z(), 0.1);
    const std::uint64_t hash = run.workpiece().hash();
    const TickResult r = run.step(device);
    EXPECT_EQ(r.faults, kFaultNotFinite);
    EXPECT_EQ(device.applied.back().force_N, Vector3d(0, 0, 0));
    EXPECT_EQ(device.applied.back().torque_Nm, Vector3d(0, 0, 0));
    EXPECT_EQ(r.sent.force_N, Vector3d(0, 0, 0));
    EXPECT_EQ(r.contact.wrench.force_N, Vector3d(0, 0, 0));
    EXPECT_EQ(r.tool.position, last.tool.position);
    EXPECT_EQ(r.device.position, last.tool.position) << "a record is finite";
    EXPECT_EQ(r.removed, 0u);
    EXPECT_EQ(r.contact.contacts, 0u);
    EXPECT_EQ(run.workpiece().hash(), hash);
    EXPECT_EQ(r.tick, std::uint64_t{kBad});
    EXPECT_EQ(run.state.tick, std::uint64_t{kBad} + 1);
    EXPECT_EQ(run.step(device).faults, 0u) << "whether to go on is the caller's";
  }
}

TEST(TickFaults, AFirstPoseThatIsNotFiniteIsSurvived) {
  TickRun run(true);
  std::vector<Pose> poses = path(2);
  poses[0].position.x() = std::numeric_limits<double>::quiet_NaN();
  ListDevice device(poses);
  const TickResult r = run.step(device);
  EXPECT_EQ(r.faults, kFaultNotFinite);
  EXPECT_TRUE(r.tool.position.allFinite());
  EXPECT_FALSE(run.state.has_pose);
}

TEST(TickFaults, ADeviceThatHasNeverAnsweredPutsTheToolNowhere) {
  TickRun run(false);
  const std::vector<std::optional<Pose>> poses{std::nullopt, test::upright({0, 0, 1e-3})};
  PlaybackDevice device(poses);
  const TickResult silent = run.step(device);
  EXPECT_EQ(silent.faults, kFaultDeviceSilent);
  EXPECT_FALSE(run.state.has_pose);
  EXPECT_EQ(run.step(device).faults, 0u);
  EXPECT_EQ(run.state.tool.position.z(), 1e-3);
}

TEST(TickFaults, AJumpIsNoSlidingWithAndWithoutACoupling) {
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
      const TickResult jumped = step();
      EXPECT_EQ((jumped.faults & kFaultDeviceJumped) != 0, i == 0);
      EXPECT_EQ(jumped.removed, 0u);
      EXPECT_EQ(run.removal().work_J, 0.0) << "nothing has slid";
      EXPECT_EQ(jumped.contact.tangential.force_N, Vector3d(0, 0, 0));
    }
    if (!coupled) {
      EXPECT_GT(run.scratch.bodies[0].contact.contacts.size(), 0u) << "it was in contact";
    }
  }
}

TEST(TickFaults, AStepOf4MmIntoTheBlockIsToldAndOneInAirIsNot) {
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

TEST(TickFaults, AWallOfOneVoxelIsNotCrossedInSilenceAtAnySpeed) {
  for (const double speed_m_per_s : {10e-3, 0.1, 1.0, 3.0}) {
    TickRun run(false);
    run.replace(test::block({64, 64, 64}, kVoxel, {0, 0, 32}, {64, 64, 33}));
    std::vector<Pose> poses;
    const double step_m = speed_m_per_s * 1e-3;
    for (double z = 1.5e-3; z > -2.5e-3; z -= step_m) poses.push_back(test::upright({0, 0, z}));
    ListDevice device(poses);
    std::uint64_t told = 0;
    for (const TickResult& r : run.steps(device, static_cast<int>(poses.size()))) told |= r.faults;
    EXPECT_NE(told & (kFaultStepTooLong | kFaultToolInside), 0u) << speed_m_per_s;
  }
}

TEST(TickFaults, AToolPutIntoTheMiddleOfABlockIsToldThatItIsInside) {
  TickRun run(false);
  run.replace(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {64, 64, 48}));
  SilentDevice device({test::upright({0, 0, -0.4e-3})});
  EXPECT_EQ(run.step(device).faults, kFaultToolInside);
}

TEST(TickFaults, AFreeSlideFasterThanTheCouplingsStepsIsTold) {
  // 3 steps of half a radius of 0.7 mm, and one of half a voxel: 1.1 m/s.
  for (const double speed_m_per_s : {20e-3, 150e-3, 500e-3, 2.0}) {
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
    for (const TickResult& r : run.steps(device, static_cast<int>(poses.size()))) {
      told += (r.faults & kFaultStepTooLong) != 0 ? 1 : 0;
    }
    EXPECT_EQ(told > 0, speed_m_per_s > 1.0) << speed_m_per_s << ": " << told;
  }
}

/// A groove as deep as 4 voxels, cut through a block at a constant speed.
struct Groove {
  static constexpr double kRadius_m = 0.7e-3, kDepth_m = 0.2e-3;
  /// How steeply the burr goes into the solid at its rim, which is at the block's face.
  static double rim() { return std::sqrt(1.0 - std::pow(1.0 - kDepth_m / kRadius_m, 2)); }

  Groove(double speed_m_per_s, double rate_hz, bool cutting) {
    TickRun run(cutting, test::block({160, 64, 64}, kVoxel, {0, 0, 0}, {160, 64, 32}));
    run.scene.haptics.rate_hz = rate_hz;
    run.scene.haptics.normals = NormalMethod::kLdmFast;  // on the flat the same as ldm
    run.begin_again();
    Burr fast = burr();
    fast.speed_rad_per_s = 2e4;
    const TickContext context{run.scene, fast};
    std::vector<Pose> poses;
    const double step_m = speed_m_per_s / rate_hz;
    for (double x = -2.5e-3; x < 2.5e-3; x += step_m) {
      poses.push_back(test::upright({x, 0, -0.025e-3 - kDepth_m}));
    }
    ListDevice device(poses);
    ticks = poses.size();
    for (std::size_t i = 0; i < ticks; ++i) {
      const TickResult result = tick(context, device, run.state, run.scratch);
      told += (result.faults & kFaultStepTooLong) != 0 ? 1 : 0;
      removed += result.removed;
    }
  }
  std::size_t ticks = 0, told = 0;
  std::uint64_t removed = 0;
};

TEST(TickFaults, AStepAlongTheSurfaceByWhichCuttingSuffersIsTold) {
  for (const double step_voxels : {0.3, 0.7, 1.6, 4.0, 10.0}) {
    SCOPED_TRACE(step_voxels);
    const double speed_m_per_s = step_voxels * kVoxel * 1e3;
    const Groove cut(speed_m_per_s, 1000.0, true);
    const Groove fine(speed_m_per_s, 16000.0, true);
    ASSERT_GT(fine.removed, 4000u);
    EXPECT_EQ(fine.told, 0u);
    const double lost = 1.0 - static_cast<double>(cut.removed) / static_cast<double>(fine.removed);
    if (step_voxels * Groove::rim() < 1.0) {
      EXPECT_LT(lost, 0.02);
      EXPECT_EQ(cut.told, 0u);
    } else {
      EXPECT_GT(lost, 0.02);
      EXPECT_GE(cut.told, cut.ticks / 2);
    }
    EXPECT_EQ(Groove(speed_m_per_s, 1000.0, false).told, 0u) << "nothing is cut";
  }
}

TEST(TickFaults, ASilentDeviceGoesOnCuttingFor20MsAndNoLonger) {
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
      const TickResult silent = run.step(device);
      after += silent.removed;
      EXPECT_TRUE(silent.faults & kFaultDeviceSilent);
      EXPECT_EQ(silent.tool.position, stood.position);
      EXPECT_EQ(silent.spindle_rad_per_s, 0.0);
      EXPECT_EQ(silent.contact.tangential.force_N, Vector3d(0, 0, 0));
    }
    EXPECT_GT(bridged, 0u);
    EXPECT_EQ(after, 0u);
    EXPECT_EQ(run.removal().work_J, work_J);
    EXPECT_EQ(*run.state.spindle_rad_per_s, 0.0);

    // It comes back elsewhere: that way is none that it has slid, and then the spindle runs up.
    device.poses.back() = test::upright({-0.1e-3, 0.1e-3, -0.2e-3});
    const TickResult back = run.step(device);
    EXPECT_EQ(back.removed, 0u);
    EXPECT_EQ(run.removal().work_J, work_J);
    for (int i = 0; i < 30; ++i) run.step(device);
    EXPECT_GT(*run.state.spindle_rad_per_s, 0.0);
    EXPECT_GT(run.removal().work_J, work_J);
  }
}

TEST(TickFaults, AForceThatIsNotFiniteCutsNothingAndLeavesTheBooksAsTheyWere) {
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
  const TickResult r = run.step(device);
  EXPECT_TRUE(r.faults & kFaultNotFinite);
  EXPECT_EQ(r.removed, 0u);
  EXPECT_EQ(run.workpiece().hash(), volume);
  EXPECT_EQ(run.removal().hash(), before.hash());
  EXPECT_EQ(*run.state.spindle_rad_per_s, spindle);
  EXPECT_EQ(r.sent.force_N, Vector3d(0, 0, 0));
  EXPECT_TRUE(r.contact.tangential.force_N.allFinite());
}

TEST(TickFaults, APowerThatIsNotFiniteCutsNothing) {
  // The forces are finite, and what they do is too much for a float.
  TickRun run(true);
  Burr fast = burr();
  fast.speed_rad_per_s = 1e30;
  const TickContext context{run.scene, burr()}, too_fast{run.scene, fast};
  ListDevice device(path(200));
  for (int i = 0; i < 100; ++i) tick(context, device, run.state, run.scratch);
  const std::uint64_t volume = run.workpiece().hash(), books = run.removal().hash();
  const TickResult r = tick(too_fast, device, run.state, run.scratch);
  EXPECT_TRUE(r.faults & kFaultNotFinite);
  EXPECT_EQ(run.workpiece().hash(), volume);
  EXPECT_EQ(run.removal().hash(), books);
  EXPECT_EQ(r.sent.force_N, Vector3d(0, 0, 0));
}

TEST(TickFaults, BeforeTheFirstPoseTheToolIsWhereItIsToStart) {
  TickRun run(false);
  const Pose start = test::upright({1e-3, 2e-3, 3e-3});
  run.begin_again(start);
  SilentDevice device({std::nullopt});
  const TickResult r = run.step(device);
  EXPECT_EQ(r.tool.position, start.position);
  EXPECT_EQ(r.device.position, start.position);
  EXPECT_EQ(r.tool.orientation.w(), start.orientation.w());
  EXPECT_EQ(r.contact.contacts, 0u);
}

}  // namespace
}  // namespace sulcus::tick_faults_test
