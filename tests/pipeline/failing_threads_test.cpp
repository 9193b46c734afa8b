// Threads of a run that find no memory. A program of its own: ThreadSanitizer has a `new` that
// cannot be replaced.

#include <exception>
#include <new>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "app/session/session.hpp"
#include "app/session/simulation.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/shapes/build_shape.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/failing_memory.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::failing_threads_test {
namespace {

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
  const Scene scene = parse_scene(haptic ? test::post_scene() : test::cut_scene(), "test.toml");
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
}  // namespace sulcus::failing_threads_test
