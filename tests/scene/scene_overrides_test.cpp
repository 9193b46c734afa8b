#include <filesystem>

#include <gtest/gtest.h>

#include "engine/scene/toml_table.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus::scene_overrides_test {
namespace {

using test::error_of, test::least_scene, test::parse;
namespace fs = std::filesystem;

TEST(SceneOverrides, ASetValueIsTomlElseAString) {
  const Scene s = parse(least_scene(), {"workpiece.voxel_mm=0.1", "title=A burr, lifted",
                                        "trajectory.points_mm=[[1, 2, 3], [4, 5, 6]]",
                                        "burr.shape=pear", "haptics.scaling=\"none\""});
  EXPECT_DOUBLE_EQ(s.workpiece.voxel_m, 1e-4);
  EXPECT_EQ(s.title, "A burr, lifted");
  EXPECT_EQ(s.trajectory.points_m.size(), 2u);
  EXPECT_EQ(s.burr.shape, BurrShape::kPear);
  EXPECT_EQ(s.haptics.scaling, Scaling::kNone);
}

TEST(SceneOverrides, ASetMakesTheTableItNeeds) {
  EXPECT_EQ(parse(least_scene(), {"cutting.max_cut_voxels=9"}).cutting->max_cut_voxels, 9);
  EXPECT_DOUBLE_EQ(parse(least_scene(), {"workpiece.sphere.radius_mm=2"}).workpiece.sphere_radius_m,
                   2e-3);
}

TEST(SceneOverrides, TheLastSetWins) {
  EXPECT_EQ(parse(least_scene(), {"title=a", "title=b"}).title, "b");
}

TEST(SceneOverrides, ASetAddressesATissueByName) {
  const std::string two =
      least_scene() + "[[tissue]]\nname = 'enamel'\n[[tissue]]\nname = 'dentine'\n";
  const Scene s = parse(two, {"tissue.dentine.stiffness_N_per_mm=7"});
  EXPECT_DOUBLE_EQ(s.tissues[0].stiffness_N_per_m, 30e3);
  EXPECT_DOUBLE_EQ(s.tissues[1].stiffness_N_per_m, 7e3);
  EXPECT_EQ(error_of(two, {"tissue.pulp.above=7"}),
            "--set tissue.pulp.above=7: found no [[tissue]] named 'pulp', expected the name of a "
            "tissue of the scene");
}

TEST(SceneOverrides, SettingTheFileDropsTheShape) {
  const Scene s = parse(least_scene(), {"workpiece.file=/a/tooth.nrrd"});
  EXPECT_FALSE(s.workpiece.shape);
  EXPECT_EQ(s.workpiece.file, "/a/tooth.nrrd");
}

TEST(SceneOverrides, SettingAFileOfPosesDropsThePoints) {
  const Scene s = parse(least_scene(), {"trajectory.file=/a/poses.csv"});
  EXPECT_TRUE(s.trajectory.points_m.empty());
  EXPECT_EQ(s.trajectory.file, "/a/poses.csv");
}

TEST(SceneOverrides, PathsAreRelativeToTheFileInItAndToTheCurrentFolderInASet) {
  const std::string text =
      "[workpiece]\nfile = '../teeth/t.nrrd'\n[trajectory]\nfile = 'p.csv'\n[burr]\nfile = "
      "'/abs/b.stl'\n";
  const Scene s = parse(text);
  EXPECT_EQ(s.workpiece.file, "/teeth/t.nrrd");
  EXPECT_EQ(s.trajectory.file, "/scenes/p.csv");
  EXPECT_EQ(s.burr.file, "/abs/b.stl");
  EXPECT_EQ(s.burr.shape, BurrShape::kFile);

  const Scene set = parse(text, {"workpiece.file=t2.nrrd", "burr.file='/abs/c.stl'"});
  EXPECT_EQ(set.workpiece.file, (fs::current_path() / "t2.nrrd").string());
  EXPECT_EQ(set.trajectory.file, "/scenes/p.csv");
  EXPECT_EQ(set.burr.file, "/abs/c.stl");
}

TEST(SceneOverrides, ASetThatIsNoneIsRefused) {
  EXPECT_EQ(error_of(least_scene(), {"title"}),
            "--set title: found no '=', expected TABLE.KEY=VALUE");
  EXPECT_EQ(error_of(least_scene(), {"=3"}), "--set =3: found no '=', expected TABLE.KEY=VALUE");
  EXPECT_EQ(error_of(least_scene(), {"burr..shape=3"}),
            "--set burr..shape=3: found an empty key, expected TABLE.KEY=VALUE");
  EXPECT_EQ(error_of(least_scene(), {"workpiece.shape.x=3"}),
            "--set workpiece.shape.x=3: found 'shape', no table, expected a table");
  EXPECT_EQ(error_of(least_scene(), {"workpiece.voxel_mm=thin"}),
            "/scenes/s.toml: --set workpiece.voxel_mm: found 'thin', expected a number, 0.001 to "
            "10");
  EXPECT_EQ(error_of(least_scene(), {"burr.diametre_mm=1"}),
            "/scenes/s.toml: --set burr.diametre_mm: found the unknown key 'diametre_mm', "
            "expected 'diameter_mm'");
}

TEST(SceneOverrides, ASetOfBytesThatAreNoTextIsBadInput) {
  EXPECT_THROW(parse(least_scene(), {"title=\xff\xfe"}), InputError);
}

TEST(SceneOverrides, TheTextAsRunReadsBackTheSame) {
  const Scene s = parse(least_scene(), {"workpiece.voxel_mm=0.0123456789012345",
                                        "title=x = 'y' \"z\"", "burr.shape=pear"});
  const Scene again = parse(s.text);
  EXPECT_EQ(again.workpiece.voxel_m, s.workpiece.voxel_m);
  EXPECT_EQ(again.title, s.title);
  EXPECT_EQ(again.burr.shape, BurrShape::kPear);
  EXPECT_EQ(parse(least_scene()).text, least_scene()) << "without a set, byte for byte";
}

}  // namespace
}  // namespace sulcus::scene_overrides_test
