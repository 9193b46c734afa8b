#include "engine/core/error.hpp"

#include <gtest/gtest.h>

namespace sulcus {
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

}  // namespace
}  // namespace sulcus
