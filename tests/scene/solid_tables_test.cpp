#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/table_readers.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus::solid_tables_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;
using test::error_of, test::least_scene, test::parse;

/// The least scene with `more` keys in its [workpiece].
Scene parse_workpiece(const std::string& more) {
  return parse("[workpiece]\n" + more + "\n[trajectory]\npoints_mm = [[0, 0, 9]]\n");
}

TEST(SolidTables, LengthsAndAnglesOfTheWorkpieceAreConverted) {
  const WorkpieceSettings w = parse_workpiece(R"(shape = "plate"
voxel_mm = 0.05
cells = [8, 1024, 64]
spacing_mm = [0.1, 0.2, 0.3]
solid_above = 600
position_mm = [1, -2, 3]
rotation_deg = [180, 90, -45]
molar.caries_radius_mm = 1.5
sphere.radius_mm = 4
box.size_mm = [1, 2, 3]
plate = { thickness_mm = 0.5, tilt_deg = 30 }
torus = { major_mm = 5, minor_mm = 2 }
groove = { angle_deg = 60, depth_mm = 2.5 })")
                                  .workpiece;
  constexpr double kPi = 3.141592653589793;
  EXPECT_EQ(w.shape, ShapeKind::kPlate);
  EXPECT_DOUBLE_EQ(w.voxel_m, 50e-6);
  EXPECT_EQ(w.cells, Vector3i(8, 1024, 64));
  EXPECT_TRUE(w.spacing_m->isApprox(Vector3d(0.1e-3, 0.2e-3, 0.3e-3), 1e-14));
  EXPECT_EQ(w.solid_above, 600.0);
  EXPECT_TRUE(w.position_m.isApprox(Vector3d(1e-3, -2e-3, 3e-3), 1e-14));
  EXPECT_TRUE(w.rotation.isApprox(Vector3d(kPi, kPi / 2, -kPi / 4), 1e-14));
  EXPECT_DOUBLE_EQ(w.molar_caries_radius_m, 1.5e-3);
  EXPECT_DOUBLE_EQ(w.sphere_radius_m, 4e-3);
  EXPECT_TRUE(w.box_size_m.isApprox(Vector3d(1e-3, 2e-3, 3e-3), 1e-14));
  EXPECT_DOUBLE_EQ(w.plate_thickness_m, 0.5e-3);
  EXPECT_DOUBLE_EQ(w.plate_tilt, kPi / 6);
  EXPECT_DOUBLE_EQ(w.torus_major_m, 5e-3);
  EXPECT_DOUBLE_EQ(w.torus_minor_m, 2e-3);
  EXPECT_DOUBLE_EQ(w.groove_angle, kPi / 3);
  EXPECT_DOUBLE_EQ(w.groove_depth_m, 2.5e-3);
}

TEST(SolidTables, APartOfAVolume) {
  const std::string rest = "\n[trajectory]\npoints_mm = [[0, 0, 9]]\n";
  const auto scene = [&](const std::string& workpiece, const std::string& more = "") {
    return "[workpiece]\nfile = 'a.nrrd'\n" + workpiece + rest + more;
  };
  const WorkpieceSettings w =
      parse(scene("solid_above = 3\nbox_mm = [-10, 1, 2, -5, 6, 7.5]\nlabels = 'b.nrrd'\n"
                  "label = 19"))
          .workpiece;
  ASSERT_TRUE(w.box_file);
  EXPECT_TRUE(w.box_file->min().isApprox(Vector3d(-10e-3, 1e-3, 2e-3), 1e-14));
  EXPECT_TRUE(w.box_file->max().isApprox(Vector3d(-5e-3, 6e-3, 7.5e-3), 1e-14));
  EXPECT_EQ(w.labels, "/scenes/b.nrrd");
  EXPECT_EQ(w.label, 19);
  const std::string labels =
      "[[tissue]]\nname = 'a'\nlabel = 2\n[[tissue]]\nname = 'b'\nlabel = 1\n";
  EXPECT_EQ(parse(scene("", labels)).tissues[1].label, 1);

  const auto refused = [&](const std::string& text, const std::string& expected) {
    EXPECT_NE(error_of(text).find(expected), std::string::npos) << error_of(text);
  };
  refused(scene("box_mm = [0, 0, 5, 1, 1, 1]"), "expected [x0, y0, z0, x1, y1, z1] with x0 < x1");
  refused(scene("labels = 'b.nrrd'"), "expected label = N");
  refused(scene("solid_above = 3\nlabel = 1"), "solid_above, and no labels");
  refused(scene("solid_above = 3", labels), "expected above for grey values, label for a label");
  refused(scene("", labels + "[[tissue]]\nname = 'c'\nabove = 1\n"), "above and label");
  refused(scene("", labels + "[[tissue]]\nname = 'c'\nlabel = 2\n"), "label 2 twice");
}

TEST(SolidTables, BodiesHaveAShapeOrAFileAndAPlace) {
  EXPECT_TRUE(parse(least_scene()).bodies.empty());
  const Scene s =
      parse("tissue = ['enamel', 'dentine']\n" + least_scene() +
            "[[body]]\nname = 'mesial'\nshape = 'molar'\nvoxel_mm = 0.05\ncells = [208, 208, 408]\n"
            "position_mm = [10, 0, -1]\nrotation_deg = [0, 0, 180]\ncuttable = true\n"
            "[[body]]\nfile = 'jaw.stl'\ntissue = 'dentine'\n[cutting]\n");
  ASSERT_EQ(s.bodies.size(), 2u);
  const BodySettings &mesial = s.bodies[0], &jaw = s.bodies[1];
  EXPECT_EQ(mesial.name, "mesial");
  EXPECT_EQ(mesial.solid.shape, ShapeKind::kMolar);
  EXPECT_EQ(mesial.solid.cells, Vector3i(208, 208, 408));
  EXPECT_DOUBLE_EQ(mesial.solid.voxel_m, 5e-5);
  EXPECT_TRUE(mesial.cuttable);
  EXPECT_FALSE(mesial.tissue);
  // The place is that of its grid; in it the solid stands in the middle.
  EXPECT_TRUE(mesial.world_from_grid.position.isApprox(Vector3d(10e-3, 0, -1e-3), 1e-14));
  EXPECT_TRUE(
      mesial.world_from_grid.direction(Vector3d::UnitX()).isApprox(-Vector3d::UnitX(), 1e-14));
  EXPECT_TRUE(mesial.solid.position_m.isZero(0.0));
  EXPECT_TRUE(mesial.solid.rotation.isZero(0.0));
  EXPECT_EQ(jaw.name, "body 2");
  EXPECT_EQ(jaw.solid.file, "/scenes/jaw.stl");
  EXPECT_EQ(jaw.tissue, 1u);
  EXPECT_FALSE(jaw.cuttable);
}

TEST(SolidTables, ABodyThatIsNoneIsRefused) {
  const auto with = [](const std::string& keys) { return least_scene() + "[[body]]\n" + keys; };
  EXPECT_EQ(error_of(with("name = 'a'\n")),
            "/scenes/s.toml: line 5, column 1, body.shape: found neither a shape nor a file, "
            "expected one of them");
  EXPECT_EQ(error_of(with("shape = 'box'\ntissue = 'bone'\n")),
            "/scenes/s.toml: line 7, column 10, body.tissue: found 'bone', expected a tissue of "
            "the scene");
  EXPECT_EQ(error_of(with("shape = 'box'\nname = 'a'\n[[body]]\nshape = 'box'\nname = 'a'\n")),
            "/scenes/s.toml: line 10, column 8, body.name: found 'a' twice, expected names that "
            "differ");
  EXPECT_EQ(error_of(with("shape = 'box'\ncuttable = true\n")),
            "/scenes/s.toml: line 7, column 12, body.cuttable: found a cuttable body without "
            "[cutting], expected both of them");
  EXPECT_NE(error_of(with("shape = 'box'\ncutable = true\n")).find("expected 'cuttable'"),
            std::string::npos);
  std::string many = least_scene();
  for (int i = 0; i < 16; ++i) many += "[[body]]\nshape = 'box'\n";
  EXPECT_NE(error_of(many).find("found 16, expected at most 15"), std::string::npos);
}

// --- Errors -------------------------------------------------------------------------------------

TEST(SolidTables, ShapeAndFileExcludeEachOther) {
  EXPECT_EQ(error_of("[workpiece]\n[trajectory]\npoints_mm = [[0, 0, 0]]\n"),
            "/scenes/s.toml: line 1, column 1, workpiece.shape: found neither a shape nor a file, "
            "expected one of them");
  EXPECT_EQ(error_of("[workpiece]\nshape = 'box'\nfile = 'a.stl'\n"),
            "/scenes/s.toml: line 2, column 9, workpiece.shape: found both a shape and a file, "
            "expected one of them");
  EXPECT_EQ(error_of(least_scene() + "file = 'p.csv'\n"),
            "/scenes/s.toml: line 4, column 13, trajectory.points_mm: found both points and a "
            "file, expected one of them");
  EXPECT_NE(error_of(least_scene() + "[burr]\nshape = 'round'\nfile = 'b.stl'\n")
                .find("burr.shape: found both a shape and a file"),
            std::string::npos);
}

TEST(SolidTables, CellsAreMultiplesOfEightUpTo1024) {
  const auto with = [](const std::string& cells) {
    return error_of("[workpiece]\nshape = 'box'\ncells = " + cells);
  };
  EXPECT_EQ(with("[512, 100, 512]"),
            "/scenes/s.toml: line 3, column 9, workpiece.cells: found 100, expected multiples of "
            "8, at most 1024 each");
  EXPECT_NE(with("[8, 8, 1032]").find("found 1032, expected 8 to 1024"), std::string::npos);
  EXPECT_NE(with("[0, 8, 8]").find("found 0, expected 8 to 1024"), std::string::npos);
  EXPECT_NE(with("[8, 8.5, 8]").find("found 8.5, expected multiples of 8"), std::string::npos);
  EXPECT_NE(with("[512, 512]").find("expected 3 numbers, 8 to 1024"), std::string::npos);
  EXPECT_NE(with("512").find("expected 3 numbers, 8 to 1024"), std::string::npos);
}

TEST(SolidTables, ATorusIsThinnerThanItsRing) {
  const auto with = [](const std::string& torus) {
    return error_of("[workpiece]\nshape = 'torus'\ntorus = {" + torus +
                    "}\n[trajectory]\npoints_mm = [[0, 0, 0]]\n");
  };
  EXPECT_EQ(with("major_mm = 3, minor_mm = 1"), "no error");
  EXPECT_NE(with("major_mm = 3, minor_mm = 4"), "no error");
  EXPECT_NE(with("major_mm = 0.5"), "no error") << "the default minor radius is 1 mm";
}

}  // namespace
}  // namespace sulcus::solid_tables_test
