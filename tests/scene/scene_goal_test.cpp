#include <string>

#include <gtest/gtest.h>

#include "engine/scene/scene_file.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus::scene_goal_test {
namespace {

using Eigen::Vector3d;
using test::error_of, test::least_scene, test::parse;

/// The least scene with a [goal] of these keys, on lines from 7 on.
std::string with_goal(const std::string& keys) {
  return least_scene() + "[cutting]\n[goal]\n" + keys;
}

TEST(GoalOfAScene, AGoalIsABoxOrACylinder) {
  EXPECT_FALSE(parse(least_scene() + "[cutting]\n").goal);
  const GoalSettings box = *parse(with_goal("shape = 'box'\nsize_mm = [4, 2, 6]\ntaper_deg = -3\n"
                                            "position_mm = [1, -2, 3]\n"
                                            "rotation_deg = [0, 90, 180]\n"))
                                .goal;
  EXPECT_EQ(box.shape, GoalShape::kBox);
  EXPECT_TRUE(box.size_m.isApprox(Vector3d(4e-3, 2e-3, 6e-3), 1e-14));
  EXPECT_TRUE(box.position_m.isApprox(Vector3d(1e-3, -2e-3, 3e-3), 1e-14));
  EXPECT_DOUBLE_EQ(box.taper, -3 * 3.141592653589793 / 180);
  EXPECT_TRUE(box.rotation.isApprox(Vector3d(0, 0.5, 1) * 3.141592653589793, 1e-14));
  const GoalSettings cylinder =
      *parse(with_goal("shape = 'cylinder'\ndiameter_mm = 2\ndepth_mm = 3\n")).goal;
  EXPECT_EQ(cylinder.shape, GoalShape::kCylinder);
  EXPECT_DOUBLE_EQ(cylinder.diameter_m, 2e-3);
  EXPECT_DOUBLE_EQ(cylinder.depth_m, 3e-3);
  EXPECT_EQ(cylinder.taper, 0.0);
}

TEST(GoalOfAScene, ADistanceToThePulpStandsAloneOrBesideACavity) {
  const std::string tissues = "tissue = ['dentine', 'pulp']\n";
  const Scene alone = parse(tissues + with_goal("pulp_distance_mm = 0.5\n"));
  EXPECT_FALSE(alone.goal);
  EXPECT_DOUBLE_EQ(alone.least_pulp_distance_m.value_or(0.0), 0.5e-3);
  const Scene both =
      parse(tissues + with_goal("pulp_distance_mm = 1\nshape = 'box'\nsize_mm = [1, 1, 1]\n"));
  EXPECT_TRUE(both.goal);
  EXPECT_DOUBLE_EQ(both.least_pulp_distance_m.value_or(0.0), 1e-3);
  EXPECT_FALSE(
      parse(tissues + with_goal("shape = 'box'\nsize_mm = [1, 1, 1]\n")).least_pulp_distance_m);
  EXPECT_NE(error_of(with_goal("pulp_distance_mm = 0.5\n"))
                .find("goal.pulp_distance_mm: found no tissue named pulp, expected one beside it"),
            std::string::npos);
  EXPECT_NE(error_of(tissues + with_goal("pulp_distance_mm = 0.5\ndepth_mm = 1\n"))
                .find("unknown key 'depth_mm'"),
            std::string::npos);
}

TEST(GoalOfAScene, AGoalHasTheSizesOfItsShape) {
  EXPECT_EQ(error_of(with_goal("size_mm = [1, 1, 1]\n")),
            "/scenes/s.toml: line 6, column 1, goal.shape: found neither a shape nor a file, "
            "expected box, cylinder, or a file");
  EXPECT_EQ(error_of(with_goal("shape = 'box'\nfile = 'g.stl'\n")),
            "/scenes/s.toml: line 7, column 9, goal.shape: found both a shape and a file, "
            "expected box, cylinder, or a file");
  EXPECT_NE(error_of(with_goal("file = 'g.stl'\nsize_mm = [1, 1, 1]\n"))
                .find("found the unknown key 'size_mm'"),
            std::string::npos);
  const GoalSettings file =
      *parse(with_goal("file = 'g.nrrd'\nsolid_above = 3\nposition_mm = [0, 0, 2]\n")).goal;
  EXPECT_EQ(file.shape, GoalShape::kFile);
  EXPECT_EQ(file.file, "/scenes/g.nrrd");
  EXPECT_EQ(file.solid_above, 3.0);
  EXPECT_TRUE(file.position_m.isApprox(Vector3d(0, 0, 2e-3), 1e-14));
  EXPECT_EQ(error_of(with_goal("shape = 'cone'\n")),
            "/scenes/s.toml: line 7, column 9, goal.shape: found 'cone', expected one of box, "
            "cylinder");
  for (const char* keys : {"", "diameter_mm = 1\n", "size_mm = [1, 1, 1]\ndiameter_mm = 1\n",
                           "size_mm = [1, 1, 1]\ndepth_mm = 1\n"}) {
    EXPECT_EQ(error_of(with_goal(std::string("shape = 'box'\n") + keys)),
              "/scenes/s.toml: line 7, column 9, goal.shape: found a box with other sizes, "
              "expected size_mm, and it alone");
  }
  for (const char* keys : {"", "diameter_mm = 1\n", "depth_mm = 1\n",
                           "diameter_mm = 1\ndepth_mm = 1\nsize_mm = [1, 1, 1]\n"}) {
    EXPECT_EQ(error_of(with_goal(std::string("shape = 'cylinder'\n") + keys)),
              "/scenes/s.toml: line 7, column 9, goal.shape: found a cylinder with other sizes, "
              "expected diameter_mm and depth_mm, and them alone");
  }
  EXPECT_NE(error_of(with_goal("shape = 'box'\nsize_mm = [1, 0, 1]\n"))
                .find("goal.size_mm: found 0, expected 0.01 to 1000"),
            std::string::npos);
  EXPECT_EQ(error_of(with_goal("shape = 'box'\nsize_mm = [1, 1, 1]\ntapper_deg = 2\n")),
            "/scenes/s.toml: line 9, column 14, goal.tapper_deg: found the unknown key "
            "'tapper_deg', expected 'taper_deg'");
}

TEST(GoalOfAScene, TheWallsOfAGoalDoNotMeet) {
  const auto with = [](const std::string& taper) {
    return error_of(with_goal("shape = 'box'\nsize_mm = [9, 2, 8]\ntaper_deg = " + taper + "\n"));
  };
  EXPECT_EQ(with("14"), "no error");  // 2 * 4 mm * tan(14 deg) = 1.99 mm
  EXPECT_EQ(with("14.1"),
            "/scenes/s.toml: line 9, column 13, goal.taper_deg: found walls that meet inside, "
            "expected a smaller angle for this size");
  EXPECT_NE(with("-14.1"), "no error");
  EXPECT_NE(with("46"), "no error");
}

TEST(GoalOfAScene, AGoalIsForACut) {
  EXPECT_EQ(error_of(least_scene() + "[goal]\nshape = 'box'\nsize_mm = [1, 1, 1]\n"),
            "/scenes/s.toml: line 5, column 1, goal: found [goal] without [cutting], expected "
            "both of them");
}

}  // namespace
}  // namespace sulcus::scene_goal_test
