#include <string>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/scene/toml_table.hpp"

namespace sulcus::toml_depth_test {
namespace {

std::string error_of(const std::string& text) {
  try {
    check_toml_depth(text, "f.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string times(int count, const std::string& part) {
  std::string all;
  for (int i = 0; i < count; ++i) all += part;
  return all;
}

TEST(TomlDepth, SixteenLevelsAndPartsAreEnough) {
  EXPECT_EQ(error_of(std::string("a = ") + times(16, "[") + times(16, "]")), "");
  EXPECT_EQ(
      error_of(std::string("a = ") + times(17, "[")),
      "f.toml: line 1, column 21: found arrays or tables 17 levels deep, expected at most 16");
  EXPECT_EQ(error_of(std::string("\nb = 1\na") + times(15, ".a") + " = 1"), "");
  EXPECT_EQ(error_of(std::string("\nb = 1\na") + times(16, ".a") + " = 1"),
            "f.toml: line 3, column 32: found a key of more than 16 parts, expected at most 16");
  EXPECT_EQ(error_of(std::string("[") + times(16, "a.") + "a]").substr(0, 24),
            "f.toml: line 1, column 3");
}

TEST(TomlDepth, LevelsThatAreLeftDoNotCount) {
  EXPECT_EQ(error_of(std::string("p = [") + times(1000, "[0.5, 1.5, 2.5],\n") + "]"), "");
  EXPECT_EQ(error_of(times(1000, "[a.b]\nc.d = 1.5\n")), "");
}

TEST(TomlDepth, TextsAndCommentsHoldAnything) {
  const std::string deep = times(40, "[") + times(40, ".x");
  EXPECT_EQ(error_of("# " + deep + "\na = 1"), "");
  EXPECT_EQ(error_of("a = \"" + deep + "\"\nb = '" + deep + "'"), "");
  EXPECT_EQ(error_of("a = \"\\\"" + deep + "\""), "");
  EXPECT_EQ(error_of("a = \"\"\"\n\"" + deep + "\n" + deep + "\"\"\"\"\nb = 1"), "");
  EXPECT_EQ(error_of("a = '''\n'" + deep + "\\'''\nb = 1"), "");
  EXPECT_EQ(error_of("a = '''" + deep), "") << "not closed: that is told by who reads it";
  EXPECT_NE(error_of("a = \"\"\nb = " + deep), "");
  EXPECT_NE(error_of("a = '\nb = " + deep), "") << "a line ends what is not closed";
  EXPECT_NE(error_of(times(17, "\".\".")), "") << "a key in quotes is a part";
}

}  // namespace
}  // namespace sulcus::toml_depth_test
