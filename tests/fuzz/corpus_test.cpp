#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/fuzz/fuzz_targets.hpp"
#include "tools/fuzz/handed_file.hpp"

namespace sulcus::fuzz::corpus_test {
namespace {

namespace fs = std::filesystem;

/// The seeds of a target, and what was once a finding: those begin with "found_".
std::vector<fs::path> corpus_of(const std::string& target) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(SULCUS_SOURCE_DIR "/tests/fuzz/" + target)) {
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

class Corpus : public testing::TestWithParam<FuzzTarget> {};

TEST_P(Corpus, IsReadOrRefusedInOneLine) {
  const std::vector<fs::path> files = corpus_of(GetParam().name);
  ASSERT_GE(files.size(), 5u);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.filename());
    std::ifstream in(file, std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(in), {});
    testing::internal::CaptureStderr();  // the program says its line, and the libraries nothing
    EXPECT_NO_THROW(
        GetParam().run({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  }
}

INSTANTIATE_TEST_SUITE_P(FuzzTargets, Corpus, testing::ValuesIn(kFuzzTargets),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(HandedFile, IsThereAsLongAsItIsHeld) {
  std::string path;
  {
    const std::vector<std::uint8_t> bytes{1, 2, 3};
    const HandedFile file(bytes, "three");
    path = file.path();
    EXPECT_EQ(fs::file_size(path), 3u);
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(Reads, TellsRefusalsFromFindings) {
  EXPECT_TRUE(reads([] {}));
  EXPECT_FALSE(reads([] { throw InputError("f", "", "x", "y"); }));
  EXPECT_THROW(reads([] { throw std::out_of_range("x"); }), std::out_of_range);
  EXPECT_THROW(reads([] { throw InputError(std::string(3000, 'f'), "", "x", "y"); }),
               std::logic_error);
}

}  // namespace
}  // namespace sulcus::fuzz::corpus_test
