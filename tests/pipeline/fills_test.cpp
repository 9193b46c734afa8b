// Fill levels from the cut to the file, and to any time of it again.
#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/playback/recorded_film.hpp"
#include "app/playback/recorded_state.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "engine/recording/recording_writer.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::fills_test {
namespace {

const std::string kFilledScene = R"(
title = "filled"
[workpiece]
shape = "sphere"
voxel_mm = 0.05
cells = [64, 64, 64]
surface = "fractions"
[workpiece.sphere]
radius_mm = 1.1
[[body]]
name = "binary"
shape = "box"
voxel_mm = 0.05
cells = [16, 16, 16]
position_mm = [0, 0, -1.6]
[body.box]
size_mm = [0.5, 0.5, 0.5]
[burr]
diameter_mm = 0.8
speed_rpm = 100000
field = [48, 192, 48]
[trajectory]
points_mm = [[-0.6, 0, 1.2], [-0.6, 0, 0.82], [0.6, 0, 0.82], [0.6, 0, 1.2]]
speed_mm_per_s = 4
[haptics]
normals = "ldm_fast"
[cutting]
[record]
)";

using Levels = std::vector<FillLevel>;

/// Of each voxel of the workpiece; after all edits of ticks up to one, made one after another.
Levels levels_of(const VoxelModel& model) {
  Levels levels;
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    levels.push_back(model.level(model.grid.cell_of_linear(v)));
  }
  return levels;
}
Levels levels_after(const RecordingReader& reader, std::uint64_t tick) {
  Levels levels = levels_of(reader.workpiece());
  for (const Edit& fill : reader.fills()) {
    if (fill.tick <= tick && fill.body == 0) levels[fill.voxel] = fill.level;
  }
  for (const Edit& edit : reader.edits()) {
    if (edit.tick <= tick && edit.body == 0) levels[edit.voxel] = 0;
  }
  return levels;
}
double volume_mm3(const Levels& levels) {
  double sum = 0.0;
  for (const FillLevel level : levels) sum += level / 255.0;
  return sum * 0.05 * 0.05 * 0.05;
}
std::uint64_t solid_in(const Levels& levels) {
  return levels.size() - static_cast<std::uint64_t>(std::ranges::count(levels, 0));
}

class Fills : public testing::Test {
 protected:
  test::CommandResult command(const std::string& arguments) {
    return test::sulcus_command(arguments, scratch_.path("err"));
  }
  std::string record() {
    const auto result =
        command("run " + scratch_.write("s.toml", kFilledScene) + " -o " + scratch_.path("out"));
    EXPECT_EQ(result.status, 0) << result.err;
    return scratch_.path("out/recording.h5");
  }
  /// The recording with levels that fall in it, of voxels whose level the run did not lower:
  /// several in some, as long as they stand, up to the tick in which they go.
  std::string lowered(const std::string& recording, bool one_rises = false) {
    const RecordingReader reader(recording);
    const std::vector<TickRecord> rows = reader.ticks();
    std::vector<Edit> edits = reader.edits(), fills = reader.fills();
    const Levels start = levels_of(reader.workpiece());
    std::map<std::uint32_t, std::uint64_t> last;  // tick of a voxel
    for (const Edit& edit : edits) {
      if (edit.body == 0) last[edit.voxel] = edit.tick;
    }
    for (const Edit& fill : fills) last[fill.voxel] = 0;
    std::mt19937 random(1);
    std::size_t made = 0;
    for (std::uint32_t v = 0; v < start.size(); ++v) {
      if (start[v] < 2 || (!last.contains(v) && random() % 40 != 0)) continue;
      std::uint64_t tick = 1;
      std::uint64_t level = start[v];
      const std::uint64_t end = last.contains(v) ? last[v] : rows.back().tick;
      while (level > 1 && (tick += random() % 60) <= end) {
        level = 1 + random() % (level - 1);
        fills.push_back({tick, v, 0, EditCause::kCut, static_cast<FillLevel>(level)});
        ++made;
      }
    }
    EXPECT_GT(made, 1000u);
    if (one_rises) fills.push_back({rows.back().tick, fills.back().voxel, 0, EditCause::kCut, 254});
    std::ranges::stable_sort(fills, {}, &Edit::tick);
    const std::string path = scratch_.path("lowered.h5");
    const VoxelModel workpiece = reader.workpiece(), body = reader.bodies().at(0);
    RecordingWriter writer(path, reader.header(), workpiece, nullptr, {},
                           {{&body}, nullptr, nullptr, nullptr});
    writer.append_edits(edits);
    writer.append_edits(fills);
    for (const TickRecord& row : rows) {
      const auto before = std::ranges::upper_bound(fills, row.tick, {}, &Edit::tick);
      const auto count = static_cast<std::uint64_t>(before - fills.begin());
      const FillEndRow end = sealed(FillEndRow{row.tick, count, 0});
      writer.append_fill_ends({&end, 1});
    }
    writer.append_ticks(rows);
    writer.close();
    return path;
  }
  static std::vector<std::size_t> some_rows(std::size_t count) {
    std::mt19937 random(2);
    std::vector<std::size_t> rows{count - 1, 0};
    for (int i = 0; i < 8; ++i) rows.push_back(random() % count);
    return rows;
  }

  ScratchFolder scratch_;
};

TEST_F(Fills, ARunVerifiesIsRepairedAndGoesOn) {
  const std::string recording = record();
  const RecordingReader reader(recording);
  ASSERT_TRUE(reader.has_fills());
  ASSERT_GT(reader.edit_count(), 100u);
  const auto verified = command("replay --verify " + recording);
  EXPECT_EQ(verified.status, 0) << verified.err;
  EXPECT_NE(verified.out.find(std::to_string(reader.fill_count()) + " lowered levels and"),
            std::string::npos)
      << verified.out;
  EXPECT_NE(command("inspect " + recording)
                .out.find("lowered levels   " + std::to_string(reader.fill_count())),
            std::string::npos);

  const std::string repaired = scratch_.path("repaired.h5"), on = scratch_.path("on/recording.h5");
  ASSERT_EQ(command("repair " + recording + " -o " + repaired).status, 0);
  EXPECT_EQ(command("replay --verify " + repaired).status, 0);
  ASSERT_EQ(command("replay " + recording + " --from 0.25 -o " + scratch_.path("on")).status, 0);
  const auto on_verified = command("replay --verify " + on);
  EXPECT_EQ(on_verified.status, 0) << on_verified.err;
  EXPECT_EQ(RecordingReader(on).state_hashes().back().volume, reader.state_hashes().back().volume);
  EXPECT_EQ(RecordingReader(on).state_hashes().back().state, reader.state_hashes().back().state);

  // Of the whole, by what each voxel was filled up to.
  const Levels start = levels_of(reader.workpiece()), end = levels_after(reader, ~0ull);
  for (const std::string& of : {scratch_.path("out"), scratch_.path("on")}) {
    const auto summary = nlohmann::json::parse(test::read_file(of + "/summary.json"));
    double removed_mm3 = 0.0, left_mm3 = 0.0, first_mm3 = 0.0;
    for (const auto& tissue : summary["removed_mm3"]) removed_mm3 += tissue.get<double>();
    for (const auto& tissue : summary["workpiece"]["tissue_mm3"]) left_mm3 += tissue.get<double>();
    for (const auto& tissue : summary["workpiece_start"]["tissue_mm3"]) {
      first_mm3 += tissue.get<double>();
    }
    EXPECT_NEAR(removed_mm3, volume_mm3(start) - volume_mm3(end), 1e-9) << of;
    EXPECT_NEAR(left_mm3, volume_mm3(end), 1e-9) << of;
    // What the cutting of it cost.
    EXPECT_NEAR(removed_mm3 * 3.5, summary["removed_energy_J"].get<double>(), 1e-9) << of;
    EXPECT_NEAR(first_mm3, volume_mm3(start), 1e-9) << of;
    EXPECT_EQ(summary["workpiece"]["solid_voxels"], solid_in(end)) << of;
    if (of == scratch_.path("out")) {
      EXPECT_EQ(summary["removed_voxels"], solid_in(start) - solid_in(end));
    }
  }
}

TEST_F(Fills, ALoosePieceIsAsLargeAsWhatOfItIsFilled) {
  // Of voxels that are part filled all around: counted whole they are larger by two fifths.
  const auto run = [&](const std::string& smallest_mm3) {
    const std::string folder = scratch_.path("post_" + smallest_mm3);
    const auto result = command("run " + scratch_.write("post.toml", test::post_scene()) +
                                " --set workpiece.surface=fractions --set "
                                "'workpiece.box.size_mm=[0.53, 0.53, 2.43]' --set "
                                "loose_pieces.smallest_mm3=" +
                                smallest_mm3 + " -o " + folder);
    EXPECT_EQ(result.status, 0) << result.err;
    return folder;
  };
  const std::string folder = run("0.1");
  const RecordingReader reader(folder + "/recording.h5");
  ASSERT_EQ(reader.pieces().size(), 1u);
  Levels levels = levels_of(reader.workpiece());
  for (const Edit& fill : reader.fills()) levels[fill.voxel] = fill.level;
  Levels loose;
  for (const Edit& edit : reader.edits()) {
    if (edit.cause == EditCause::kLoose) loose.push_back(levels[edit.voxel]);
  }
  const double filled_mm3 = volume_mm3(loose);
  ASSERT_GT(static_cast<double>(loose.size()) * 0.05 * 0.05 * 0.05, 1.2 * filled_mm3);
  const auto summary = nlohmann::json::parse(test::read_file(folder + "/summary.json"));
  EXPECT_NEAR(summary["outcome"]["removed_mm3"]["loose"]["enamel"].get<double>(), filled_mm3, 1e-9);
  const std::string without = run(std::to_string(1.02 * filled_mm3));
  EXPECT_EQ(RecordingReader(without + "/recording.h5").pieces().size(), 0u);
}

TEST_F(Fills, AStateAtAnyTimeHasTheLevelsOfItsEdits) {
  RecordedRun run = open_recorded_run(record());
  const VoxelModel start = run.reader.workpiece();
  RecordedState state(run);
  for (const std::size_t row : some_rows(run.rows.size())) {
    state.seek_row(row);
    const Workpiece& there = state.simulation().workpiece();
    ASSERT_EQ(levels_of(there.model()), levels_after(run.reader, run.rows[row].tick)) << row;
    ASSERT_EQ(there.hash(), Workpiece(there.model()).hash()) << row;
  }
}

TEST_F(Fills, AShapeAndAFilmAtAnyTimeAreWhatTheEditsMakeOfThem) {
  struct Drawing {
    Levels levels, gone;  // of the workpiece; with what voxels went
    void remove(std::size_t body, std::span<const std::uint32_t> voxels, double) {
      if (body != 0) return;
      for (const std::uint32_t v : voxels) gone[v] = std::exchange(levels[v], FillLevel{0});
    }
    void restore(std::size_t body, std::span<const std::uint32_t> voxels) {
      if (body != 0) return;
      for (const std::uint32_t v : voxels) levels[v] = gone[v];
    }
    void set_levels(std::size_t body, std::span<const VoxelLevel> left) {
      ASSERT_EQ(body, 0u) << "the other is binary";
      for (const auto& [voxel, level] : left) {
        EXPECT_GT(levels[voxel], 0) << "stands";
        levels[voxel] = level;
      }
    }
    void add_piece(std::span<const std::uint32_t>) {}
  };
  const std::string recording = lowered(record());
  const RecordingReader reader(recording);
  ASSERT_EQ(reader.missing(), "");
  RecordedShape shape(reader, reader.workpiece());
  RecordedFilm film(reader, recording);
  const Levels start = levels_of(reader.workpiece());
  Drawing drawing{start, start};
  for (const std::size_t row : some_rows(reader.tick_count())) {
    const Levels there = levels_after(reader, shape.rows()[row].tick);
    shape.seek_row(row);
    ASSERT_EQ(levels_of(shape.model()), there) << row;
    EXPECT_NEAR(film.seek_row(row, drawing).removed_mm3, volume_mm3(start) - volume_mm3(there),
                1e-9);
    EXPECT_EQ(drawing.levels, there) << row;
  }
}

TEST_F(Fills, AreExportedAsTheyAreAtATime) {
  const std::string recording = lowered(record());
  const RecordingReader reader(recording);
  for (const double at_s : {0.05, 0.2, 0.33, 0.48}) {
    const std::string fills = scratch_.path("f.nrrd"), mask = scratch_.path("m.nrrd");
    const auto result = command("export " + recording + " --at " + std::to_string(at_s) +
                                " --fills " + fills + " --volume " + mask);
    ASSERT_EQ(result.status, 0) << result.err;
    const Levels there = levels_after(reader, static_cast<std::uint64_t>(at_s * 1000 + 0.5));
    const MedicalVolume written = read_medical_volume(fills), of_mask = read_medical_volume(mask);
    ASSERT_EQ(written.values.size(), there.size());
    EXPECT_EQ(written.origin_m, of_mask.origin_m);
    for (std::size_t v = 0; v < there.size(); ++v) {
      ASSERT_EQ(written.values[v], there[v]) << v;
      ASSERT_EQ(of_mask.values[v], there[v] > 0 ? 1.0f : 0.0f) << v;
    }
  }
}

TEST_F(Fills, ThatAreNotThoseOfTheRunAreNoticed) {
  const auto differs = command("replay --verify " + lowered(record()));
  EXPECT_EQ(differs.status, 1);
  EXPECT_NE(differs.err.find("differs in the voxels removed or lowered"), std::string::npos)
      << differs.err;
}

TEST_F(Fills, ALevelThatDoesNotFallIsRefused) {
  const std::string recording = lowered(record(), true);
  for (const std::string& with :
       {"export --csv " + scratch_.path("c.csv"), std::string("replay --verify")}) {
    const auto result = command(with + " " + recording);
    EXPECT_EQ(result.status, 2) << with;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_NE(result.err.find("level 254 in tick"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("a lower one"), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace sulcus::fills_test
