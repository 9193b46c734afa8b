#include <string>

#include <gtest/gtest.h>

#include "tests/support/scene_text.hpp"

namespace sulcus::bad_scene_test {
namespace {

using test::error_of, test::least_scene;

const std::string kTissue = least_scene() + "[[tissue]]\nname = 'a'\n";

std::string times(int count, const std::string& part) {
  std::string all;
  all.reserve(part.size() * static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) all += part;
  return all;
}

TEST(BadScene, ValuesThatAreNotFinite) {
  EXPECT_EQ(
      error_of("[workpiece]\nshape = 'box'\nvoxel_mm = nan\n"),
      "/scenes/s.toml: line 3, column 12, workpiece.voxel_mm: found nan, expected 0.001 to 10");
  EXPECT_EQ(error_of(least_scene() + "hold_s = inf\n"),
            "/scenes/s.toml: line 5, column 10, trajectory.hold_s: found inf, expected 0 to 1e+06");
  EXPECT_EQ(error_of(least_scene() + "axis = [0, -inf, 1]\n"),
            "/scenes/s.toml: line 5, column 8, trajectory.axis: found -inf, expected -1e+06 to "
            "1e+06");
  EXPECT_EQ(error_of("[workpiece]\nshape = 'box'\n[trajectory]\npoints_mm = [[0, 0, nan]]\n"),
            "/scenes/s.toml: line 4, column 13, trajectory.points_mm: found nan, expected -1000 to "
            "1000");
}

TEST(BadScene, NegativeStiffnessAndAVoxelOfNoSize) {
  EXPECT_EQ(error_of(kTissue + "stiffness_N_per_mm = -30\n"),
            "/scenes/s.toml: line 7, column 22, tissue.stiffness_N_per_mm: found -30, expected "
            "1e-06 to 1e+06");
  EXPECT_EQ(error_of(least_scene() + "[coupling]\nstiffness_N_per_mm = -0.5\n"),
            "/scenes/s.toml: line 6, column 22, coupling.stiffness_N_per_mm: found -0.5, expected "
            "0.001 to 1000");
  EXPECT_EQ(error_of("[workpiece]\nshape = 'box'\nvoxel_mm = 0\n"),
            "/scenes/s.toml: line 3, column 12, workpiece.voxel_mm: found 0, expected 0.001 to 10");
}

TEST(BadScene, AMillionLevelsOfNesting) {
  constexpr int kMany = 1'000'000;
  EXPECT_EQ(error_of(std::string("a = ") + times(kMany, "[") + times(kMany, "]")),
            "/scenes/s.toml: line 1, column 21: found arrays or tables 17 levels deep, expected at "
            "most 16");
  EXPECT_EQ(error_of(times(kMany, "a={")),
            "/scenes/s.toml: line 1, column 51: found arrays or tables 17 levels deep, expected at "
            "most 16");
  EXPECT_EQ(
      error_of(std::string("a") + times(kMany, ".a") + " = 1"),
      "/scenes/s.toml: line 1, column 32: found a key of more than 16 parts, expected at most "
      "16");
  EXPECT_EQ(
      error_of(std::string("[a") + times(kMany, ".a") + "]"),
      "/scenes/s.toml: line 1, column 33: found a key of more than 16 parts, expected at most "
      "16");
}

TEST(BadScene, OverridesAreNoDeeper) {
  EXPECT_EQ(error_of(least_scene(), {std::string("a") + times(30000, ".a") + "=1"}).substr(0, 15),
            "--set a.a.a.a.a");
  EXPECT_NE(error_of(least_scene(), {std::string("a") + times(30000, ".a") + "=1"})
                .find("found a key of 30001 parts, expected TABLE.KEY=VALUE"),
            std::string::npos);
  EXPECT_EQ(error_of(least_scene(), {std::string("title=") + times(40, "[")}),
            "--set: line 1, column 17: found arrays or tables 17 levels deep, expected at most 16");
  EXPECT_EQ(error_of(least_scene(), {std::string("workpiece.file=") + times(20, "../") + "a.stl"}),
            "no error");
}

TEST(BadScene, KeysAreThereOnce) {
  EXPECT_EQ(
      error_of("title = 'a'\ntitle = 'b'\n" + least_scene()),
      "/scenes/s.toml: line 2, column 9: found text that is not valid TOML (Error while parsing "
      "key-value pair: cannot redefine existing string 'title'), expected a scene");
  EXPECT_EQ(error_of("[burr]\n[burr]\n" + least_scene()),
            "/scenes/s.toml: line 2, column 1: found text that is not valid TOML (Error while "
            "parsing table "
            "header: cannot redefine existing table 'burr'), expected a scene");
}

TEST(BadScene, NoMessageIsLongerOrMoreThanOneLine) {
  for (const std::string& text :
       {times(100000, "x") + " = 1\n" + least_scene(), "\"a\\nb\\u001b\" = 1\n" + least_scene(),
        std::string("title = 'a'\n'") + times(100000, "y") + "' = 2\n" + least_scene(),
        least_scene() + "[burr]\nshape = \"" + times(100000, "\\n") + "\"\n"}) {
    const std::string message = error_of(text);
    EXPECT_LT(message.size(), 1500u);
    EXPECT_EQ(message.find_first_of("\n\x1b"), std::string::npos) << message;
    EXPECT_NE(message.find("found "), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace sulcus::bad_scene_test
