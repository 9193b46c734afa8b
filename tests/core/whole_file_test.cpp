#include "engine/core/whole_file.hpp"

#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "engine/core/error.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::whole_file_test {
namespace {

namespace fs = std::filesystem;
using test::read_file;

std::size_t files_in(const std::string& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// Of a process of its own, which may not write longer files from then on.
bool is_told_within_1000_bytes(const std::string& path) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit most{1000, 1000};
  setrlimit(RLIMIT_FSIZE, &most);
  try {
    write_whole_file(path, std::string(2000, 'x'));
  } catch (const std::runtime_error& error) {
    return std::string(error.what()).starts_with(path + ": cannot be written: ");
  }
  return false;
}

TEST(WholeFile, IsThereOnlyOnceItIsFinished) {
  const ScratchFolder scratch;
  const std::string path = scratch.path("a.nii.gz");
  WholeFile file(path);
  EXPECT_TRUE(file.beside().ends_with("a.nii.gz"));
  EXPECT_EQ(fs::path(file.beside()).parent_path(), fs::path(path).parent_path());
  file.write("ab");
  EXPECT_FALSE(fs::exists(path));
  file.finish();
  EXPECT_EQ(read_file(path), "ab");
  EXPECT_EQ(files_in(scratch.path("")), 1u);
}

TEST(WholeFile, LeavesWhatWasThereWhereItIsNotFinished) {
  const ScratchFolder scratch;
  const std::string path = scratch.write("a.txt", "earlier");
  {
    WholeFile file(path);
    file.write("half of it");
    WholeFile moved(std::move(file));
  }
  EXPECT_EQ(read_file(path), "earlier");
  EXPECT_EQ(files_in(scratch.path("")), 1u);
  write_whole_file(path, "later");
  EXPECT_EQ(read_file(path), "later");
}

TEST(WholeFile, HasTheRightsOfAnyNewFile) {
  const ScratchFolder scratch;
  const mode_t before = umask(027);
  write_whole_file(scratch.path("a"), "x");
  umask(before);
  EXPECT_EQ(fs::status(scratch.path("a")).permissions(), fs::perms(0640));
}

TEST(WholeFile, RefusesAtOnceWhereNoneCanBe) {
  const ScratchFolder scratch;
  fs::create_directories(scratch.path("folder"));
  EXPECT_THROW(WholeFile(scratch.path("folder")), InputError);
  EXPECT_THROW(WholeFile(scratch.path("folder/")), InputError);
  EXPECT_THROW(WholeFile(scratch.path("none/a.txt")), InputError);
  EXPECT_THROW(WholeFile(""), InputError);
  EXPECT_THROW(WholeFile("/dev/null"), InputError);
  EXPECT_NO_THROW(WholeFile(scratch.path(std::string(255, 'n'))));  // ours would be longer
  EXPECT_EQ(files_in(scratch.path("")), 1u);
}

TEST(WholeFile, AFullDiskIsToldAndLeavesNothing) {
  const ScratchFolder scratch;
  const std::string path = scratch.write("a.txt", "earlier");
  EXPECT_EXIT(std::_Exit(is_told_within_1000_bytes(path) ? 0 : 1), testing::ExitedWithCode(0), "");
  EXPECT_EQ(read_file(path), "earlier");
  EXPECT_EQ(files_in(scratch.path("")), 1u);
}

}  // namespace
}  // namespace sulcus::whole_file_test
