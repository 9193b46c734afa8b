// The threads of a run with what they share: for ThreadSanitizer as much as for the result.
#include "app/session/session.hpp"

#include <thread>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "app/session/simulation.hpp"
#include "engine/core/stop.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/shapes/build_shape.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::session_test {
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
    const RecordedSession run(test::cut_scene(), scratch.path("out"), pace);
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
    const RecordedSession run(test::post_scene(), scratch.path("out"), pace, 900);
    EXPECT_EQ(run.result.pieces, 1u);
    const RecordingReader reader(scratch.path("out/recording.h5"));
    EXPECT_EQ(reader.missing(), "");
    EXPECT_EQ(reader.pieces().size(), 1u);
    // Outputs after ticks 9, 19, ...; every answer is taken in its turn, 50 ticks later or, at real
    // pace on a busy machine, in a later tick or after the last one.
    const std::vector<TakenAnswerRow> answers = reader.taken_answers();
    ASSERT_FALSE(answers.empty());
    for (std::size_t i = 0; i < answers.size(); ++i) {
      EXPECT_EQ(answers[i].asked, 9 + 10 * i);
      EXPECT_GE(answers[i].taken, answers[i].asked + 50);
      EXPECT_LT(answers[i].taken, 900u);
      EXPECT_GE(answers[i].taken, answers[i == 0 ? 0 : i - 1].taken);
    }
    if (pace == Pace::kFast) {
      EXPECT_EQ(answers.size(), (900u - 50u) / 10u);
      EXPECT_EQ(answers.back().taken, answers.back().asked + 50);
    }
  }
}

TEST(SessionThreads, StopRequestEndsTheRunWithAllOnDisk) {
  const ScratchFolder scratch;
  pretend_stop(true);
  const RecordedSession run(test::cut_scene(), scratch.path("out"), Pace::kFast);
  pretend_stop(false);
  EXPECT_TRUE(run.result.interrupted);
  EXPECT_EQ(run.result.statistics.ticks, 1u);
}

}  // namespace
}  // namespace sulcus::session_test
