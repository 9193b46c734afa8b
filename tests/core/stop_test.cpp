#include "engine/core/stop.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/core/whole_file.hpp"

namespace sulcus::stop_test {
namespace {

namespace fs = std::filesystem;

/// Of a death test's process: longer than any stop takes.
void wait_for_the_end() { std::this_thread::sleep_for(std::chrono::seconds(60)); }

class Stop : public testing::Test {
 protected:
  Stop() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
  // The process of a death test has another number, and so another folder, than the one that looks.
  const std::string folder_ =
      fs::temp_directory_path() /
      (std::string("sulcus_stop_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
};

TEST_F(Stop, EndsAtOnceWithTheSignalsStatusAndWithoutWhatIsNotWhole) {
  EXPECT_EXIT(
      {
        watch_for_stop();
        write_whole_file(folder_ + "/whole", "x");
        WholeFile half(folder_ + "/half");
        half.write("x");
        kill(getpid(), SIGTERM);
        wait_for_the_end();
      },
      testing::ExitedWithCode(143), "sulcus: stopped");
  EXPECT_TRUE(fs::exists(folder_ + "/whole"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
  EXPECT_EXIT(
      {
        watch_for_stop();
        kill(getpid(), SIGINT);
        wait_for_the_end();
      },
      testing::ExitedWithCode(130), "sulcus: stopped");
  EXPECT_EXIT(
      {
        std::signal(SIGHUP, SIG_DFL);
        watch_for_stop();
        kill(getpid(), SIGHUP);
        wait_for_the_end();
      },
      testing::ExitedWithCode(129), "sulcus: stopped");
}

/// A terminal that goes away tells it through its shell, and again when that has ended.
TEST_F(Stop, AHangUpIsOneHoweverOftenItIsToldAndNoneUnderNohup) {
  EXPECT_EXIT(
      {
        std::signal(SIGHUP, SIG_DFL);
        watch_for_stop();
        const EndsItself ends_itself;
        kill(getpid(), SIGHUP);
        while (!stop_requested()) std::this_thread::yield();
        kill(getpid(), SIGHUP);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        std::_Exit(stop_status() == 129 ? 7 : 8);
      },
      testing::ExitedWithCode(7), "^$");
  EXPECT_EXIT(
      {
        std::signal(SIGHUP, SIG_IGN);
        watch_for_stop();
        kill(getpid(), SIGHUP);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        std::_Exit(stop_requested() ? 8 : 7);
      },
      testing::ExitedWithCode(7), "^$");
}

TEST_F(Stop, WaitsForWhatEndsItselfButNotAfterASecondSignal) {
  EXPECT_EXIT(
      {
        watch_for_stop();
        const EndsItself ends_itself;
        kill(getpid(), SIGINT);
        while (!stop_requested()) std::this_thread::yield();
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        std::_Exit(stop_status() == 130 ? 7 : 8);
      },
      testing::ExitedWithCode(7), "^$");
  EXPECT_EXIT(
      {
        watch_for_stop();
        const EndsItself ends_itself;
        kill(getpid(), SIGINT);
        while (!stop_requested()) std::this_thread::yield();
        kill(getpid(), SIGTERM);
        wait_for_the_end();
      },
      testing::ExitedWithCode(143), "sulcus: stopped");
}

TEST_F(Stop, KillsChildren) {
  // The child would make a file if it lived on.
  EXPECT_EXIT(
      {
        watch_for_stop();
        const pid_t child = fork();
        if (child == 0) {
          std::this_thread::sleep_for(std::chrono::milliseconds(300));
          write_whole_file(folder_ + "/lived", "x");
          std::_Exit(0);
        }
        kill_when_stopped(child);
        kill(getpid(), SIGTERM);
        wait_for_the_end();
      },
      testing::ExitedWithCode(143), "sulcus: stopped");
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  EXPECT_FALSE(fs::exists(folder_ + "/lived"));
}

}  // namespace
}  // namespace sulcus::stop_test
