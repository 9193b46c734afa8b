// The threads of a run with what they share: for ThreadSanitizer as much as for the result.
#include "app/session.hpp"

#include <exception>
#include <new>
#include <thread>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "app/simulation.hpp"
#include "engine/core/stop.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/shapes/build_shape.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/failing_memory.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus {
namespace {

// ThreadSanitizer does not see how oneTBB, which was built without it, hands work over: here oneTBB
// has the calling thread only. What is watched are the threads of a run.
const tbb::global_control kNoWorkers(tbb::global_control::max_allowed_parallelism, 1);

struct RecordedSession {
  explicit RecordedSession(const std::string& text, const std::string& folder, Pace pace,
                           std::uint64_t ticks = 400)
      : scene(parse_scene(text, "test.toml")),
        trajectory(make_trajectory(scene.trajectory)),
        simulation(scene, build_shape(scene), {}, make_burr(scene.burr, scene.workpiece.voxel_m)),
        device(trajectory, scene.haptics.rate_hz) {
    SessionOptions options;
    options.folder = folder;
    options.pace = pace;
    options.ticks = ticks;
    result = run_session(simulation, device, options);
  }
  Scene scene;
  Trajectory trajectory;
  Simulation simulation;
  ScriptedDevice device;
  SessionResult result;
};

TEST(SessionThreads, RecorderHasEveryTickAndEdit) {
  const ScratchFolder scratch;
  for (const Pace pace : {Pace::kFast, Pace::kReal}) {
    const RecordedSession run(test::kCutScene, scratch.path("out"), pace);
    EXPECT_EQ(run.result.statistics.ticks, 400u);
    const RecordingReader reader(scratch.path("out/recording.h5"));
    EXPECT_EQ(reader.tick_count(), 400u);
    EXPECT_EQ(reader.missing(), "");
    EXPECT_EQ(reader.edit_count(), run.result.statistics.removed);
    EXPECT_GT(reader.edit_count(), 0u);
    ASSERT_FALSE(reader.state_hashes().empty());
    EXPECT_EQ(reader.state_hashes().back().volume, run.simulation.workpiece().hash());
    EXPECT_EQ(reader.state_hashes().back().state, run.simulation.state().hash());
  }
}

TEST(SessionThreads, PiecesComeLooseBesideThem) {
  const ScratchFolder scratch;
  for (const Pace pace : {Pace::kFast, Pace::kReal}) {
    const RecordedSession run(test::kPostScene, scratch.path("out"), pace, 900);
    EXPECT_EQ(run.result.pieces, 1u);
    const RecordingReader reader(scratch.path("out/recording.h5"));
    EXPECT_EQ(reader.missing(), "");
    EXPECT_EQ(reader.pieces().size(), 1u);
    EXPECT_EQ(reader.taken_answers().size(), (900u - 50u) / 10u);
  }
}

TEST(SessionThreads, StopRequestEndsTheRunWithAllOnDisk) {
  const ScratchFolder scratch;
  pretend_stop(true);
  const RecordedSession run(test::kCutScene, scratch.path("out"), Pace::kFast);
  pretend_stop(false);
  EXPECT_TRUE(run.result.interrupted);
  EXPECT_EQ(run.result.statistics.ticks, 1u);
}

/// A burr that goes through a block, cutting, with a hand on it: from a tick on some threads find
/// no memory.
class FailingDevice final : public Device {
 public:
  FailingDevice(const Trajectory& trajectory, double rate_hz, test::NoMemory whose,
                std::uint64_t from)
      : script_(trajectory, rate_hz), whose_(whose), from_(from) {}
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    if (tick == from_) {
      test::mark_this_thread();
      test::set_no_memory(whose_);
    }
    return script_.pose(tick);
  }
  void apply(const Wrench&) noexcept override { ++applied; }
  bool fade() noexcept override {
    EXPECT_FALSE(released);
    return ++fades < 5;
  }
  void release() noexcept override {
    released = true;
    test::set_no_memory(test::NoMemory::kNobody);
  }

  std::uint64_t applied = 0;
  int fades = 0;
  bool released = false;

 private:
  ScriptedDevice script_;
  test::NoMemory whose_;
  std::uint64_t from_;
};

class FailingThreads : public ::testing::TestWithParam<test::NoMemory> {};

TEST_P(FailingThreads, EndTheRunWithoutForceAndWithWhatWasRecorded) {
  const ScratchFolder scratch;
  // The haptic thread needs some when it is told for the first time what has come loose.
  const bool haptic = GetParam() == test::NoMemory::kMarkedThreads;
  const std::uint64_t from = haptic ? 20 : 150;
  const Scene scene = parse_scene(haptic ? test::kPostScene : test::kCutScene, "test.toml");
  const Trajectory trajectory = make_trajectory(scene.trajectory);
  Simulation simulation(scene, build_shape(scene), {},
                        make_burr(scene.burr, scene.workpiece.voxel_m));
  FailingDevice device(trajectory, scene.haptics.rate_hz, GetParam(), from);
  SessionOptions options;
  options.folder = scratch.path("out");
  options.pace = Pace::kReal;
  options.ticks = 100'000;
  std::thread([&] {
    test::mark_this_thread();
    const SessionResult result = run_session(simulation, device, options);
    ASSERT_TRUE(result.failure);
    EXPECT_THROW(std::rethrow_exception(result.failure), std::bad_alloc);
  }).join();
  EXPECT_TRUE(device.released);
  EXPECT_EQ(device.fades, 5);
  EXPECT_GT(device.applied, from);
  EXPECT_LT(device.applied, options.ticks);
  const RecordingReader reader(scratch.path("out/recording.h5"));
  EXPECT_GE(reader.tick_count(), from / 2);
}

// The haptic thread; those that take the reports and record.
INSTANTIATE_TEST_SUITE_P(Each, FailingThreads,
                         ::testing::Values(test::NoMemory::kMarkedThreads,
                                           test::NoMemory::kOtherThreads));

}  // namespace
}  // namespace sulcus
