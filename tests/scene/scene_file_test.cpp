#include "engine/scene/scene_file.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/core/error.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;
using test::error_of, test::kLeast, test::parse;
namespace fs = std::filesystem;

/// The least scene with `more` keys in its [workpiece].
Scene parse_workpiece(const std::string& more) {
  return parse("[workpiece]\n" + more + "\n[trajectory]\npoints_mm = [[0, 0, 9]]\n");
}

TEST(SceneFile, DefaultsAreThoseStated) {
  const Scene s = parse(kLeast);
  EXPECT_EQ(s.title, "s") << "the name of the file";
  EXPECT_EQ(s.workpiece.shape, ShapeKind::kMolar);
  EXPECT_EQ(s.workpiece.cells, Vector3i(512, 512, 512));
  EXPECT_DOUBLE_EQ(s.workpiece.voxel_m, 34.8e-6);
  EXPECT_FALSE(s.workpiece.solid_above);
  EXPECT_FALSE(s.workpiece.spacing_m);
  EXPECT_EQ(s.workpiece.position_m, Vector3d(0, 0, 0));
  EXPECT_EQ(s.workpiece.rotation, Vector3d(0, 0, 0));
  ASSERT_EQ(s.tissues.size(), 1u);
  EXPECT_EQ(s.tissues[0].name, "enamel");
  EXPECT_DOUBLE_EQ(s.tissues[0].stiffness_N_per_m, 30e3);
  EXPECT_DOUBLE_EQ(s.tissues[0].specific_energy_J_per_m3, 3.5e9);
  EXPECT_EQ(s.burr.shape, BurrShape::kRound);
  EXPECT_DOUBLE_EQ(s.burr.diameter_m, 1.4e-3);
  EXPECT_FALSE(s.burr.length_m);
  EXPECT_DOUBLE_EQ(s.burr.speed_rad_per_s, 733.0382858376184);
  EXPECT_DOUBLE_EQ(s.burr.tangential_ratio, 0.3);
  EXPECT_EQ(s.burr.field_samples, Vector3i(128, 512, 128));
  EXPECT_FALSE(s.burr.field_spacing_m);
  EXPECT_DOUBLE_EQ(s.burr.reference_m, 40e-3);
  EXPECT_EQ(s.trajectory.axis, Vector3d(0, 0, 1));
  EXPECT_DOUBLE_EQ(s.trajectory.speed_m_per_s, 0.4e-3);
  EXPECT_EQ(s.haptics.rate_hz, 1000.0);
  EXPECT_EQ(s.haptics.normals, NormalMethod::kLdm);
  EXPECT_EQ(s.haptics.neighbourhood, 6);
  EXPECT_EQ(s.haptics.trace, 12);
  EXPECT_EQ(s.haptics.scaling, Scaling::kSmooth);
}

TEST(SceneFile, WhatIsNotNamedIsNotThere) {
  const Scene s = parse(kLeast);
  EXPECT_FALSE(s.cutting);
  EXPECT_FALSE(s.render);
  EXPECT_FALSE(s.record);
  const Scene all = parse(kLeast + "[cutting]\n[render]\n[record]\n");
  ASSERT_TRUE(all.cutting && all.render && all.record);
  EXPECT_EQ(all.render->width, 1280);
  EXPECT_EQ(all.render->height, 720);
  EXPECT_EQ(all.render->fps, 30.0);
  EXPECT_EQ(all.render->camera, Camera::kReview);
  EXPECT_TRUE(all.render->hud);
}

TEST(SceneFile, TheStructsOwnDefaultsAreTheFilesDefaults) {
  const Scene s = parse(kLeast + "[burr]\n[haptics]\n");
  const BurrSettings burr;
  EXPECT_DOUBLE_EQ(s.burr.diameter_m, burr.diameter_m);
  EXPECT_DOUBLE_EQ(s.burr.speed_rad_per_s, burr.speed_rad_per_s);
  EXPECT_DOUBLE_EQ(s.burr.tangential_ratio, burr.tangential_ratio);
  EXPECT_DOUBLE_EQ(s.burr.reference_m, burr.reference_m);
  EXPECT_DOUBLE_EQ(s.workpiece.voxel_m, WorkpieceSettings().voxel_m);
  EXPECT_EQ(s.haptics.trace, HapticsSettings().trace);
  const Scene bare = parse_workpiece("shape = 'torus'\n[workpiece.torus]\n[workpiece.groove]");
  EXPECT_DOUBLE_EQ(bare.workpiece.torus_major_m, WorkpieceSettings().torus_major_m);
  EXPECT_DOUBLE_EQ(bare.workpiece.torus_minor_m, WorkpieceSettings().torus_minor_m);
  EXPECT_DOUBLE_EQ(bare.workpiece.groove_angle, WorkpieceSettings().groove_angle);
}

TEST(SceneFile, LengthsAndAnglesOfTheWorkpieceAreConverted) {
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

TEST(SceneFile, APartOfAVolume) {
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

TEST(SceneFile, UnitsOfTheOtherTablesAreConverted) {
  const Scene s = parse(kLeast + R"(axis = [0, 3, 4]
speed_mm_per_s = 2.5
[[tissue]]
name = "putty"
above = 1010
stiffness_N_per_mm = 12
specific_energy_J_per_mm3 = 0.25
colour = [0, 0.5, 1]
[burr]
shape = "flame"
diameter_mm = 1.2
length_mm = 4
speed_rpm = 30
tangential_ratio = 0.5
field = [64, 256, 32]
field_spacing_mm = 0.02
reference_mm = 25
[haptics]
rate_hz = 500
normals = "ldm_paper"
neighbourhood = 8
scaling = "count"
keep_normals = false
refine_per_tick = 7
max_contacts = 100
[cutting]
max_cut_voxels = 5000
[render]
size = [640, 480]
fps = 25
camera = "burr"
hud = false
)");
  EXPECT_TRUE(s.trajectory.axis.isApprox(Vector3d(0, 0.6, 0.8), 1e-15));
  EXPECT_DOUBLE_EQ(s.trajectory.speed_m_per_s, 2.5e-3);
  ASSERT_EQ(s.trajectory.points_m.size(), 1u);
  EXPECT_TRUE(s.trajectory.points_m[0].isApprox(Vector3d(0, 0, 9e-3), 1e-15));
  ASSERT_EQ(s.tissues.size(), 1u);
  EXPECT_EQ(s.tissues[0].above, 1010.0);
  EXPECT_DOUBLE_EQ(s.tissues[0].stiffness_N_per_m, 12e3);
  EXPECT_DOUBLE_EQ(s.tissues[0].specific_energy_J_per_m3, 0.25e9);
  EXPECT_EQ(s.tissues[0].colour, (std::array<float, 3>{0.0f, 0.5f, 1.0f}));
  EXPECT_EQ(s.burr.shape, BurrShape::kFlame);
  EXPECT_DOUBLE_EQ(s.burr.diameter_m, 1.2e-3);
  EXPECT_DOUBLE_EQ(*s.burr.length_m, 4e-3);
  EXPECT_DOUBLE_EQ(s.burr.speed_rad_per_s, 3.141592653589793);
  EXPECT_DOUBLE_EQ(s.burr.tangential_ratio, 0.5);
  EXPECT_EQ(s.burr.field_samples, Vector3i(64, 256, 32));
  EXPECT_DOUBLE_EQ(*s.burr.field_spacing_m, 0.02e-3);
  EXPECT_DOUBLE_EQ(s.burr.reference_m, 25e-3);
  EXPECT_EQ(s.haptics.rate_hz, 500.0);
  EXPECT_EQ(s.haptics.normals, NormalMethod::kLdmPaper);
  EXPECT_EQ(s.haptics.neighbourhood, 8);
  EXPECT_EQ(s.haptics.trace, 5) << "the paper's alpha";
  EXPECT_EQ(s.haptics.scaling, Scaling::kCount);
  EXPECT_FALSE(s.haptics.keep_normals);
  EXPECT_EQ(s.haptics.refine_per_tick, 7);
  EXPECT_EQ(s.haptics.max_contacts, 100);
  EXPECT_EQ(s.cutting->max_cut_voxels, 5000);
  EXPECT_EQ(s.render->width, 640);
  EXPECT_EQ(s.render->height, 480);
  EXPECT_EQ(s.render->fps, 25.0);
  EXPECT_EQ(s.render->camera, Camera::kBurr);
  EXPECT_FALSE(s.render->hud);
}

TEST(SceneFile, EveryShapeAndBurrHasItsName) {
  const std::vector<std::string> shapes{"molar", "sphere", "box", "plate", "torus", "groove"};
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    EXPECT_EQ(parse_workpiece("shape = '" + shapes[i] + "'").workpiece.shape, ShapeKind(i));
  }
  const std::vector<std::string> burrs{"round", "pear", "fissure", "inverted_cone", "flame"};
  for (std::size_t i = 0; i < burrs.size(); ++i) {
    EXPECT_EQ(parse(kLeast + "[burr]\nshape = '" + burrs[i] + "'").burr.shape, BurrShape(i));
  }
}

TEST(SceneFile, AFieldMayBeAuto) {
  EXPECT_FALSE(parse(kLeast + "[burr]\nfield = 'auto'").burr.field_samples);
  EXPECT_EQ(error_of(kLeast + "[burr]\nfield = 'fine'"),
            "/scenes/s.toml: line 6, column 9, burr.field: found 'fine', expected one of auto");
  EXPECT_EQ(error_of(kLeast + "[burr]\nfield = [64, 64.5, 64]"),
            "/scenes/s.toml: line 6, column 9, burr.field: found fractions, expected 3 whole "
            "numbers, or \"auto\"");
}

// --- Tissues ------------------------------------------------------------------------------------

TEST(SceneFile, KnownTissuesBringTheirConstants) {
  const Scene s = parse("tissue = ['enamel', 'dentine', 'pulp', 'caries']\n" + kLeast);
  ASSERT_EQ(s.tissues.size(), 4u);
  EXPECT_EQ(s.tissues[1].name, "dentine");
  EXPECT_DOUBLE_EQ(s.tissues[0].specific_energy_J_per_m3, 3.5e9);
  EXPECT_DOUBLE_EQ(s.tissues[1].specific_energy_J_per_m3, 0.65e9);
  EXPECT_DOUBLE_EQ(s.tissues[1].stiffness_N_per_m, 25e3);
  EXPECT_DOUBLE_EQ(s.tissues[3].stiffness_N_per_m, 8e3);
  EXPECT_GT(s.tissues[3].specific_energy_J_per_m3, s.tissues[2].specific_energy_J_per_m3);
}

TEST(SceneFile, ATissueTableKeepsTheConstantsItDoesNotName) {
  const Scene s = parse(kLeast + "[[tissue]]\nname = 'dentine'\nstiffness_N_per_mm = 3\n");
  ASSERT_EQ(s.tissues.size(), 1u);
  EXPECT_DOUBLE_EQ(s.tissues[0].stiffness_N_per_m, 3e3);
  EXPECT_DOUBLE_EQ(s.tissues[0].specific_energy_J_per_m3, 0.65e9);
}

TEST(SceneFile, TissueErrorsNameTheTissue) {
  EXPECT_EQ(error_of("tissue = ['enamel', 'bone']\n" + kLeast),
            "/scenes/s.toml: line 1, column 10, tissue: found 'bone', expected enamel, dentine, "
            "pulp or caries, or a [[tissue]]");
  EXPECT_EQ(error_of(kLeast + "[[tissue]]\nname = 'a'\n[[tissue]]\nname = 'a'\n"),
            "/scenes/s.toml: line 5, column 1, tissue: found 'a' twice, expected names that "
            "differ");
  EXPECT_NE(error_of(kLeast + "[[tissue]]\nabove = 3\n").find("expected a name"),
            std::string::npos);
}

// --- [[body]] -----------------------------------------------------------------------------------

TEST(SceneFile, BodiesHaveAShapeOrAFileAndAPlace) {
  EXPECT_TRUE(parse(kLeast).bodies.empty());
  const Scene s =
      parse("tissue = ['enamel', 'dentine']\n" + kLeast +
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

TEST(SceneFile, ABodyThatIsNoneIsRefused) {
  const auto with = [](const std::string& keys) { return kLeast + "[[body]]\n" + keys; };
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
  std::string many = kLeast;
  for (int i = 0; i < 16; ++i) many += "[[body]]\nshape = 'box'\n";
  EXPECT_NE(error_of(many).find("found 16, expected at most 15"), std::string::npos);
}

// --- Errors -------------------------------------------------------------------------------------

TEST(SceneFile, AMissingTableSaysWhatItShouldHold) {
  EXPECT_EQ(error_of("[trajectory]\npoints_mm = [[0, 0, 0]]\n"),
            "/scenes/s.toml: line 1, column 1, workpiece: found no such table, expected "
            "[workpiece] with a shape or a file");
  EXPECT_EQ(error_of("[workpiece]\nshape = 'box'\n"),
            "/scenes/s.toml: line 1, column 1, trajectory: found no such table, expected "
            "[trajectory] with points_mm or a file");
}

TEST(SceneFile, ShapeAndFileExcludeEachOther) {
  EXPECT_EQ(error_of("[workpiece]\n[trajectory]\npoints_mm = [[0, 0, 0]]\n"),
            "/scenes/s.toml: line 1, column 1, workpiece.shape: found neither a shape nor a file, "
            "expected one of them");
  EXPECT_EQ(error_of("[workpiece]\nshape = 'box'\nfile = 'a.stl'\n"),
            "/scenes/s.toml: line 2, column 9, workpiece.shape: found both a shape and a file, "
            "expected one of them");
  EXPECT_EQ(error_of(kLeast + "file = 'p.csv'\n"),
            "/scenes/s.toml: line 4, column 13, trajectory.points_mm: found both points and a "
            "file, expected one of them");
  EXPECT_NE(error_of(kLeast + "[burr]\nshape = 'round'\nfile = 'b.stl'\n")
                .find("burr.shape: found both a shape and a file"),
            std::string::npos);
}

TEST(SceneFile, AnUnknownKeyNamesTheNearest) {
  EXPECT_EQ(error_of(kLeast + "[burr]\ndiametre_mm = 1\n"),
            "/scenes/s.toml: line 6, column 15, burr.diametre_mm: found the unknown key "
            "'diametre_mm', expected 'diameter_mm'");
  EXPECT_EQ(error_of(kLeast + "[haptic]\n"),
            "/scenes/s.toml: line 5, column 1, haptic: found the unknown key 'haptic', expected "
            "'haptics'");
  EXPECT_EQ(error_of("[workpiece]\nshape = 'sphere'\nsphere.radius = 3\n"),
            "/scenes/s.toml: line 3, column 17, workpiece.sphere.radius: found the unknown key "
            "'radius', expected 'radius_mm'");
}

TEST(SceneFile, CellsAreMultiplesOfEightUpTo1024) {
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

TEST(SceneFile, AWrongTypeOrRangeIsNamedWithItsPlace) {
  EXPECT_EQ(error_of(kLeast + "[haptics]\nneighbourhood = 17\n"),
            "/scenes/s.toml: line 6, column 17, haptics.neighbourhood: found 17, expected 1 to "
            "12");
  EXPECT_EQ(error_of(kLeast + "[haptics]\nneighbourhood = 6.5\n"),
            "/scenes/s.toml: line 6, column 17, haptics.neighbourhood: found 6.5, expected a "
            "whole number, 1 to 12");
  EXPECT_EQ(error_of(kLeast + "[haptics]\nnormals = 'best'\n"),
            "/scenes/s.toml: line 6, column 11, haptics.normals: found 'best', expected one of "
            "ldm, ldm_fast, ldm_paper, weighted_sum, weighted_sum_d2, exact");
  EXPECT_EQ(error_of(kLeast + "[burr]\ndiameter_mm = 0\n"),
            "/scenes/s.toml: line 6, column 15, burr.diameter_mm: found 0, expected 0.3 to 5");
  EXPECT_EQ(error_of(kLeast + "axis = [0, 0, 0]\n"),
            "/scenes/s.toml: line 5, column 8, trajectory.axis: found a vector of no length, "
            "expected a direction");
  EXPECT_EQ(error_of("title = 3\n" + kLeast),
            "/scenes/s.toml: line 1, column 9, title: found 3, expected a text in quotes");
  EXPECT_EQ(error_of("burr = 3\n" + kLeast),
            "/scenes/s.toml: line 1, column 8, burr: found 3, expected a table, [burr]");
}

TEST(SceneFile, ANormalErrorPicksTheNormals) {
  const auto picked = [](const std::string& error) {
    return parse(kLeast + "[haptics]\nnormal_error_deg = " + error).haptics;
  };
  const HapticsSettings coarse = picked("4"), fine = picked("1.5");
  EXPECT_EQ(coarse.normal_error_deg, 4.0);
  EXPECT_EQ(coarse.normals, NormalMethod::kLdmFast);
  EXPECT_LT(coarse.neighbourhood, fine.neighbourhood);
  EXPECT_EQ(fine.trace, 12);
  EXPECT_FALSE(parse(kLeast).haptics.normal_error_deg);
  EXPECT_EQ(parse(kLeast, {"haptics.normal_error_deg=4"}).haptics.neighbourhood,
            coarse.neighbourhood);
}

TEST(SceneFile, OnACouplingMapsAreWider) {
  const auto neighbourhood = [](const std::string& more) {
    return parse(kLeast + more).haptics.neighbourhood;
  };
  EXPECT_EQ(neighbourhood("[coupling]\n"), 10);
  EXPECT_EQ(neighbourhood("[coupling]\n[haptics]\nnormals = 'ldm_fast'\n"), 10);
  EXPECT_EQ(neighbourhood("[coupling]\n[haptics]\nneighbourhood = 6\n"), 6);
  EXPECT_EQ(neighbourhood("[coupling]\n[haptics]\nnormals = 'exact'\n"), 6);
  EXPECT_EQ(neighbourhood("[haptics]\nnormals = 'ldm_fast'\n"), 6);
}

TEST(SceneFile, ANormalErrorStandsAlone) {
  const auto with = [](const std::string& more) {
    return error_of(kLeast + "[haptics]\nnormal_error_deg = 2\n" + more);
  };
  EXPECT_EQ(with("normals = 'ldm'"),
            "/scenes/s.toml: line 7, column 11, haptics.normals: found normals beside "
            "normal_error_deg, expected one of them");
  EXPECT_NE(with("neighbourhood = 6").find("haptics.neighbourhood: found neighbourhood beside"),
            std::string::npos);
  EXPECT_NE(with("trace = 12").find("haptics.trace: found trace beside"), std::string::npos);
  EXPECT_EQ(with("scaling = 'count'"), "no error");
}

TEST(SceneFile, ANormalErrorThatCannotBeMetNamesTheBestThatCan) {
  const std::string message = error_of(kLeast + "[haptics]\nnormal_error_deg = 0.01\n");
  EXPECT_EQ(message.find("/scenes/s.toml: line 6, column 20, haptics.normal_error_deg: found "
                         "0.01, expected "),
            0u)
      << message;
  EXPECT_NE(message.find("normals = \"ldm\" with neighbourhood = "), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << "one line";
  EXPECT_NE(error_of(kLeast + "[haptics]\nnormal_error_deg = -1\n").find("expected 0 to 90"),
            std::string::npos);
}

TEST(SceneFile, AnAxisMustBeFinite) {
  for (const char* axis : {"[inf, 0, 0]", "[0, nan, 1]", "[1e200, 1e200, 0]"}) {
    EXPECT_NE(error_of(kLeast + "axis = " + axis), "no error") << axis;
  }
}

TEST(SceneFile, ATorusIsThinnerThanItsRing) {
  const auto with = [](const std::string& torus) {
    return error_of("[workpiece]\nshape = 'torus'\ntorus = {" + torus +
                    "}\n[trajectory]\npoints_mm = [[0, 0, 0]]\n");
  };
  EXPECT_EQ(with("major_mm = 3, minor_mm = 1"), "no error");
  EXPECT_NE(with("major_mm = 3, minor_mm = 4"), "no error");
  EXPECT_NE(with("major_mm = 0.5"), "no error") << "the default minor radius is 1 mm";
}

TEST(SceneFile, WhatIsNoTomlIsShownWithItsPlace) {
  const std::string message = error_of("[workpiece]\nshape = \n");
  EXPECT_EQ(message.find("/scenes/s.toml: line 2, column 9: found what is no TOML ("), 0u)
      << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << "one line";
  EXPECT_NE(error_of("a = 1\na = 2\n").find("line 2"), std::string::npos);
  EXPECT_THROW(parse("\xff\xfe\x01"), InputError);
  EXPECT_THROW(parse(""), InputError);
}

class SceneFileOnDisk : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("sulcus_" + std::to_string(getpid()) +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(SceneFileOnDisk, IsReadWithPathsRelativeToIt) {
  const fs::path file = folder_ / "one.toml";
  std::ofstream(file) << "[workpiece]\nfile = 't.nrrd'\n[trajectory]\npoints_mm = [[0, 0, 0]]\n";
  const Scene s = load_scene(file.string());
  EXPECT_EQ(s.title, "one");
  EXPECT_EQ(s.file, file.string());
  EXPECT_EQ(s.workpiece.file, (folder_ / "t.nrrd").string());
}

TEST_F(SceneFileOnDisk, AMissingFileOrAFolderIsBadInput) {
  const auto message = [&](const fs::path& file) -> std::string {
    try {
      load_scene(file.string());
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(
      message(folder_ / "no.toml"),
      (folder_ / "no.toml").string() + ": found no readable file, expected a scene file, .toml");
  EXPECT_EQ(message(folder_), folder_.string() + ": found a folder, expected a scene file, .toml");
}

TEST_F(SceneFileOnDisk, AHugeFileIsRefusedBeforeItIsRead) {
  const fs::path file = folder_ / "huge.toml";
  std::ofstream(file) << "x";
  fs::resize_file(file, std::uintmax_t{20} << 30);  // sparse: takes no room
  EXPECT_THROW(load_scene(file.string()), InputError);
}

TEST(SceneFile, ALoadASpindleAndATimeToHold) {
  const Scene s = parse(kLeast +
                        "hold_s = 10\nload_N = 1.5\nload_direction = [0, 3, -4]\n[cutting]\n"
                        "[spindle]\nstall_torque_mNm = 2\ninertia_g_mm2 = 7\n");
  EXPECT_EQ(s.trajectory.hold_s, 10.0);
  EXPECT_EQ(s.trajectory.load_N, 1.5);
  EXPECT_TRUE(s.trajectory.load_direction.isApprox(Vector3d(0, 0.6, -0.8), 1e-15));
  ASSERT_TRUE(s.spindle);
  EXPECT_DOUBLE_EQ(s.spindle->stall_torque_Nm, 2e-3);
  EXPECT_DOUBLE_EQ(s.spindle->inertia_kg_m2, 7e-9);
  EXPECT_FALSE(parse(kLeast).spindle);
  EXPECT_FALSE(parse(kLeast).trajectory.load_N);
}

TEST(SceneFile, ADirectionNeedsItsLoadAndASpindleItsCutting) {
  EXPECT_EQ(
      error_of(kLeast + "load_direction = [0, 0, -1]\n"),
      "/scenes/s.toml: line 5, column 18, trajectory.load_direction: found a direction without "
      "load_N, expected both of them");
  EXPECT_EQ(
      error_of(kLeast + "[spindle]\n"),
      "/scenes/s.toml: line 5, column 1, spindle: found [spindle] without [cutting], expected "
      "both, or neither");
}

}  // namespace
}  // namespace sulcus
