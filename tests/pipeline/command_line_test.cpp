// What a command is asked for is looked at before its work: names and folders of what it is to
// write, times, planes. And what names of recordings and videos may be.

#include <cstring>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <utility>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/png_file.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::command_line_test {
namespace {

namespace fs = std::filesystem;

class CommandLine : public testing::Test {
 protected:
  /// In the scratch folder.
  test::CommandResult command(const std::string& arguments) {
    return test::sulcus_command(arguments, scratch_.path("err"),
                                "-C " + scratch_.path("") + " SULCUS_CACHE=off");
  }
  void record() {
    scratch_.write("s.toml", test::cut_scene());
    const auto result = command("run s.toml -o run");
    ASSERT_EQ(result.status, 0) << result.err;
  }
  void expect_refused(const std::string& arguments, const std::string& says) {
    const auto result = command(arguments);
    EXPECT_EQ(result.status, 2) << arguments << ": " << result.err;
    EXPECT_EQ(result.err_lines(), 1) << arguments << ": " << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << arguments << ": " << result.err;
    EXPECT_EQ(result.out, "") << arguments;
  }
  ScratchFolder scratch_;
};

TEST_F(CommandLine, WhatIsSaidGoesIntoNoFileWhereTheStreamsAreClosed) {
  scratch_.write("s.toml", test::cut_scene());
  // It is warned of that nothing is touched.
  const std::string run = std::string(SULCUS_PROGRAM) + " run s.toml --duration 0.01 -o ";
  ASSERT_EQ(command("run s.toml --duration 0.01 -o open").status, 0);
  const std::string key = test::read_file(scratch_.path("open/.sulcus-run"));
  ASSERT_NE(test::read_file(scratch_.path("open/log.txt")).find("[warning]"), std::string::npos);
  int number = 0;
  for (const char* closed : {"2>&-", "1>&- 2>&-", "0<&- 1>&- 2>&-"}) {
    const std::string folder = "closed_" + std::to_string(++number);
    const auto result = test::program_command("sh", "-c 'exec " + run + folder + " " + closed + "'",
                                              scratch_.path("err"),
                                              "-C " + scratch_.path("") + " SULCUS_CACHE=off");
    EXPECT_EQ(result.status, 0) << closed;
    EXPECT_EQ(test::read_file(scratch_.path(folder + "/.sulcus-run")), key) << closed;
    const std::string recording = scratch_.path(folder + "/recording.h5");
    EXPECT_EQ(RecordingReader(recording).missing(), "") << closed;
    EXPECT_EQ(test::read_file(recording).find("sulcus: "), std::string::npos) << closed;
  }
}

TEST_F(CommandLine, NamesAreLookedAtBeforeTheRecordingIs) {
  for (const auto& [command, option, endings] :
       {std::tuple{"render", "--video", ".mp4, .mov, .mkv or .avi"},
        {"render", "--sheet", "expected .png"},
        {"render", "--review", ".html or .htm"},
        {"export", "--mesh", ".stl, .obj, .ply or .glb"},
        {"export", "--volume", ".nrrd, .mha or .nii.gz"},
        {"export", "--csv", "expected .csv"},
        {"repair", "-o", ".h5 or .hdf5"}}) {
    const std::string start = std::string(command) + " there_is_none.h5 " + option + " ";
    expect_refused(start + "x.jpg", endings);
    expect_refused(start + "x.jpg", option);
    // Any of them, in a folder that is not there.
    const std::string all = endings;
    const auto dot = all.find('.');
    const std::string ending = all.substr(dot, all.find_first_of(", ", dot) - dot);
    expect_refused(start + "no/x" + ending, "no folder no");
  }
  scratch_.write("volume.nrrd", "x");
  expect_refused("inspect volume.nrrd --picture x.jpg", "expected .png");
  expect_refused("inspect volume.nrrd --picture no/x.png", "no folder no");
  scratch_.write("file", "x");
  for (const char* arguments :
       {"run nothing.toml -o file/out", "replay nothing.h5 -o file/out",
        "render nothing.h5 -o file/out", "view nothing.h5 -o file/out", "help --write file/out"}) {
    expect_refused(arguments, "no folder that can be written");
  }
}

/// As of a variable of a script that was not set.
TEST_F(CommandLine, AnEmptyNameIsNotTakenForNone) {
  scratch_.write("s.toml", test::cut_scene());
  for (const char* arguments :
       {"run s.toml -o ''", "replay nothing.h5 -o ''", "render nothing.h5 -o ''",
        "assess nothing.h5 -o ''", "export nothing.h5 --csv x.csv --mesh ''"}) {
    expect_refused(arguments, "found no name");
  }
  EXPECT_FALSE(fs::exists(scratch_.path("out")));
}

TEST_F(CommandLine, NoTwoOutputsAreOneFile) {
  std::filesystem::create_directory(scratch_.path("in"));
  for (const char* arguments :
       {"--volume x.nrrd --fills x.nrrd", "--mesh x.ply --path x.ply",
        "--volume x.mha --fills ./x.mha", "--volume x.mha --fills in/../x.mha"}) {
    expect_refused(std::string("export there_is_none.h5 ") + arguments, "the file of --");
  }
  record();
  const std::string tissues = "export run/recording.h5 --mesh x.ply --per-tissue --path ";
  expect_refused(tissues + "x_enamel.ply", "the file of --path");
  EXPECT_EQ(command(tissues + "x.ply").status, 0) << "which no tissue's is";
}

TEST_F(CommandLine, TimesAndPlanesThatAreNotThereAreRefusedWithThoseThatAre) {
  record();
  const std::string render = "render run/recording.h5 --size 64x48 ";
  for (const std::string time : {"100", "-1", "nan", "inf", "0.45"}) {
    expect_refused(render + "--at " + time, "expected 0 to 0.44 s");
    expect_refused("export run/recording.h5 --csv x.csv --at " + time, "expected 0 to 0.44 s");
    expect_refused("replay run/recording.h5 --from " + time, "expected 0 to 0.44 s");
    expect_refused("replay run/recording.h5 --verify --from " + time, "expected 0 to 0.44 s");
  }
  // A run of 440 ticks is over at 0.44 s.
  EXPECT_EQ(command("export run/recording.h5 --csv x.csv --at 0.44").status, 0);
  EXPECT_EQ(command("export run/recording.h5 --csv x.csv --at 0").status, 0);
  for (const std::string plane : {"y=99", "y=-99", "z=1.01", "x=-1.01"}) {
    expect_refused(render + "--section " + plane, "=-1 to 1, where there is something to cut open");
  }
  EXPECT_EQ(command(render + "--section y=0.9 --sheet x.png").status, 0);
}

TEST_F(CommandLine, ColoursKeepTheirScaleWithoutFigures) {
  record();
  const auto left_edge = [&](const std::string& options) {
    const auto result =
        command("render run/recording.h5 --no-hud --size 640x480 --sheet x.png " + options);
    EXPECT_EQ(result.status, 0) << result.err;
    const Image image = test::read_png(scratch_.path("x.png"));
    std::vector<std::uint8_t> edge;
    for (int y = 0; y < image.height; ++y) {
      const auto row = image.rgb.begin() + 3 * std::ptrdiff_t{y} * image.width;
      edge.insert(edge.end(), row, row + 3 * 40);
    }
    return edge;
  };
  const auto plain = left_edge("");
  EXPECT_NE(left_edge("--colour-by time"), plain);
  EXPECT_NE(left_edge("--contacts --at 0.2"), plain);
}

TEST_F(CommandLine, AVideoMayBeCalledWhatItsWriterTakesForAnotherThing) {
  record();
  for (const std::string name : {"10:03.mp4", "./-x.mp4", "-x.mp4", "pipe:1.mp4", "a%03d.mov"}) {
    const auto result =
        command("render run/recording.h5 --size 64x48 --fps 20 '--video=" + name + "'");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_GT(fs::file_size(scratch_.path(name)), 500u) << name;
    EXPECT_EQ(result.out, name + "\n");
  }
}

TEST_F(CommandLine, ARecordingIsOneByAnyOfItsEndings) {
  record();
  for (const std::string name : {"a.H5", "a.hdf5", "a.HDF5"}) {
    fs::copy_file(scratch_.path("run/recording.h5"), scratch_.path(name));
    const auto result = command("inspect " + name);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("440"), std::string::npos) << result.out;
    EXPECT_EQ(command("repair " + name + " -o again_" + name).status, 0);
    EXPECT_EQ(command("replay --verify again_" + name).status, 0);
  }
}

TEST_F(CommandLine, ARecordingThatAnotherProgramPackedIsRead) {
  if (std::system("/usr/bin/python3 -c 'import h5py' 2>/dev/null") != 0) {
    FAIL() << "h5py is not installed";
  }
  record();
  // h5py writes HDF5's oldest format, as h5repack does.
  scratch_.write("pack.py", R"(import h5py, numpy
def copy_attributes(old, new):
    for name in old.attrs:
        a = h5py.h5a.open(old.id, name.encode())
        b = h5py.h5a.create(new.id, name.encode(), a.get_type(), a.get_space())
        values = numpy.empty(a.shape, dtype=a.dtype)
        a.read(values)
        b.write(values)
def pack(old, name, **options):
    new = h5py.File(name, "w")
    copy_attributes(old, new)
    def visit(name, part):
        if isinstance(part, h5py.Group):
            made = new.create_group(name)
        elif part.size == 0 or part.shape == ():
            made = new.create_dataset(name, shape=part.shape, dtype=part.dtype, data=part[()])
        else:
            made = new.create_dataset(name, dtype=part.dtype, data=part[()], **options)
        copy_attributes(part, made)
    old.visititems(visit)
    new.close()
old = h5py.File("run/recording.h5", "r")
pack(old, "gzip.h5", compression="gzip", shuffle=True, fletcher32=True)
pack(old, "one_piece.h5")
pack(old, "small_chunks.h5", compression="gzip", chunks=True)
pack(old, "lzf.h5", compression="lzf")
)");
  const auto packed = test::program_command("/usr/bin/python3", "pack.py", scratch_.path("err"),
                                            "-C " + scratch_.path(""));
  ASSERT_EQ(packed.status, 0) << packed.err;
  for (const std::string name : {"gzip.h5", "one_piece.h5", "small_chunks.h5"}) {
    const auto verified = command("replay --verify " + name);
    EXPECT_EQ(verified.status, 0) << name << ": " << verified.err;
    EXPECT_EQ(verified.err, "");
    EXPECT_NE(verified.out.find("440 ticks"), std::string::npos) << verified.out;
  }
  expect_refused("inspect lzf.h5", "packed by lzf");
  EXPECT_EQ(test::read_file(scratch_.path("err")).find("damaged"), std::string::npos);
}

TEST_F(CommandLine, WhatWasMeantIsNamed) {
  expect_refused("expert x.h5",
                 "no command 'expert': run, replay, render, view, export, assess, inspect, "
                 "repair, help (see sulcus --help)");
  expect_refused("--verbose", "no option '--verbose' of the program (see sulcus --help)");
  expect_refused("render --size", "(see sulcus render --help)");
  expect_refused("run", "(see sulcus run --help)");
}

TEST_F(CommandLine, ProgressIsToldOnATerminalAlone) {
  scratch_.write("s.toml", test::probe_scene());
  // Lasts until it is stopped.
  const std::string run = "run " + scratch_.path("s.toml") +
                          " --set trajectory.speed_mm_per_s=0.001 --no-cache -o " +
                          scratch_.path("out");
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", (std::string("exec " SULCUS_PROGRAM " ") + run).c_str(), nullptr);
    _exit(127);
  }
  std::string said;
  char buffer[256];
  const std::regex progress("running [0-9]+ %");
  while (!std::regex_search(said, progress)) {
    const ssize_t n = read(terminal, buffer, sizeof buffer);
    if (n <= 0) break;
    said.append(buffer, static_cast<std::size_t>(n));
  }
  kill(child, SIGINT);
  for (ssize_t n; (n = read(terminal, buffer, sizeof buffer)) > 0;) {
    said.append(buffer, static_cast<std::size_t>(n));
  }
  int status = 0;
  waitpid(child, &status, 0);
  close(terminal);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 130) << status;
  EXPECT_TRUE(std::regex_search(said, progress)) << said;
  // It is gone before anything else is said.
  const auto last = said.rfind(" %");
  EXPECT_EQ(said.compare(last + 2, 4, "\r\033[K"), 0) << said;
}

}  // namespace
}  // namespace sulcus::command_line_test
