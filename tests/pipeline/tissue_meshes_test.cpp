#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/playback/saved_scene.hpp"
#include "engine/core/error.hpp"
#include "engine/scene/scene_file.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

// From voxels to a mesh of each tissue, and from those meshes back to voxels.

namespace sulcus::tissue_meshes_test {
namespace {

using test::sulcus_command;

const std::string kMolar = R"(tissue = ["enamel", "dentine", "pulp"]
[workpiece]
shape = "molar"
voxel_mm = 0.1
cells = [128, 112, 216]
[burr]
field = [24, 96, 24]
[trajectory]
points_mm = [[-0.5, 0, 9.5], [0.5, 0, 9.5]]
speed_mm_per_s = 100
[record]
)";

std::map<std::string, double> tissue_mm3(const std::string& out) {
  return nlohmann::json::parse(std::ifstream(out + "/summary.json"))["workpiece"]["tissue_mm3"];
}

/// The number after `what` that `sulcus inspect` prints of a mesh.
double inspected(const ScratchFolder& scratch, const std::string& file, const std::string& what) {
  const auto result = sulcus_command("inspect " + file, scratch.path("err"));
  EXPECT_EQ(result.status, 0) << result.err;
  std::smatch match;
  EXPECT_TRUE(std::regex_search(result.out, match, std::regex(what + " +([0-9.]+)")));
  return match.empty() ? -1.0 : std::stod(match[1]);
}

class TissueMeshes : public testing::Test {
 protected:
  /// Runs a scene and exports its meshes of tissues, as `name`_TISSUE.stl.
  std::string exported(const std::string& name, const std::string& scene) {
    const std::string out = scratch.path(name);
    const std::string file = scratch.write(name + ".toml", scene);
    expect_done("run " + file + " -o " + out);
    expect_done("export " + out + "/recording.h5 --per-tissue --mesh " + out + ".stl");
    return out;
  }
  void expect_done(const std::string& arguments) {
    const auto result = sulcus_command(arguments, scratch.path("err"));
    ASSERT_EQ(result.status, 0) << arguments << ": " << result.err;
  }

  const ScratchFolder scratch;
};

TEST_F(TissueMeshes, AreClosedAndGiveTheVoxelsBack) {
  const std::string molar = exported("molar", kMolar);
  std::map<std::string, double> truth = tissue_mm3(molar);
  ASSERT_EQ(truth.size(), 3u);
  double sum = 0.0, voxels = 0.0;
  for (const auto& [name, volume_mm3] : truth) {
    const std::string file = molar + "_" + name + ".stl";
    EXPECT_EQ(inspected(scratch, file, "open edges"), 0.0) << name;
    const double mesh_mm3 = inspected(scratch, file, "volume");
    EXPECT_NEAR(mesh_mm3 / volume_mm3, 1.0, 0.02) << name;
    sum += mesh_mm3;
    voxels += volume_mm3;
  }
  EXPECT_NEAR(sum / voxels, 1.0, 0.01);

  // The three meshes as a workpiece: their box is not quite on the lattice any more.
  std::string scene = std::regex_replace(kMolar, std::regex("^tissue.*\n"), "");
  scene = std::regex_replace(scene, std::regex("shape = \"molar\""), "file = \"molar_enamel.stl\"");
  scene += "[[tissue]]\nname = \"enamel\"\n";
  for (const char* name : {"dentine", "pulp"}) {
    scene +=
        std::string("[[tissue]]\nname = \"") + name + "\"\nfile = \"molar_" + name + ".stl\"\n";
  }
  const std::string back = exported("back", scene);
  for (const auto& [name, volume_mm3] : tissue_mm3(back)) {
    EXPECT_NEAR(volume_mm3 / truth[name], 1.0, 0.02) << name;
  }
  expect_done("replay --verify " + back + "/recording.h5");
  const auto inspected_scene = sulcus_command("inspect " + back + ".toml", scratch.path("err"));
  EXPECT_NE(inspected_scene.out.find("molar_dentine.stl"), std::string::npos)
      << inspected_scene.out;
}

TEST_F(TissueMeshes, ATissuesNameNamesNoOtherFolder) {
  const std::string scene =
      "[[tissue]]\nname = \"../../out/up\"\n[[tissue]]\nname = \"filling\"\n" +
      std::regex_replace(kMolar, std::regex("^tissue.*\n"), "");
  const std::string box = exported("box", scene);
  EXPECT_TRUE(std::filesystem::exists(box + "_.._.._out_up.stl"));
  EXPECT_FALSE(std::filesystem::exists(box + "_filling.stl")) << "no voxel is of it";
}

TEST(SavedScene, KeepsTheMeshesOfTissuesWhereTheyAre) {
  const auto scene = [](const std::string& name) {
    return parse_scene(
        "[workpiece]\nfile = 'tooth.stl'\n[trajectory]\npoints_mm = [[0, 0, 9]]\n"
        "[[tissue]]\nname = 'enamel'\n[[tissue]]\nname = '" +
            name + "'\nfile = 'inner.stl'\n",
        "/scenes/s.toml");
  };
  const Scene elsewhere =
      parse_scene(saved_scene(scene("dentine"), "/out/recording.h5", {}), "/other/s.toml");
  EXPECT_EQ(elsewhere.workpiece.file, "/scenes/tooth.stl");
  EXPECT_EQ(elsewhere.tissues[1].file, "/scenes/inner.stl");
  EXPECT_THROW((void)saved_scene(scene("a.b"), "/out/recording.h5", {}), InputError);
}

TEST_F(TissueMeshes, NeedAFileToBeNamedAfter) {
  const auto result = sulcus_command("export a.h5 --per-tissue", scratch.path("err"));
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_NE(result.err.find("--mesh"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace sulcus::tissue_meshes_test
