// Of which run the files in a folder are: of one, and nothing of another is written over.
#include <csignal>
#include <filesystem>
#include <string>
#include <utility>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::results_folder_test {
namespace {

namespace fs = std::filesystem;

class ResultsFolders : public testing::Test {
 protected:
  ResultsFolders() { scratch_.write("s.toml", test::cut_scene()); }
  /// In the scratch folder, where out/ comes to be.
  test::CommandResult sulcus(const std::string& arguments) {
    return test::sulcus_command(arguments, scratch_.path("err"),
                                "-C " + scratch_.path("") + " SULCUS_CACHE=off");
  }
  test::CommandResult done(const std::string& arguments) {
    const auto result = sulcus(arguments);
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    return result;
  }
  std::string read(const std::string& file) { return test::read_file(scratch_.path(file)); }
  bool exists(const std::string& file) { return fs::exists(scratch_.path(file)); }
  /// Starts a run that lasts, and waits for its recording.
  pid_t start(const std::string& options, const std::string& recording) {
    const pid_t child = fork();
    if (child == 0) {
      const int nowhere = open("/dev/null", O_RDWR);
      for (const int stream : {0, 1, 2}) dup2(nowhere, stream);
      if (chdir(scratch_.path("").c_str()) != 0) _exit(127);
      const std::string line = std::string("exec ") + SULCUS_PROGRAM + " run s.toml " + options;
      execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      _exit(127);
    }
    for (int ms = 0; !exists(recording) && ms < 60'000; ++ms) usleep(1000);
    EXPECT_TRUE(exists(recording)) << options;
    return child;
  }
  static void end(pid_t child, int signal) {
    kill(child, signal);
    int status = 0;
    waitpid(child, &status, 0);
  }
  const ScratchFolder scratch_;
};

/// At real pace this takes 8.8 s.
const std::string kLasting = "--pace real --set trajectory.speed_mm_per_s=0.2";

TEST_F(ResultsFolders, TheSameSceneReplacesItsOwnWholeAndNothingElse) {
  done("run s.toml");
  scratch_.write("out/s/notes.txt", "mine");
  scratch_.write("out/s/frames/000099.png", "of an earlier build");
  scratch_.write("out/s/frames/mine.png", "mine");
  const std::string before = read("out/s/summary.json");
  done("run s.toml --pace real");
  EXPECT_NE(read("out/s/summary.json"), before) << "its times, if nothing else";
  EXPECT_EQ(read("out/s/notes.txt"), "mine");
  EXPECT_EQ(read("out/s/frames/mine.png"), "mine");
  EXPECT_FALSE(exists("out/s/frames/000099.png"));
  EXPECT_FALSE(exists("out/s/.unfinished"));
  EXPECT_FALSE(exists("out/s-2"));
  EXPECT_EQ(RecordingReader(scratch_.path("out/s/recording.h5")).missing(), "");
}

TEST_F(ResultsFolders, OtherSettingsTakeTheNextFreeName) {
  done("run s.toml");
  const std::string before = read("out/s/summary.json");
  const auto other = done("run s.toml --set burr.tangential_ratio=0.4");
  EXPECT_NE(other.out.find("out/s-2/summary.json\n"), std::string::npos) << other.out;
  done("run s.toml --duration 0.3");
  EXPECT_TRUE(exists("out/s-3/summary.json"));
  done("run s.toml --set burr.tangential_ratio=0.4");  // its own again
  EXPECT_FALSE(exists("out/s-4"));
  // The same words, and another scene.
  std::string changed = test::cut_scene();
  changed.replace(changed.find("0.8"), 3, "0.7");
  scratch_.write("s.toml", changed);
  done("run s.toml");
  EXPECT_TRUE(exists("out/s-4/summary.json"));
  EXPECT_EQ(read("out/s/summary.json"), before);
}

TEST_F(ResultsFolders, ASceneNamedByDotsAloneStaysInOut) {
  scratch_.write("...toml", test::cut_scene());
  done("run ./...toml");
  EXPECT_TRUE(exists("out/scene/summary.json"));
  EXPECT_FALSE(exists("summary.json"));
}

TEST_F(ResultsFolders, OneThatIsGivenAndHoldsAnotherRunIsRefusedWithoutForce) {
  done("run s.toml -o mine");
  const std::string before = read("mine/summary.json"), recording = read("mine/recording.h5");
  const auto refused = sulcus("run s.toml --set burr.tangential_ratio=0.4 -o mine");
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.err_lines(), 1) << refused.err;
  EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
  const auto replayed = sulcus("replay " + scratch_.path("mine/recording.h5") + " -o mine --force");
  EXPECT_EQ(replayed.status, 2) << "its own recording";
  EXPECT_EQ(read("mine/summary.json"), before);
  EXPECT_EQ(read("mine/recording.h5"), recording);
  scratch_.write("mine/render/review_0.439s.png", "of the other");
  scratch_.write("mine/render/mine.png", "mine");
  done("run s.toml --set burr.tangential_ratio=0.4 -o mine --force");
  EXPECT_NE(read("mine/summary.json"), before);
  EXPECT_FALSE(exists("mine/render/review_0.439s.png"));
  EXPECT_TRUE(exists("mine/render/mine.png"));
  // Results from elsewhere bear no mark, and are another's.
  scratch_.write("found/summary.json", "{}");
  EXPECT_EQ(sulcus("run s.toml -o found").status, 2);
  EXPECT_EQ(read("found/summary.json"), "{}");
  EXPECT_FALSE(exists("found/.sulcus-run"));
}

TEST_F(ResultsFolders, AKilledRunCostsNothingThatWasThere) {
  done("run s.toml " + kLasting.substr(kLasting.find("--set")));
  const std::string before = read("out/s/summary.json"), recording = read("out/s/recording.h5");
  end(start(kLasting, "out/s/.unfinished/recording.h5"), SIGKILL);
  EXPECT_EQ(read("out/s/summary.json"), before);
  EXPECT_EQ(read("out/s/recording.h5"), recording);
  done("run s.toml " + kLasting.substr(kLasting.find("--set")));
  EXPECT_FALSE(exists("out/s/.unfinished"));
  EXPECT_FALSE(exists("out/s-2"));
}

TEST_F(ResultsFolders, AStoppedRunDoesNotReplaceAWholeOne) {
  done("run s.toml " + kLasting.substr(kLasting.find("--set")));
  const std::string before = read("out/s/summary.json");
  end(start(kLasting, "out/s/.unfinished/recording.h5"), SIGINT);
  EXPECT_EQ(read("out/s/summary.json"), before);
  EXPECT_NE(read("out/s-2/summary.json").find("\"interrupted\": true"), std::string::npos);
}

TEST_F(ResultsFolders, OfTwoAtOnceOneTakesTheNextName) {
  const pid_t first = start(kLasting, "out/s/recording.h5");
  done("run s.toml");
  EXPECT_TRUE(exists("out/s-2/summary.json"));
  const auto refused = sulcus("run s.toml -o out/s --force");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("another process"), std::string::npos) << refused.err;
  end(first, SIGINT);
  EXPECT_TRUE(exists("out/s/summary.json"));
  EXPECT_EQ(RecordingReader(scratch_.path("out/s/recording.h5")).missing(), "");
}

TEST_F(ResultsFolders, AReplayIsNamedByItsRecording) {
  done("run s.toml");
  done("replay out/s/recording.h5");
  done("replay out/s/recording.h5");  // the same again
  EXPECT_TRUE(exists("out/s_replay/summary.json"));
  EXPECT_FALSE(exists("out/s_replay-2"));
  done("replay out/s/recording.h5 --from 0.2");
  done("replay out/s/recording.h5 --from 0.2");  // each like no other
  EXPECT_TRUE(exists("out/s_replay-2/summary.json"));
  EXPECT_TRUE(exists("out/s_replay-3/summary.json"));
  fs::copy_file(scratch_.path("out/s/recording.h5"), scratch_.path("patient.h5"));
  done("replay patient.h5");
  EXPECT_TRUE(exists("out/patient_replay/summary.json"));
}

TEST_F(ResultsFolders, PartsThatARunWentOnWithAreReplacedWithIt) {
  done("run s.toml -o out");
  for (const char* part : {"out/part_2", "out/part_3", "out/part_12-2", "out/party"}) {
    fs::copy(scratch_.path("out"), scratch_.path(part));
  }
  scratch_.write("out/part_3/notes.txt", "a user's");
  done("run s.toml --set haptics.rate_hz=500 --force -o out");
  EXPECT_FALSE(exists("out/part_2") || exists("out/part_12-2"));
  EXPECT_TRUE(exists("out/part_3/notes.txt"));
  EXPECT_FALSE(exists("out/part_3/recording.h5") || exists("out/part_3/.sulcus-run"));
  EXPECT_TRUE(exists("out/party/recording.h5")) << "no part's name";
  EXPECT_TRUE(exists("out/recording.h5"));
}

TEST_F(ResultsFolders, WhatCannotBeReplacedIsSaidBeforeTheRun) {
  done("run s.toml");
  const std::string recording = read("out/s/recording.h5"), key = read("out/s/.sulcus-run");
  const auto expect_refused = [&](const std::string& name) {
    const auto refused = sulcus("run s.toml");
    EXPECT_EQ(refused.status, 2) << name;
    EXPECT_EQ(refused.err_lines(), 1) << refused.err;
    EXPECT_NE(refused.err.find("out/s/" + name + ": "), std::string::npos) << refused.err;
    EXPECT_EQ(read("out/s/recording.h5"), recording);
    EXPECT_EQ(read("out/s/.sulcus-run"), key);
    EXPECT_FALSE(exists("out/s/.unfinished"));
    fs::remove_all(scratch_.path("out/s/" + name));
  };
  for (const std::string name : {"forces.png", "summary.json"}) {
    fs::remove(scratch_.path("out/s/" + name));
    scratch_.write("out/s/" + name + "/notes.txt", "mine");
    expect_refused(name);
  }
  scratch_.write("out/s/frames", "mine");
  expect_refused("frames");
  done("run s.toml");
  EXPECT_TRUE(exists("out/s/summary.json"));
}

TEST_F(ResultsFolders, ALogThatIsNoRegularFileIsRefused) {
  const auto expect_refused = [&](const std::string& what) {
    const auto refused = sulcus("run s.toml -o mine");
    EXPECT_EQ(refused.status, 2) << what;
    EXPECT_EQ(refused.err_lines(), 1) << refused.err;
    EXPECT_NE(refused.err.find("mine/log.txt: found no regular file"), std::string::npos)
        << refused.err;
    fs::remove(scratch_.path("mine/log.txt"));
  };
  const std::string log = scratch_.path("mine/log.txt");
  fs::create_directory(scratch_.path("mine"));
  ASSERT_EQ(mkfifo(log.c_str(), 0600), 0);
  expect_refused("a pipe that nobody reads");
  ASSERT_EQ(mkfifo(log.c_str(), 0600), 0);
  const int reader = open(log.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  expect_refused("a pipe");
  close(reader);
  fs::create_symlink(scratch_.path("elsewhere"), log);
  expect_refused("a link to nothing");
  EXPECT_FALSE(exists("elsewhere"));
  scratch_.write("elsewhere", "mine");
  fs::create_symlink(scratch_.path("elsewhere"), log);
  done("run s.toml -o mine");  // the link is a result of the same run, and replaced
  EXPECT_EQ(read("elsewhere"), "mine");
}

TEST_F(ResultsFolders, AnAssessmentReplacesItsOwnAlone) {
  for (const auto& [who, deep] : {std::pair{"anna", "0.7"}, {"bert", "0.6"}}) {
    std::string scene = test::cut_scene() + "[assessment]\ndepth_mm = 5\n";
    for (auto at = scene.find("0.92"); at != std::string::npos; at = scene.find("0.92")) {
      scene.replace(at, 4, deep);
    }
    scratch_.write("deep.toml", scene);
    done(std::string("run deep.toml -o ") + who + "/prep");
  }
  const std::string file = "out/prep-assessment/assessment.json";
  done("assess anna/prep --no-render");
  const std::string of_anna = read(file);
  scratch_.write("out/prep-assessment/depth_mm.png", "of that");
  const auto other = done("assess bert/prep --no-render");
  EXPECT_NE(other.out.find("out/prep-assessment-2/assessment.json\n"), std::string::npos);
  EXPECT_EQ(read(file), of_anna);
  EXPECT_TRUE(exists("out/prep-assessment/depth_mm.png"));
  done("assess anna/prep --no-render");
  EXPECT_EQ(read(file), of_anna);
  EXPECT_FALSE(exists("out/prep-assessment/depth_mm.png")) << "of the one that is replaced";
  EXPECT_FALSE(exists("out/prep-assessment/.unfinished-assessment"));
  EXPECT_FALSE(exists("out/prep-assessment-3"));
  scratch_.write("other.toml", "[assessment]\ndepth_mm = 4\n");
  done("assess anna/prep --no-render --assessment other.toml");  // by other limits
  EXPECT_TRUE(exists("out/prep-assessment-3/assessment.json"));

  const std::string given = "assess bert/prep --no-render -o out/prep-assessment";
  const auto refused = sulcus(given);
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.err_lines(), 1) << refused.err;
  EXPECT_NE(refused.err.find("another assessment"), std::string::npos) << refused.err;
  EXPECT_EQ(read(file), of_anna);
  done(given + " --force");
  EXPECT_NE(read(file), of_anna);
}

TEST_F(ResultsFolders, AnAssessmentLeavesTheRunBesideItAlone) {
  std::string scene = test::cut_scene() + "[assessment]\ndepth_mm = 5\n";
  for (auto at = scene.find("0.92"); at != std::string::npos; at = scene.find("0.92")) {
    scene.replace(at, 4, "0.7");
  }
  scratch_.write("deep.toml", scene);
  done("run deep.toml -o mine");
  const std::string recording = read("mine/recording.h5");
  done("assess mine mine --no-render -o mine");
  EXPECT_TRUE(exists("mine/2/assessment.json"));
  done("assess mine --no-render --force -o mine");
  EXPECT_TRUE(exists("mine/assessment.json"));
  EXPECT_FALSE(exists("mine/assessment.csv"));
  EXPECT_FALSE(exists("mine/2")) << "of the one that is replaced";
  EXPECT_EQ(read("mine/recording.h5"), recording);
  done("run deep.toml -o mine");
  EXPECT_TRUE(exists("mine/assessment.json"));
}

TEST_F(ResultsFolders, PicturesAreNamedByWhatTheyShow) {
  done("run s.toml");
  const std::string render = "render out/s/recording.h5 --size 64x48 --at 0.25 ";
  done(render + "--camera occlusal --camera -80,20");
  EXPECT_TRUE(exists("out/s/render/occlusal_0.250s.png"));
  EXPECT_TRUE(exists("out/s/render/-80_20_0.250s.png"));
  const std::string before = read("out/s/render/occlusal_0.250s.png");
  done(render + "--camera occlusal");  // the same picture
  EXPECT_FALSE(exists("out/s/render/occlusal_0.250s-2.png"));
  const auto other = done("render out/s/recording.h5 --size 96x64 --at 0.25 --camera occlusal");
  EXPECT_NE(other.out.find("occlusal_0.250s-2.png"), std::string::npos) << other.out;
  EXPECT_EQ(read("out/s/render/occlusal_0.250s.png"), before);
  done(render + "--colour-by time --section y=0.5");
  EXPECT_TRUE(exists("out/s/render/review_0.250s_by_time_y=0.5.png"));
  done("render out/s/recording.h5 --size 64x48 --fps 10 -o film");
  for (const char* name : {"review_0.000s.png", "review_0.100s.png", "review_0.400s.png"}) {
    EXPECT_TRUE(exists(std::string("film/") + name)) << name;
  }
}

}  // namespace
}  // namespace sulcus::results_folder_test
