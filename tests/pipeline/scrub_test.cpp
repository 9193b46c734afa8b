// A recording at any time, on and back.
#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "app/playback/recorded_film.hpp"
#include "app/playback/recorded_state.hpp"
#include "engine/core/error.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::scrub_test {
namespace {

struct Hashes {
  std::uint64_t volume, state;
  bool operator==(const Hashes&) const = default;
};

class Scrub : public ::testing::Test {
 protected:
  std::string record(const std::string& scene) {
    const auto result = test::sulcus_command(
        "run " + scratch_.write("s.toml", scene) + " --no-render -o " + scratch_.path("out"),
        scratch_.path("err"));
    EXPECT_EQ(result.status, 0) << result.err;
    return scratch_.path("out/recording.h5");
  }
  static Hashes hashes(const RecordedState& state) {
    return {state.simulation().workpiece().hash(), state.simulation().state().hash()};
  }
  /// After every row, run from the start; those that were recorded are as recorded.
  static std::vector<Hashes> all_hashes(const std::string& recording) {
    RecordedRun run = open_recorded_run(recording);
    RecordedState state(run);
    std::vector<Hashes> all;
    while (state.next_row() < run.rows.size()) {
      state.step();
      all.push_back(hashes(state));
    }
    EXPECT_FALSE(run.reader.state_hashes().empty());
    for (const StateHash& hash : run.reader.state_hashes()) {
      const Hashes recorded{hash.volume, hash.state};
      EXPECT_EQ(all[hash.tick - run.rows.front().tick], recorded) << hash.tick;
    }
    return all;
  }

  ScratchFolder scratch_;
};

TEST_F(Scrub, BackwardGivesTheHashesOfTheWayOn) {
  const std::string recording = record(test::cut_scene());
  const std::vector<Hashes> all = all_hashes(recording);
  RecordedRun run = open_recorded_run(recording);
  ASSERT_GT(run.reader.keyframes().size(), 1u);
  RecordedState state(run);
  for (std::size_t row = all.size() - 1; row > 17; row -= 17) {
    state.seek_row(row);
    ASSERT_EQ(hashes(state), all[row]) << row;
    ASSERT_EQ(state.next_row(), row + 1);
  }
  state.seek_row(0);
  EXPECT_EQ(hashes(state), all[0]);
  for (const std::size_t row : {150u, 151u, 401u, 260u, 399u}) {
    state.seek_row(row);
    EXPECT_EQ(hashes(state), all[row]) << row;
  }
}

TEST_F(Scrub, APieceThatCameLooseGoesBackToItsPlace) {
  const std::string recording = record(test::post_scene());
  const std::vector<Hashes> all = all_hashes(recording);
  RecordedRun run = open_recorded_run(recording);
  ASSERT_FALSE(run.reader.pieces().empty());
  const std::size_t left = run.reader.pieces()[0].tick;
  RecordedState state(run);
  for (const std::size_t row : {all.size() - 1, left + 3, left - 60, left + 30}) {
    state.seek_row(row);
    EXPECT_EQ(hashes(state), all[row]) << row;
  }
}

TEST_F(Scrub, ARecordingOfVersion1IsRunFromItsStart) {
  RecordedRun run = open_recorded_run(SULCUS_SOURCE_DIR "/tests/recording/version_1.h5");
  RecordedState state(run);
  state.seek_row(50);
  const Hashes there = hashes(state);
  VoxelModel then = run.reader.workpiece();
  for (const Edit& edit : run.reader.edits()) {
    if (edit.tick <= 60) then.set(then.grid.cell_of_linear(edit.voxel), false);
  }
  state.seek_row(60);
  EXPECT_EQ(state.simulation().workpiece().hash(), Workpiece(std::move(then)).hash());
  state.seek_row(50);
  EXPECT_EQ(hashes(state), there);
  // In tick 65 this build removes other voxels than that one did.
  EXPECT_THROW(state.seek_row(99), InputError);
}

TEST_F(Scrub, AShapeGoesOnAndBack) {
  const RecordingReader reader(record(test::cut_scene()));
  RecordedShape shape(reader, reader.workpiece());
  const auto voxels_at = [&](std::size_t row) {
    shape.seek_row(row);
    return shape.model().solid_count();
  };
  const std::uint64_t start = voxels_at(0), middle = voxels_at(250), end = voxels_at(400);
  EXPECT_GT(start, middle);
  EXPECT_GT(middle, end);
  EXPECT_EQ(voxels_at(250), middle);
  EXPECT_EQ(voxels_at(0), start);
  // What was passed on the way.
  EXPECT_EQ(shape.seek_row(400).size(), start - end);
  EXPECT_EQ(shape.seek_row(250).size(), middle - end);
}

TEST_F(Scrub, AFilmIsTheSameOnTheWayBack) {
  // A film drives what draws it: voxels that are gone of each body, levels, and pieces.
  struct Drawing {
    std::set<std::pair<std::size_t, std::uint32_t>> gone;
    std::size_t pieces = 0;
    void remove(std::size_t body, std::span<const std::uint32_t> voxels, double) {
      for (const std::uint32_t voxel : voxels) EXPECT_TRUE(gone.emplace(body, voxel).second);
    }
    void restore(std::size_t body, std::span<const std::uint32_t> voxels) {
      for (const std::uint32_t voxel : voxels) EXPECT_EQ(gone.erase({body, voxel}), 1u);
    }
    void set_levels(std::size_t, std::span<const VoxelLevel>) { ADD_FAILURE() << "is binary"; }
    void add_piece(std::span<const std::uint32_t>) { ++pieces; }
  };
  const std::string recording = record(test::post_scene());
  const RecordingReader reader(recording);
  const std::size_t left = reader.pieces().at(0).tick, end = reader.tick_count() - 1;
  const auto told = [](const FrameState& state) {
    std::string text = std::to_string(state.tick) + ' ' + std::to_string(state.removed_mm3) + ' ' +
                       std::to_string(state.pieces.size()) + ' ' +
                       std::to_string(state.burr_turn_rad);
    for (const OutcomeLine& line : state.outcome) text += ' ' + line.name + '=' + line.value;
    for (const float f : state.force_history_N) text += ' ' + std::to_string(f);
    return text;
  };
  RecordedFilm film(reader, recording);
  Drawing drawing;
  for (const std::size_t row : {left + 20, end, left - 50, std::size_t{0}, left + 40, left + 5}) {
    RecordedFilm fresh(reader, recording);
    Drawing straight;
    const std::string expected = told(fresh.seek_row(row, straight));
    EXPECT_EQ(told(film.seek_row(row, drawing)), expected) << row;
    EXPECT_EQ(drawing.gone, straight.gone) << row;
  }
  EXPECT_EQ(drawing.pieces, reader.pieces().size()) << "each is meshed once";
}

}  // namespace
}  // namespace sulcus::scrub_test
