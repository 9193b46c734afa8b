#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "engine/recording/recording_reader.hpp"
#include "engine/recording/recording_writer.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::replay_test {
namespace {

using test::sulcus_command;

/// A cut that has been recorded.
class Replay : public testing::Test {
 protected:
  void SetUp() override {
    const std::string scene = scratch_.write("s.toml", test::cut_scene());
    const auto result =
        sulcus_command("run " + scene + " -o " + scratch_.path("out"), scratch_.path("err"));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  test::CommandResult command(const std::string& arguments) {
    return sulcus_command(arguments, scratch_.path("err"));
  }
  /// The recording with one row or edit changed, sealed as if it had been so.
  std::string altered(const std::function<void(std::vector<TickRecord>&, std::vector<Edit>&)>& by) {
    const RecordingReader reader(recording());
    std::vector<TickRecord> rows = reader.ticks();
    std::vector<Edit> edits = reader.edits();
    by(rows, edits);
    for (TickRecord& row : rows) seal(row);
    const std::string path = scratch_.path("altered.h5");
    RecordingWriter writer(path, reader.header(), reader.workpiece(), nullptr);
    writer.append_edits(edits);
    writer.append_ticks(rows);
    writer.close();
    return path;
  }
  std::string recording() const { return scratch_.path("out/recording.h5"); }

  ScratchFolder scratch_;
};

TEST_F(Replay, VerifiesEveryTickAndTheVolume) {
  const auto result = command("replay --verify " + recording());
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("agree bit for bit"), std::string::npos) << result.out;
}

TEST_F(Replay, NamesTheFirstTickThatDiffersAndTheQuantity) {
  const std::string path = altered([](auto& rows, auto&) {
    double& force = rows[200].force_N[2];
    force = std::nextafter(force, 1e9);  // one bit
    rows[250].contacts += 1;
  });
  const auto result = command("replay --verify " + path);
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("tick 200 differs in force_N"), std::string::npos) << result.err;
}

TEST_F(Replay, NoticesAnotherVoxel) {
  const std::string path = altered([](auto&, auto& edits) { edits[10].voxel += 1; });
  const auto result = command("replay --verify " + path);
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("differs in the voxels removed"), std::string::npos) << result.err;
}

TEST_F(Replay, ExportedMeshIsClosedAndVolumeReadsBack) {
  const std::string mesh = scratch_.path("cut.stl"), volume = scratch_.path("cut.nrrd");
  const std::string csv = scratch_.path("cut.csv");
  const auto exported = command("export " + recording() + " --mesh " + mesh + " --volume " +
                                volume + " --csv " + csv);
  ASSERT_EQ(exported.status, 0) << exported.err;
  const auto inspected = command("inspect " + mesh);
  EXPECT_NE(inspected.out.find("open edges       0 (closed)"), std::string::npos) << inspected.out;

  const RecordingReader reader(recording());
  const std::uint64_t solid = reader.workpiece().solid_count() - reader.edit_count();
  EXPECT_GT(reader.edit_count(), 100u);
  const auto voxels = command("inspect " + volume);
  EXPECT_NE(voxels.out.find("voxels above 0   " + std::to_string(solid) + " "), std::string::npos)
      << voxels.out;
  const std::string table = test::read_file(csv);
  EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')),
            reader.tick_count() + 1);
}

TEST_F(Replay, DrawsAnyTimeOfIt) {
  const auto result = command("render " + recording() + " --at 0.1 --at 0.3 --size 160x120 -o " +
                              scratch_.path("pictures"));
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string early = test::read_file(scratch_.path("pictures/review_0.100s.png"));
  const std::string late = test::read_file(scratch_.path("pictures/review_0.300s.png"));
  EXPECT_FALSE(early.empty());
  EXPECT_NE(early, late);
}

TEST_F(Replay, DrawsFromSeveralCamerasAndIntoOneSheet) {
  const auto result =
      command("render " + recording() + " --at 0.1 --at 0.3 --camera occlusal --camera -90,30,2 " +
              "--section y=0 --arrows --size 160x120 -o " + scratch_.path("pictures"));
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* name : {"occlusal_0.100s_y=0", "occlusal_0.300s_y=0", "-90_30_2_0.100s_y=0"}) {
    EXPECT_FALSE(test::read_file(scratch_.path("pictures/") + name + ".png").empty()) << name;
  }
  const auto sheet = command("render " + recording() +
                             " --at 0.1 --at 0.3 --camera occlusal --camera burr --size 160x120 " +
                             "--colour-by time --sheet " + scratch_.path("sheet.png"));
  ASSERT_EQ(sheet.status, 0) << sheet.err;
  const std::string png = test::read_file(scratch_.path("sheet.png"));
  ASSERT_GT(png.size(), 24u);
  const auto number = [&](std::size_t at) {  // big-endian, of the header
    return static_cast<unsigned char>(png[at + 2]) * 256 + static_cast<unsigned char>(png[at + 3]);
  };
  EXPECT_EQ(number(16), 320);
  EXPECT_EQ(number(20), 240);
}

TEST_F(Replay, AReviewPageNeedsNothingBesideIt) {
  const std::string file = scratch_.path("review.html");
  const auto result = command("render " + recording() + " --review " + file);
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string page = test::read_file(file);
  const auto count = [&](const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = page.find(what); at != std::string::npos; at = page.find(what, at + 1)) {
      ++found;
    }
    return found;
  };
  EXPECT_EQ(count("<img "), 17u);  // 4 before, 4 after, 1 of the cut, 8 on the way
  EXPECT_EQ(count("src=\"data:image/png;base64,"), 17u);
  EXPECT_EQ(count("<svg "), 5u);
  EXPECT_EQ(count("src=\"http"), 0u);
  EXPECT_EQ(count("href=\"http"), 0u);
  EXPECT_EQ(count("default-src 'none'"), 1u);
  EXPECT_EQ(count("summary.json"), 1u);
  EXPECT_TRUE(page.ends_with("</body></html>\n"));
}

TEST_F(Replay, WithoutADisplayAWindowSaysWhatDrawsInstead) {
  const auto result =
      test::program_command(SULCUS_PROGRAM, "view " + recording(), scratch_.path("err"),
                            "-u DISPLAY -u WAYLAND_DISPLAY SULCUS_CACHE=off");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("no display for a window"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("sulcus render"), std::string::npos);
  EXPECT_EQ(command("view picture.png").status, 2);
  EXPECT_EQ(command("view " + recording() + " --set burr.speed_rpm=1").status, 2);
}

TEST_F(Replay, WhatRenderCannotDoIsSaid) {
  const auto expect_refused = [&](const std::string& options, const std::string& says) {
    const auto result = command("render " + recording() + ' ' + options);
    EXPECT_EQ(result.status, 2) << options;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
  };
  expect_refused("--camera above", "'above'");
  expect_refused("--camera 10,91", "AZIMUTH,ELEVATION");
  expect_refused("--camera 10,20,", "AZIMUTH,ELEVATION");
  expect_refused("--camera 10,20,2,1,1", "AZIMUTH,ELEVATION");
  expect_refused("--camera 10,20,2,1,1,nan", "AZIMUTH,ELEVATION");
  expect_refused("--camera 10,20,2,1,1,1e9", "AZIMUTH,ELEVATION");
  expect_refused("--camera buccal --camera buccal", "twice");
  expect_refused("--section q=1", "an axis and mm");
  expect_refused("--size 100", "WxH");
  expect_refused("--review r.html --at 1", "it alone");
  expect_refused("--sheet s.png --fps 1000 --size 8192x8192", "268 million");
  expect_refused("--camera occlusal --camera buccal --video v.mp4", "2 cameras");
}

}  // namespace
}  // namespace sulcus::replay_test
