// Ctrl-C, SIGTERM and a terminal that goes away at three moments of every command: it ends at once
// with 130, 143 or 129 and a line, and leaves no half file.

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::stopping_test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

// It takes a tenth of that: a machine under load is slower, a command that is not stopped much
// slower still.
constexpr Seconds kBound{5.0}, kLongest{60.0};

struct Ended {
  int status = -1;  // as a shell has it
  bool stopped = false;
  bool before_main = false;  // by the system: its libraries were still being loaded
  Seconds took{};            // from the signal, or in all
  std::string err;
};

/// Starts the program in a folder; sends `signal`, where it is one, after that time.
Ended run_and_stop(const std::vector<std::string>& arguments, const std::string& folder, int signal,
                   Seconds after) {
  const std::string err = folder + "/stderr";
  const pid_t child = fork();
  if (child == 0) {
    std::vector<char*> words{const_cast<char*>("sulcus")};
    for (const std::string& argument : arguments) {
      words.push_back(const_cast<char*>(argument.c_str()));
    }
    words.push_back(nullptr);
    const int nowhere = open("/dev/null", O_RDWR);
    const int said = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(nowhere, STDIN_FILENO);
    dup2(nowhere, STDOUT_FILENO);
    dup2(said, STDERR_FILENO);
    setenv("SULCUS_CACHE", "off", 1);
    std::signal(SIGHUP, SIG_DFL);  // ignored where these tests run under nohup
    if (chdir(folder.c_str()) == 0) execv(SULCUS_PROGRAM, words.data());
    _exit(127);
  }
  Ended ended;
  auto begin = Clock::now();
  const auto has_ended = [&] {
    int status = 0;
    if (waitpid(child, &status, WNOHANG) != child) return false;
    ended.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    ended.before_main = WIFSIGNALED(status);
    ended.took = Clock::now() - begin;
    return true;
  };
  const auto wait = [&](Seconds most) {
    while (!has_ended()) {
      if (Clock::now() - begin > most) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
  };
  if (signal == 0) {
    wait(kLongest);
  } else if (!wait(after)) {
    begin = Clock::now();
    kill(child, signal);
    ended.stopped = true;
    wait(kBound);
  }
  if (ended.status < 0) {
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
  }
  ended.err = test::read_file(err);
  return ended;
}

/// A command, and the file or folder that it makes in the folder in which it runs.
struct Stopped {
  const char* name;
  std::vector<std::string> arguments;
  const char* makes;  // empty: none
};

class Stopping : public testing::TestWithParam<Stopped> {
 protected:
  static void SetUpTestSuite() {
    inputs_ = new std::string(fs::temp_directory_path() /
                              ("sulcus_stopping_" + std::to_string(getpid())));
    fs::create_directories(*inputs_);
    const auto write = [](const std::string& name, const std::string& text) {
      std::ofstream(*inputs_ + "/" + name) << text;
    };
    write("cut.toml", test::cut_scene());
    write("drawn.toml", test::cut_scene() + "[render]\nsize = [640, 480]\nfps = 500\n");
    const auto sulcus = [](const std::string& arguments) {
      const auto result = test::sulcus_command(arguments, *inputs_ + "/stderr");
      ASSERT_EQ(result.status, 0) << result.err;
    };
    // 8,800 ticks.
    sulcus("run " + *inputs_ + "/cut.toml --set trajectory.speed_mm_per_s=0.2 -o " + *inputs_ +
           "/run");
    sulcus("export " + *inputs_ + "/run/recording.h5 --volume " + *inputs_ + "/tooth.nrrd");
  }
  static void TearDownTestSuite() {
    fs::remove_all(*inputs_);
    delete inputs_;
  }
  static std::vector<std::string> arguments() {
    std::vector<std::string> words = GetParam().arguments;
    for (std::string& word : words) {
      if (word.starts_with("{}")) word.replace(0, 2, *inputs_);
    }
    return words;
  }

  static std::string* inputs_;
};

std::string* Stopping::inputs_ = nullptr;

void expect_no_part(const std::string& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    EXPECT_EQ(entry.path().filename().string().find(".part"), std::string::npos) << entry;
  }
}

TEST_P(Stopping, EndsAtOnceAndLeavesNoHalfFile) {
  const ScratchFolder scratch;
  const auto folder = [&](const std::string& name) {
    fs::create_directories(scratch.path(name));
    return scratch.path(name);
  };
  const Ended whole = run_and_stop(arguments(), folder("whole"), 0, {});
  ASSERT_EQ(whole.status, 0) << whole.err;
  const std::string makes = GetParam().makes;
  const auto size_of = [&](const std::string& in) {
    const fs::path made = fs::path(in) / makes;
    return fs::is_regular_file(made) ? fs::file_size(made) : 0;
  };
  constexpr std::array<double, 3> kMoments{0.2, 0.5, 0.8};
  constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};
  int stopped = 0;
  for (std::size_t i = 0; i < kMoments.size(); ++i) {
    const std::string here = folder(std::to_string(i));
    const Ended ended = run_and_stop(arguments(), here, kSignals[i], kMoments[i] * whole.took);
    expect_no_part(here);
    if (!ended.stopped || ended.status == 0) {  // it was faster
      EXPECT_EQ(ended.status, 0) << ended.err;
      continue;
    }
    ++stopped;
    EXPECT_EQ(ended.status, 128 + kSignals[i]) << ended.err;
    EXPECT_LT(ended.took, kBound);
    EXPECT_EQ(ended.err, ended.before_main ? "" : "sulcus: stopped\n");
    // Nothing, or all where it had just come to its end.
    if (fs::exists(here + "/" + makes) && size_of(here) > 0) {
      EXPECT_EQ(size_of(here), size_of(scratch.path("whole")));
    }
  }
  EXPECT_GT(stopped, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Each, Stopping,
    testing::Values(
        Stopped{"verify", {"replay", "--verify", "{}/run/recording.h5"}, ""},
        Stopped{"pictures",
                {"render", "{}/run/recording.h5", "--fps", "2", "--size", "320x240", "-o", "p"},
                ""},
        Stopped{"video",
                {"render", "{}/run/recording.h5", "--fps", "5", "--size", "320x240", "--video",
                 "v.mp4"},
                "v.mp4"},
        Stopped{"sheet",
                {"render", "{}/run/recording.h5", "--fps", "2", "--size", "320x240", "--sheet",
                 "s.png"},
                "s.png"},
        Stopped{"review", {"render", "{}/run/recording.h5", "--review", "r.html"}, "r.html"},
        Stopped{"mesh", {"export", "{}/run/recording.h5", "--mesh", "m.obj"}, "m.obj"},
        Stopped{"volume", {"export", "{}/run/recording.h5", "--volume", "v.nii.gz"}, "v.nii.gz"},
        Stopped{"inspect", {"inspect", "{}/tooth.nrrd", "--picture", "i.png"}, "i.png"},
        Stopped{"repair", {"repair", "{}/run/recording.h5", "-o", "r.h5"}, "r.h5"},
        Stopped{"help", {"help", "--write", "share"}, ""}),
    [](const auto& tested) { return tested.param.name; });

/// Runs and replays keep what they have.
class StoppingARun : public Stopping {};

TEST_P(StoppingARun, KeepsAndNamesItsResultsOfThatTime) {
  const ScratchFolder scratch;
  constexpr std::array<double, 3> kMoments_s{0.1, 0.4, 0.8};
  constexpr std::array<int, 3> kSignals{SIGTERM, SIGINT, SIGHUP};
  for (std::size_t i = 0; i < kMoments_s.size(); ++i) {
    const std::string folder = scratch.path(std::to_string(i));
    fs::create_directories(folder);
    const Ended ended = run_and_stop(arguments(), folder, kSignals[i], Seconds(kMoments_s[i]));
    ASSERT_TRUE(ended.stopped) << "at " << kMoments_s[i];
    EXPECT_EQ(ended.status, 128 + kSignals[i]) << ended.err;
    EXPECT_LT(ended.took, kBound);
    expect_no_part(folder);
    if (ended.before_main) continue;
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
    const std::string recording = folder + "/out/recording.h5";
    EXPECT_EQ(fs::exists(recording), fs::exists(folder + "/out/summary.json")) << ended.err;
    if (!fs::exists(recording)) {  // before the first tick
      EXPECT_EQ(ended.err, "sulcus: stopped\n");
      continue;
    }
    EXPECT_NE(ended.err.find("stopped on request after"), std::string::npos) << ended.err;
    EXPECT_EQ(RecordingReader(recording).missing(), "");
    const auto verified =
        test::sulcus_command("replay --verify " + recording, scratch.path("stderr"));
    EXPECT_EQ(verified.status, 0) << verified.err;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each, StoppingARun,
    testing::Values(
        Stopped{"run",
                {"run", "{}/cut.toml", "--set", "trajectory.speed_mm_per_s=0.01", "-o", "out"},
                ""},
        Stopped{"real_pace",
                {"run", "{}/cut.toml", "--pace", "real", "--duration", "60", "-o", "out"},
                ""},
        // Its pictures alone would take minutes.
        Stopped{"drawn",
                {"run", "{}/drawn.toml", "--set", "trajectory.speed_mm_per_s=0.05", "-o", "out"},
                ""},
        Stopped{"replay", {"replay", "{}/run/recording.h5", "--pace", "real", "-o", "out"}, ""},
        Stopped{"going_on",
                {"replay", "{}/run/recording.h5", "--from", "0.5", "--pace", "real", "-o", "out"},
                ""}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace sulcus::stopping_test
