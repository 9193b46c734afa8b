// The disk is full under every file that the program writes: one line that names the file and the
// reason, status 1, no half file, and what bore the name before is still there.

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::full_disk_test {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;

constexpr const char* kOld = "what was there before";
constexpr const char* kSmallScene = R"([render]
size = [640, 480]
fps = 4
)";

/// A file that a command writes.
struct Written {
  const char* name;       // of the test
  const char* arguments;  // {}: where the file lies, {in}: where the inputs do
  const char* file;
  int room;  // bytes that there are for it: less than it takes
};

class FullDisk : public testing::TestWithParam<Written> {
 protected:
  static void SetUpTestSuite() {
    inputs_ =
        new std::string(fs::temp_directory_path() / ("sulcus_full_" + std::to_string(getpid())));
    fs::create_directories(*inputs_);
    const auto write = [](const std::string& name, const std::string& text) {
      std::ofstream(*inputs_ + "/" + name) << text;
    };
    write("probe.toml", test::probe_scene());
    write("cut.toml", test::cut_scene());
    write("drawn.toml", test::probe_scene() + kSmallScene);
    const std::string err = *inputs_ + "/stderr";
    ASSERT_EQ(
        test::sulcus_command("run " + *inputs_ + "/cut.toml -o " + *inputs_ + "/run", err).status,
        0);
    ASSERT_EQ(
        test::sulcus_command(
            "export " + *inputs_ + "/run/recording.h5 --volume " + *inputs_ + "/tooth.nrrd", err)
            .status,
        0);
  }
  static void TearDownTestSuite() {
    fs::remove_all(*inputs_);
    delete inputs_;
  }

  static std::string put_in(std::string text, const std::string& mark, const std::string& path) {
    for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark)) {
      text.replace(at, mark.size(), path);
    }
    return text;
  }
  static std::string arguments(const std::string& folder) {
    return put_in(put_in(GetParam().arguments, "{in}", *inputs_), "{}", folder);
  }
  /// repair, and pictures, write over nothing.
  static bool has_old() {
    const std::string name = GetParam().name;
    return name != "repair" && name != "picture";
  }
  static void expect_told(const CommandResult& result, const std::string& reason) {
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_NE(result.err.find(GetParam().file), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(reason), std::string::npos) << result.err;
    EXPECT_EQ(result.err.find(".part"), std::string::npos) << result.err;
  }

  static std::string* inputs_;
  ScratchFolder scratch_;
};

std::string* FullDisk::inputs_ = nullptr;

TEST_P(FullDisk, OfAFileThatMayNotGrow) {
  const std::string old = scratch_.path(GetParam().file);
  if (has_old()) scratch_.write(GetParam().file, kOld);
  const CommandResult result =
      test::sulcus_command(arguments(scratch_.path("")), scratch_.path("stderr"),
                           "SULCUS_CACHE=off prlimit --fsize=" + std::to_string(GetParam().room));
  expect_told(result, "File too large");
  EXPECT_EQ(fs::exists(old), has_old());
  EXPECT_TRUE(test::read_file(old) == (has_old() ? kOld : ""));
  for (const auto& entry : fs::recursive_directory_iterator(scratch_.path(""))) {
    EXPECT_EQ(entry.path().filename().string().find(".part"), std::string::npos) << entry;
  }
}

/// Where a disk of our own may be mounted.
TEST_P(FullDisk, OfADiskWithoutRoom) {
  const std::string disk = scratch_.path("disk");
  fs::create_directories(disk);
  const std::string inside = "unshare -rm sh -c 'mount -t tmpfs -o size=4m none " + disk + "'";
  if (std::system((inside + " 2>/dev/null").c_str()) != 0) return;
  const std::string file = disk + "/" + GetParam().file;
  constexpr int kPage = 4096;
  const std::string room = std::to_string(GetParam().room / kPage * kPage);
  std::string script = "cd " + disk + "\nmount -t tmpfs -o size=4m none .\ncd " + disk +
                       "\nmkdir -p " + fs::path(file).parent_path().string() + "\n";
  if (has_old()) script += std::string("printf '") + kOld + "' >" + file + "\n";
  script +=
      "head -c " + room + " /dev/zero >room\nhead -c 8m /dev/zero >rest 2>/dev/null\nrm room\n";
  script += std::string("SULCUS_CACHE=off ") + SULCUS_PROGRAM + " " + arguments(disk + "/") +
            " >/dev/null\nstatus=$?\n";
  script += "find . -name '.part*'\ncat " + file + " 2>/dev/null\nexit $status\n";
  const CommandResult result = test::program_command(
      "unshare", "-rm sh " + scratch_.write("script", script), scratch_.path("stderr"));
  expect_told(result, "No space left on device");
  EXPECT_TRUE(result.out == (has_old() ? kOld : ""));
}

INSTANTIATE_TEST_SUITE_P(
    Under, FullDisk,
    testing::Values(
        Written{"stl", "export {in}/run/recording.h5 --mesh {}x.stl", "x.stl", 8192},
        Written{"ply", "export {in}/run/recording.h5 --mesh {}x.ply", "x.ply", 8192},
        Written{"obj", "export {in}/run/recording.h5 --mesh {}x.obj", "x.obj", 8192},
        Written{"tissue", "export {in}/run/recording.h5 --mesh {}x.stl --per-tissue",
                "x_enamel.stl", 8192},
        Written{"nrrd", "export {in}/run/recording.h5 --volume {}x.nrrd", "x.nrrd", 512},
        Written{"mha", "export {in}/run/recording.h5 --volume {}x.mha", "x.mha", 512},
        Written{"nifti", "export {in}/run/recording.h5 --volume {}x.nii.gz", "x.nii.gz", 512},
        Written{"csv", "export {in}/run/recording.h5 --csv {}x.csv", "x.csv", 8192},
        Written{"glb", "export {in}/run/recording.h5 --mesh {}x.glb", "x.glb", 8192},
        Written{"path", "export {in}/run/recording.h5 --path {}x.vtk", "x.vtk", 8192},
        Written{"sound", "export {in}/run/recording.h5 --sound {}x.wav", "x.wav", 8192},
        Written{"images", "render {in}/run/recording.h5 --size 320x240 --fps 20 --data {}x.h5",
                "x.h5", 8192},
        Written{"summary", "run {in}/probe.toml --force -o {}", "summary.json", 1024},
        Written{"chart", "run {in}/probe.toml --force -o {}", "forces.png", 32768},
        Written{"new_recording", "run {in}/cut.toml --force -o {}", "recording.h5", 2048},
        Written{"repair", "repair {in}/run/recording.h5 -o {}x.h5", "x.h5", 8192},
        Written{"picture", "render {in}/run/recording.h5 --size 320x240 --at 0.1 -o {}",
                "review_0.100s.png", 8192},
        Written{"sheet", "render {in}/run/recording.h5 --size 320x240 --sheet {}x.png", "x.png",
                8192},
        Written{"video", "render {in}/run/recording.h5 --size 320x240 --fps 20 --video {}x.mp4",
                "x.mp4", 4096},
        Written{"review", "render {in}/run/recording.h5 --review {}x.html", "x.html", 65536},
        Written{"inspected", "inspect {in}/tooth.nrrd --picture {}x.png", "x.png", 8192},
        Written{"manual", "help --write {}", "man/man1/sulcus.1", 1024}),
    [](const auto& tested) { return tested.param.name; });

class FullDiskOfARun : public testing::Test {
 protected:
  CommandResult run(const std::string& scene, int room, const std::string& options = "") {
    scratch_.write("scene.toml", scene);
    return test::sulcus_command(
        "run " + scratch_.path("scene.toml") + options + " -o " + scratch_.path("out"),
        scratch_.path("stderr"), "SULCUS_CACHE=off prlimit --fsize=" + std::to_string(room));
  }
  ScratchFolder scratch_;
};

TEST_F(FullDiskOfARun, ItsRecordingKeepsWhatItHolds) {
  // Slower, and as fast as the clock: room for the start and what is flushed of the first ticks.
  std::string scene = test::cut_scene();
  scene.replace(scene.find("speed_mm_per_s = 4"), 18, "speed_mm_per_s = 1");
  const CommandResult result = run(scene, 400 * 1024, " --pace real");
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_NE(result.err.find("recording.h5"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("File too large"), std::string::npos) << result.err;
  const std::string log = test::read_file(scratch_.path("out/log.txt"));
  EXPECT_NE(log.find("the recording ends before the run: "), std::string::npos) << log;
  const auto summary = nlohmann::json::parse(test::read_file(scratch_.path("out/summary.json")));
  const CommandResult verified = test::sulcus_command(
      "replay --verify " + scratch_.path("out/recording.h5"), scratch_.path("stderr"));
  EXPECT_EQ(verified.status, 0) << verified.err;
  EXPECT_NE(verified.err.find("recording ends at tick"), std::string::npos) << verified.err;
  EXPECT_GT(summary["ticks"], 0);
}

TEST_F(FullDiskOfARun, AFrameThatCannotBeWrittenIsTold) {
  const CommandResult result =
      run(test::probe_scene() + "[render]\nsize = [1280, 720]\nfps = 4\n", 150 * 1024);
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_NE(result.err.find("frames/000000.png"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::is_empty(scratch_.path("out/frames")));
  EXPECT_TRUE(fs::exists(scratch_.path("out/summary.json")));
}

TEST_F(FullDiskOfARun, WhatIsSaidIsWhole) {
  for (const char* arguments :
       {"help scene", "--help", "inspect " SULCUS_SOURCE_DIR "/scenes/minimal.toml"}) {
    const CommandResult result =
        test::sulcus_command(std::string(arguments) + " >/dev/full", scratch_.path("stderr"));
    EXPECT_EQ(result.status, 1) << arguments;
    EXPECT_EQ(result.err, "sulcus: standard output: cannot be written\n");
    // Who closes a pipe has had enough of it.
    const CommandResult closed =
        test::sulcus_command(std::string(arguments) + " | true", scratch_.path("stderr"));
    EXPECT_EQ(closed.err, "");
  }
}

TEST_F(FullDiskOfARun, ALogThatCannotBeWrittenIsTold) {
  const std::string scene = scratch_.write("scene.toml", test::probe_scene());
  const CommandResult result = test::sulcus_command(
      "run " + scene + " -o " + scratch_.path("out"), scratch_.path("stderr"),
      "SULCUS_CACHE=off SULCUS_FULL=log.txt ASAN_OPTIONS=verify_asan_link_order=0"
      " LD_PRELOAD=" SULCUS_STALLING_DISK);
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_NE(result.err.find("log.txt"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("No space left on device"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace sulcus::full_disk_test
