#include "engine/core/error.hpp"

#include <gtest/gtest.h>

namespace sulcus::error_test {
namespace {

TEST(InputError, IsOneLineOfFilePlaceFoundExpected) {
  EXPECT_STREQ(InputError("a.toml", "line 3", "x", "y").what(),
               "a.toml: line 3: found x, expected y");
}

TEST(InputError, LeavesOutWhatThereIsNot) {
  EXPECT_STREQ(InputError("a.toml", "", "x", "y").what(), "a.toml: found x, expected y");
  EXPECT_STREQ(InputError("", "--set", "x", "y").what(), "--set: found x, expected y");
  EXPECT_STREQ(InputError("", "", "x", "y").what(), "found x, expected y");
}

TEST(InputError, IsOneShortLineWhateverTheInputHolds) {
  EXPECT_STREQ(InputError("a.toml", "k\ney", "\x1b[1m\t", "y").what(),
               "a.toml: k ey: found  [1m , expected y");
  const std::string line =
      InputError("a.toml", std::string(1000, 'k'), std::string(1000, 'x'), std::string(2000, 'y'))
          .what();
  EXPECT_EQ(line, "a.toml: " + std::string(400, 'k') + "...: found " + std::string(400, 'x') +
                      "..., expected " + std::string(1000, 'y') + "...");
  // Not within a character: of 200 that take two bytes behind one of one, the last is left out.
  std::string umlauts = "x";
  for (int i = 0; i < 300; ++i) umlauts += "\xc3\xa4";
  EXPECT_EQ(std::string(InputError("", "", umlauts, "y").what()),
            "found " + umlauts.substr(0, 399) + "..., expected y");
}

}  // namespace
}  // namespace sulcus::error_test
