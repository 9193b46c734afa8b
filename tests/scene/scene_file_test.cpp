#include "engine/scene/scene_file.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/core/error.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus::scene_file_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;
using test::error_of, test::least_scene, test::parse;
namespace fs = std::filesystem;

/// The least scene with `more` keys in its [workpiece].
Scene parse_workpiece(const std::string& more) {
  return parse("[workpiece]\n" + more + "\n[trajectory]\npoints_mm = [[0, 0, 9]]\n");
}

TEST(SceneFile, DefaultsAreThoseStated) {
  const Scene s = parse(least_scene());
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
  const Scene s = parse(least_scene());
  EXPECT_FALSE(s.cutting);
  EXPECT_FALSE(s.render);
  EXPECT_FALSE(s.record);
  const Scene all = parse(least_scene() + "[cutting]\n[render]\n[record]\n");
  ASSERT_TRUE(all.cutting && all.render && all.record);
  EXPECT_EQ(all.render->width, 1280);
  EXPECT_EQ(all.render->height, 720);
  EXPECT_EQ(all.render->fps, 30.0);
  EXPECT_EQ(all.render->camera, Camera::kReview);
  EXPECT_TRUE(all.render->hud);
}

TEST(SceneFile, TheStructsOwnDefaultsAreTheFilesDefaults) {
  const Scene s = parse(least_scene() + "[burr]\n[haptics]\n");
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

TEST(SceneFile, UnitsOfTheOtherTablesAreConverted) {
  const Scene s = parse(least_scene() + R"(axis = [0, 3, 4]
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
    EXPECT_EQ(parse(least_scene() + "[burr]\nshape = '" + burrs[i] + "'").burr.shape, BurrShape(i));
  }
}

TEST(SceneFile, AFieldMayBeAuto) {
  EXPECT_FALSE(parse(least_scene() + "[burr]\nfield = 'auto'").burr.field_samples);
  EXPECT_EQ(error_of(least_scene() + "[burr]\nfield = 'fine'"),
            "/scenes/s.toml: line 6, column 9, burr.field: found 'fine', expected one of auto");
  EXPECT_EQ(error_of(least_scene() + "[burr]\nfield = [64, 64.5, 64]"),
            "/scenes/s.toml: line 6, column 9, burr.field: found fractions, expected 3 whole "
            "numbers, or \"auto\"");
}

// --- Tissues ------------------------------------------------------------------------------------

TEST(SceneFile, AMissingTableSaysWhatItShouldHold) {
  EXPECT_EQ(error_of("[trajectory]\npoints_mm = [[0, 0, 0]]\n"),
            "/scenes/s.toml: line 1, column 1, workpiece: found no such table, expected "
            "[workpiece] with a shape or a file");
  EXPECT_EQ(error_of("[workpiece]\nshape = 'box'\n"),
            "/scenes/s.toml: line 1, column 1, trajectory: found no such table, expected "
            "[trajectory] with points_mm or a file");
}

TEST(SceneFile, AnUnknownKeyNamesTheNearest) {
  EXPECT_EQ(error_of(least_scene() + "[burr]\ndiametre_mm = 1\n"),
            "/scenes/s.toml: line 6, column 15, burr.diametre_mm: found the unknown key "
            "'diametre_mm', expected 'diameter_mm'");
  EXPECT_EQ(error_of(least_scene() + "[haptic]\n"),
            "/scenes/s.toml: line 5, column 1, haptic: found the unknown key 'haptic', expected "
            "'haptics'");
  EXPECT_EQ(error_of("[workpiece]\nshape = 'sphere'\nsphere.radius = 3\n"),
            "/scenes/s.toml: line 3, column 17, workpiece.sphere.radius: found the unknown key "
            "'radius', expected 'radius_mm'");
}

TEST(SceneFile, AWrongTypeOrRangeIsNamedWithItsPlace) {
  EXPECT_EQ(error_of(least_scene() + "[haptics]\nneighbourhood = 17\n"),
            "/scenes/s.toml: line 6, column 17, haptics.neighbourhood: found 17, expected 1 to "
            "12");
  EXPECT_EQ(error_of(least_scene() + "[haptics]\nneighbourhood = 6.5\n"),
            "/scenes/s.toml: line 6, column 17, haptics.neighbourhood: found 6.5, expected a "
            "whole number, 1 to 12");
  EXPECT_EQ(error_of(least_scene() + "[haptics]\nnormals = 'best'\n"),
            "/scenes/s.toml: line 6, column 11, haptics.normals: found 'best', expected one of "
            "ldm, ldm_fast, ldm_paper, weighted_sum, weighted_sum_d2, exact");
  EXPECT_EQ(error_of(least_scene() + "[burr]\ndiameter_mm = 0\n"),
            "/scenes/s.toml: line 6, column 15, burr.diameter_mm: found 0, expected 0.3 to 5");
  EXPECT_EQ(error_of(least_scene() + "axis = [0, 0, 0]\n"),
            "/scenes/s.toml: line 5, column 8, trajectory.axis: found a vector of no length, "
            "expected a direction");
  EXPECT_EQ(error_of("title = 3\n" + least_scene()),
            "/scenes/s.toml: line 1, column 9, title: found 3, expected a text in quotes");
  EXPECT_EQ(error_of("burr = 3\n" + least_scene()),
            "/scenes/s.toml: line 1, column 8, burr: found 3, expected a table, [burr]");
}

TEST(SceneFile, ANormalErrorPicksTheNormals) {
  const auto picked = [](const std::string& error) {
    return parse(least_scene() + "[haptics]\nnormal_error_deg = " + error).haptics;
  };
  const HapticsSettings coarse = picked("4"), fine = picked("1.5");
  EXPECT_EQ(coarse.normal_error_deg, 4.0);
  EXPECT_EQ(coarse.normals, NormalMethod::kLdmFast);
  EXPECT_LT(coarse.neighbourhood, fine.neighbourhood);
  EXPECT_EQ(fine.trace, 12);
  EXPECT_FALSE(parse(least_scene()).haptics.normal_error_deg);
  EXPECT_EQ(parse(least_scene(), {"haptics.normal_error_deg=4"}).haptics.neighbourhood,
            coarse.neighbourhood);
}

TEST(SceneFile, OnACouplingMapsAreWider) {
  const auto neighbourhood = [](const std::string& more) {
    return parse(least_scene() + more).haptics.neighbourhood;
  };
  EXPECT_EQ(neighbourhood("[coupling]\n"), 10);
  EXPECT_EQ(neighbourhood("[coupling]\n[haptics]\nnormals = 'ldm_fast'\n"), 10);
  EXPECT_EQ(neighbourhood("[coupling]\n[haptics]\nneighbourhood = 6\n"), 6);
  EXPECT_EQ(neighbourhood("[coupling]\n[haptics]\nnormals = 'exact'\n"), 6);
  EXPECT_EQ(neighbourhood("[haptics]\nnormals = 'ldm_fast'\n"), 6);
}

TEST(SceneFile, ANormalErrorStandsAlone) {
  const auto with = [](const std::string& more) {
    return error_of(least_scene() + "[haptics]\nnormal_error_deg = 2\n" + more);
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
  const std::string message = error_of(least_scene() + "[haptics]\nnormal_error_deg = 0.01\n");
  EXPECT_EQ(message.find("/scenes/s.toml: line 6, column 20, haptics.normal_error_deg: found "
                         "0.01, expected "),
            0u)
      << message;
  EXPECT_NE(message.find("normals = \"ldm\" with neighbourhood = "), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << "one line";
  EXPECT_NE(error_of(least_scene() + "[haptics]\nnormal_error_deg = -1\n").find("expected 0 to 90"),
            std::string::npos);
}

TEST(SceneFile, AnAxisMustBeFinite) {
  for (const char* axis : {"[inf, 0, 0]", "[0, nan, 1]", "[1e200, 1e200, 0]"}) {
    EXPECT_NE(error_of(least_scene() + "axis = " + axis), "no error") << axis;
  }
}

TEST(SceneFile, WhatIsNoTomlIsShownWithItsPlace) {
  const std::string message = error_of("[workpiece]\nshape = \n");
  EXPECT_EQ(message.find("/scenes/s.toml: line 2, column 9: found text that is not valid TOML ("),
            0u)
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

TEST(SceneFile, OnlyMethodsThatReadFractionsTakeThem) {
  const auto with = [](const std::string& normals) {
    return parse(
        "[workpiece]\nshape = 'box'\nsurface = 'fractions'\n[trajectory]\npoints_mm = [[0, "
        "0, 9]]\n[haptics]\nnormals = '" +
        normals + "'\n");
  };
  EXPECT_EQ(with("ldm").workpiece.surface, SurfaceKind::kFractions);
  EXPECT_EQ(with("ldm_fast").haptics.normals, NormalMethod::kLdmFast);
  EXPECT_EQ(parse(least_scene()).workpiece.surface, SurfaceKind::kBinary);
  for (const char* normals : {"ldm_paper", "weighted_sum", "weighted_sum_d2", "exact"}) {
    EXPECT_THROW(with(normals), InputError) << normals;
  }
}

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
  // A disk that fails within it; here a process's memory, of which the first page is none.
  EXPECT_EQ(message("/proc/self/mem"),
            "/proc/self/mem: found a file that cannot be read to its end, expected a scene file, "
            ".toml");
  const fs::path recording = folder_ / "recording.toml";
  std::ofstream(recording) << "\x89HDF\r\n\x1a\n";  // as every HDF5 file begins
  EXPECT_EQ(message(recording),
            recording.string() + ": found HDF5, as of a recording, expected a scene file, .toml");
}

TEST_F(SceneFileOnDisk, AHugeFileIsRefusedBeforeItIsRead) {
  const fs::path file = folder_ / "huge.toml";
  std::ofstream(file) << "x";
  fs::resize_file(file, std::uintmax_t{20} << 30);  // sparse: takes no room
  EXPECT_THROW(load_scene(file.string()), InputError);
}

TEST(SceneFile, ALoadASpindleAndATimeToHold) {
  const Scene s = parse(least_scene() +
                        "hold_s = 10\nload_N = 1.5\nload_direction = [0, 3, -4]\n[cutting]\n"
                        "[spindle]\nstall_torque_mNm = 2\ninertia_g_mm2 = 7\n");
  EXPECT_EQ(s.trajectory.hold_s, 10.0);
  EXPECT_EQ(s.trajectory.load_N, 1.5);
  EXPECT_TRUE(s.trajectory.load_direction.isApprox(Vector3d(0, 0.6, -0.8), 1e-15));
  ASSERT_TRUE(s.spindle);
  EXPECT_DOUBLE_EQ(s.spindle->stall_torque_Nm, 2e-3);
  EXPECT_DOUBLE_EQ(s.spindle->inertia_kg_m2, 7e-9);
  EXPECT_FALSE(parse(least_scene()).spindle);
  EXPECT_FALSE(parse(least_scene()).trajectory.load_N);
}

TEST(SceneFile, ADirectionNeedsItsLoadAndASpindleItsCutting) {
  EXPECT_EQ(
      error_of(least_scene() + "load_direction = [0, 0, -1]\n"),
      "/scenes/s.toml: line 5, column 18, trajectory.load_direction: found a direction without "
      "load_N, expected both of them");
  EXPECT_EQ(
      error_of(least_scene() + "[spindle]\n"),
      "/scenes/s.toml: line 5, column 1, spindle: found [spindle] without [cutting], expected "
      "both, or neither");
}

}  // namespace
}  // namespace sulcus::scene_file_test
