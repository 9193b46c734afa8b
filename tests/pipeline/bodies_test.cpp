// A scene with other bodies than the workpiece, from its run to its replay.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/core/hash.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/recording/recording_writer.hpp"
#include "engine/volume/workpiece.hpp"
#include "tests/pipeline/energy_balance.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::bodies_test {
namespace {

using test::sulcus_command;

/// The block, and a tenth of a millimetre beside it another of larger voxels, turned by a right
/// angle. The burr goes from the one into the other.
class Bodies : public ::testing::Test {
 protected:
  Bodies() {
    std::ofstream(scratch_.path("s.toml")) << test::render_scene() << R"(
[[body]]
name = "neighbour"
shape = "box"
voxel_mm = 0.0625
cells = [40, 40, 40]
box.size_mm = [2, 2, 2]
position_mm = [2.1, 0, 0]
rotation_deg = [0, 0, 90]
cuttable = true
)";
  }
  nlohmann::json run(const std::string& options = "") {
    const auto result = sulcus_command(
        "run " + scratch_.path("s.toml") +
            " --set burr.speed_rpm=400000"
            " --set 'trajectory.points_mm=[[0.3, 0, 1.2], [0.3, 0, 0.92], [2.3, 0, 0.92]]' " +
            options + " -o " + scratch_.path("out"),
        scratch_.path("err"));
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(test::read_file(scratch_.path("out/summary.json")));
  }
  /// The recording draws the same last picture as the run did.
  void expect_last_picture_drawn_again() {
    const auto drawn = sulcus_command(
        "render " + scratch_.path("out/recording.h5") + " -o " + scratch_.path("drawn"),
        scratch_.path("err"));
    EXPECT_EQ(drawn.status, 0) << drawn.err;
    std::string last;
    for (const auto& frame : std::filesystem::directory_iterator(scratch_.path("out/frames"))) {
      last = std::max(last, frame.path().string());
    }
    EXPECT_EQ(test::read_file(drawn.out.substr(0, drawn.out.find('\n'))), test::read_file(last));
  }
  const ScratchFolder scratch_;
};

TEST_F(Bodies, WhatWasCutOfTheNeighbourIsCountedRecordedAndReplayed) {
  const nlohmann::json summary = run("--set render.hud=false");
  const RecordingReader reader(scratch_.path("out/recording.h5"));
  const std::vector<Edit> edits = reader.edits();
  const auto of_neighbour = std::ranges::count(edits, 1, &Edit::body);
  const auto of_workpiece = std::ranges::count(edits, 0, &Edit::body);
  EXPECT_GT(of_neighbour, 100);
  EXPECT_GT(of_workpiece, 100);
  EXPECT_EQ(summary["removed_voxels"], of_workpiece);
  ASSERT_EQ(summary["bodies"].size(), 1u);
  const nlohmann::json& body = summary["bodies"][0];
  EXPECT_EQ(body["name"], "neighbour");
  EXPECT_NEAR(body["removed_mm3"]["enamel"].get<double>(),
              static_cast<double>(of_neighbour) * 0.0625 * 0.0625 * 0.0625, 1e-12);
  EXPECT_GT(body["contact_s"].get<double>(), 0.05);
  EXPECT_GT(body["peak_force_N"].get<double>(), 0.05);
  test::expect_energies_balance(summary);

  VoxelModel neighbour = reader.bodies().at(0);
  for (const Edit& edit : edits) {
    if (edit.body == 1) neighbour.set(neighbour.grid.cell_of_linear(edit.voxel), false);
  }
  EXPECT_EQ(body["volume_hash"], hex(Workpiece(neighbour).hash()));

  const auto verified =
      sulcus_command("replay --verify " + scratch_.path("out/recording.h5"), scratch_.path("err"));
  EXPECT_EQ(verified.status, 0) << verified.err;
  EXPECT_NE(verified.out.find("agree bit for bit"), std::string::npos);
  expect_last_picture_drawn_again();
}

TEST_F(Bodies, WhatWasCutOfOneWithFractionsIsCountedByItsFills) {
  std::string scene = test::read_file(scratch_.path("s.toml"));
  scene.insert(scene.find("[[body]]") + 8, "\nsurface = \"fractions\"");
  std::ofstream(scratch_.path("s.toml")) << scene;
  const nlohmann::json summary = run(
      "--set haptics.normals=ldm_fast --set workpiece.surface=fractions --set render.hud=false");
  expect_last_picture_drawn_again();
  const RecordingReader reader(scratch_.path("out/recording.h5"));
  const VoxelModel start = reader.bodies().at(0);
  ASSERT_TRUE(start.fills);
  std::map<std::uint32_t, int> left;  // levels of the voxels that were cut
  for (const Edit& fill : reader.fills()) {
    if (fill.body == 1) left[fill.voxel] = fill.level;
  }
  for (const Edit& edit : reader.edits()) {
    if (edit.body == 1) left[edit.voxel] = 0;
  }
  EXPECT_GT(left.size(), 100u);
  int removed = 0;
  for (const auto& [voxel, level] : left) {
    removed += start.level(start.grid.cell_of_linear(voxel)) - level;
  }
  EXPECT_NEAR(summary["bodies"][0]["removed_mm3"]["enamel"].get<double>(),
              removed / 255.0 * 0.0625 * 0.0625 * 0.0625, 1e-12);
}

TEST_F(Bodies, OneThatIsNotCuttableHolds) {
  std::string scene = test::read_file(scratch_.path("s.toml"));
  scene.erase(scene.find("cuttable"));
  std::ofstream(scratch_.path("s.toml")) << scene;
  const nlohmann::json summary = run("--no-render");
  const std::vector<Edit> edits = RecordingReader(scratch_.path("out/recording.h5")).edits();
  EXPECT_GT(edits.size(), 100u);
  EXPECT_EQ(std::ranges::count(edits, 1, &Edit::body), 0);
  EXPECT_EQ(summary["bodies"][0]["removed_mm3"]["enamel"], 0.0);
  EXPECT_GT(summary["bodies"][0]["contact_s"].get<double>(), 0.05);
  EXPECT_GT(summary["force_N"]["max"].get<double>(), 1.0) << "the burr is driven into it";
}

TEST_F(Bodies, AStartInOneIsRefusedByItsName) {
  const auto result =
      sulcus_command("run " + scratch_.path("s.toml") +
                         " --set 'trajectory.points_mm=[[2.1, 0, 0]]' -o " + scratch_.path("out"),
                     scratch_.path("err"));
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("found a start with the burr's head inside 'neighbour', at"),
            std::string::npos)
      << result.err;
}

TEST_F(Bodies, ASceneWithoutThemSaysNothingOfThem) {
  std::ofstream(scratch_.path("s.toml")) << test::cut_scene();
  const nlohmann::json summary = run();
  EXPECT_FALSE(summary.contains("bodies"));
  for (const auto& part : summary["parts"]) EXPECT_NE(part["name"], "bodies");
  EXPECT_TRUE(RecordingReader(scratch_.path("out/recording.h5")).bodies().empty());
}

TEST(LooseBesideABody, ThePieceFallsWhileTheNeighbourIsCutAndAllOfItReplays) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("post.toml", test::post_scene() + R"(
[[body]]
name = "neighbour"
shape = "box"
voxel_mm = 0.05
cells = [32, 48, 48]
box.size_mm = [1, 2, 2]
position_mm = [1.6, 0, 0.3]
cuttable = true
[[body]]
name = "shelf"
shape = "box"
voxel_mm = 0.1
cells = [48, 48, 8]
box.size_mm = [4, 4, 0.4]
position_mm = [0, 0, -1.5]
)");
  const auto result =
      sulcus_command("run " + scene + " -o " + scratch.path("out"), scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto summary = nlohmann::json::parse(test::read_file(scratch.path("out/summary.json")));
  EXPECT_EQ(summary["fragments"], 1);
  EXPECT_GT(summary["bodies"][0]["removed_mm3"]["enamel"].get<double>(), 0.01);
  EXPECT_EQ(summary["bodies"][1]["removed_mm3"]["enamel"], 0.0);
  const RecordingReader reader(scratch.path("out/recording.h5"));
  ASSERT_EQ(reader.pieces().size(), 1u);
  EXPECT_NEAR(static_cast<double>(reader.pieces()[0].voxels) * 0.05 * 0.05 * 0.05, 0.125, 0.03)
      << "what is cut of the neighbour separates nothing of the post";
  ASSERT_FALSE(reader.piece_poses().empty());
  EXPECT_LT(reader.piece_poses().back().position_m[2], -0.4e-3);
  const auto again =
      sulcus_command("replay --verify " + scratch.path("out/recording.h5"), scratch.path("err"));
  EXPECT_EQ(again.status, 0) << again.err;
}

/// A recording of one tick at rest, whose parts need not fit its scene.
class ForgedRecording : public ::testing::Test {
 protected:
  /// What `render` says of it.
  std::string refusal(const std::string& bodies, const VoxelModel& workpiece,
                      const std::vector<const VoxelModel*>& others) {
    RecordingHeader header;
    header.scene_toml =
        "[workpiece]\nshape = 'box'\nvoxel_mm = 0.1\ncells = [16, 16, 16]\n"
        "[trajectory]\npoints_mm = [[0, 0, 9]]\n" +
        bodies;
    header.rate_hz = 1000.0;
    RecordingWriter writer(scratch_.path("r.h5"), header, workpiece, nullptr, {},
                           {others, nullptr});
    TickRecord row;
    seal(row);
    writer.append_ticks({&row, 1});
    writer.close();
    for (const std::string command : {"render ", "replay --verify "}) {
      const auto result = sulcus_command(command + scratch_.path("r.h5"), scratch_.path("err"));
      EXPECT_EQ(result.status, 2) << command;
      found_ = result.err;
    }
    return found_;
  }
  static VoxelModel block(double voxel_m = 1e-4, int label = 0) {
    VoxelModel model;
    model.grid.cells = {16, 16, 16};
    model.grid.voxel_m = voxel_m;
    model.leaves.resize(model.grid.leaf_count());
    for (int i = 4; i < 12; ++i) model.set({i, 8, 8}, true);
    if (label > 0) {
      auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
      for (std::uint32_t leaf = 0; leaf < tissues->leaf_count(); ++leaf) {
        tissues->set_uniform(leaf, static_cast<std::uint8_t>(label));
      }
      model.tissues = tissues;
    }
    return model;
  }
  const std::string body_ = "[[body]]\nshape = 'box'\nvoxel_mm = 0.1\ncells = [16, 16, 16]\n";
  const ScratchFolder scratch_;
  std::string found_;
};

TEST_F(ForgedRecording, BodiesThatAreNotItsScenesAreRefused) {
  const VoxelModel plain = block(), coarse = block(2e-4), labelled = block(1e-4, 7);
  EXPECT_NE(refusal(body_ + body_, plain, {&plain}).find("/bodies: found 1 bodies, expected 2"),
            std::string::npos)
      << found_;
  EXPECT_NE(refusal(body_, plain, {&coarse}).find("/bodies/0: found another grid"),
            std::string::npos)
      << found_;
  EXPECT_NE(refusal("", coarse, {}).find("/workpiece: found another grid"), std::string::npos)
      << found_;
  EXPECT_NE(refusal(body_, plain, {&labelled}).find("/bodies/0: found the tissue 7"),
            std::string::npos)
      << found_;
  EXPECT_NE(refusal("", labelled, {}).find("/workpiece: found the tissue 7"), std::string::npos)
      << found_;
}

}  // namespace
}  // namespace sulcus::bodies_test
