#include "engine/import/volumes/write_volume.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "tests/import/oblique_volume.hpp"
#include "tests/support/filled_model.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/shapes.hpp"

// What is cut lies over the scan: the written volumes are read back and compared with the input.

namespace sulcus::write_volume_test {
namespace {

Scene scene_of(const std::string& file, double solid_above, double voxel_m, int cells) {
  Scene scene;
  scene.tissues = {{.name = "tooth", .above = {}}};
  scene.workpiece.file = file;
  scene.workpiece.solid_above = solid_above;
  scene.workpiece.voxel_m = voxel_m;
  scene.workpiece.cells.setConstant(cells);
  scene.workpiece.position_m = {2e-4, -3e-4, 1e-4};
  scene.workpiece.rotation = {0.5, -0.3, 0.9};
  return scene;
}

Eigen::Vector3d centre_file_mm(const MedicalVolume& v, int i, int j, int k) {
  return (v.origin_m + v.direction * Eigen::Vector3d(i, j, k).cwiseProduct(v.spacing_m)) * 1e3;
}

void for_each_voxel(const MedicalVolume& v, const std::function<void(int, int, int)>& visit) {
  for (int k = 0; k < v.sizes.z(); ++k) {
    for (int j = 0; j < v.sizes.y(); ++j) {
      for (int i = 0; i < v.sizes.x(); ++i) visit(i, j, k);
    }
  }
}

struct Imported {
  VoxelModel model;
  InputGeometry input;
};

Imported imported(const Scene& scene) {
  ImportNotes notes;
  VoxelModel model = build_workpiece(scene, nullptr, &notes);
  return {std::move(model), notes.input.value()};
}

class WriteVolume : public testing::TestWithParam<const char*> {};

TEST_P(WriteVolume, InTheFilesSpaceItLiesOverAnObliqueScanVoxelForVoxel) {
  const ScratchFolder folder;
  test::write_with_itk(folder.path("in.nrrd"), test::plain(test::oblique_volume()));
  const Imported scan =
      imported(scene_of(folder.path("in.nrrd"), test::kObliqueSolidAbove, 6e-5, 96));
  const std::string path = folder.path(std::string("out") + GetParam());
  write_volume_in_file_space(path, scan.model, VolumeContent::kMask, scan.input);
  const MedicalVolume out = read_medical_volume(path);
  ASSERT_EQ(out.sizes, scan.model.grid.cells);
  EXPECT_LT((out.spacing_m.array() - 6e-5).abs().maxCoeff(), 1e-10);
  // Every voxel as it is, and where the solid is in the patient, within half a voxel of the scan
  // (0.15 mm along its coarsest axis) and far less in the mean.
  double sum = 0.0;
  int surface = 0, solid = 0;
  for_each_voxel(out, [&](int i, int j, int k) {
    ASSERT_EQ(out.at(i, j, k), scan.model.solid({i, j, k}) ? 1.0f : 0.0f);
    const double d = test::oblique_distance_mm(centre_file_mm(out, i, j, k));
    ASSERT_LT(out.at(i, j, k) > 0 ? d : -d, 0.15) << i << " " << j << " " << k;
    solid += out.at(i, j, k) > 0;
    if (scan.model.solid({i, j, k}) && !scan.model.solid({i + 1, j, k})) {
      sum += test::oblique_distance_mm(centre_file_mm(out, i, j, k) +
                                       out.direction.col(0) * 0.5 * out.spacing_m.x() * 1e3);
      ++surface;
    }
  });
  EXPECT_GT(solid, 50000);
  EXPECT_NEAR(sum / surface, 0.0, 0.03);
}

TEST_P(WriteVolume, OnTheInputsOwnLatticeItIsTheInputsThreshold) {
  const ScratchFolder folder;
  const MedicalVolume in = test::oblique_volume();
  test::write_with_itk(folder.path("in.nrrd"), test::plain(in));
  const auto [model, input] =
      imported(scene_of(folder.path("in.nrrd"), test::kObliqueSolidAbove, 6e-5, 96));
  const std::string path = folder.path(std::string("out") + GetParam());
  write_volume_on_input(path, model, VolumeContent::kMask, input);
  const MedicalVolume out = read_medical_volume(path);
  ASSERT_EQ(out.sizes, in.sizes);
  EXPECT_LT((out.spacing_m - in.spacing_m).norm(), 1e-9);
  EXPECT_LT((out.origin_m - in.origin_m).norm(), 1e-7);
  EXPECT_LT((out.direction - in.direction).norm(), 1e-6);
  int both = 0, differ = 0;
  for_each_voxel(in, [&](int i, int j, int k) {
    const bool was = in.at(i, j, k) >= test::kObliqueSolidAbove, is = out.at(i, j, k) > 0;
    both += was && is;
    differ += was != is;
    if (was == is) return;
    // Half a voxel along the lattice's axes: 0.05, 0.05 and 0.15 mm.
    const double d = std::abs(test::oblique_distance_mm(centre_file_mm(in, i, j, k)));
    EXPECT_LT(d, 0.15) << i << " " << j << " " << k;
  });
  EXPECT_GT(both, 4000);
  EXPECT_LT(differ, both / 25);
}

INSTANTIATE_TEST_SUITE_P(Formats, WriteVolume, testing::Values(".nrrd", ".mha", ".nii.gz"),
                         [](const auto& format) {
                           std::string name = format.param;
                           std::erase(name, '.');
                           return name;
                         });

TEST(WriteVolumeOnce, FillsAreTheLevelsAndOnACoarserLatticeTheirMean) {
  const ScratchFolder folder;
  const VoxelModel model = test::filled_anyhow(test::random_blobs({24, 16, 32}, 4, 1e-4), 9);
  write_volume(folder.path("grid.nrrd"), model, VolumeContent::kFills);
  const MedicalVolume grid = read_medical_volume(folder.path("grid.nrrd"));
  InputGeometry input;  // twice and three times as coarse, its first voxel in the grid's corner
  const Eigen::Vector3i coarse(2, 2, 3);
  input.sizes = {12, 8, 10};
  input.spacing_m = 1e-4 * coarse.cast<double>();
  input.origin_m = grid.origin_m + 0.5 * (input.spacing_m - grid.spacing_m);
  input.direction.setIdentity();
  write_volume_on_input(folder.path("coarse.nrrd"), model, VolumeContent::kFills, input);
  const MedicalVolume out = read_medical_volume(folder.path("coarse.nrrd"));
  ASSERT_EQ(grid.sizes, model.grid.cells);
  for_each_voxel(grid, [&](int i, int j, int k) {
    ASSERT_EQ(grid.at(i, j, k), model.level({i, j, k})) << i << " " << j << " " << k;
  });
  for_each_voxel(out, [&](int i, int j, int k) {
    int sum = 0;
    for (int v = 0; v < coarse.prod(); ++v) {
      sum += model.level({2 * i + v % 2, 2 * j + v / 2 % 2, 3 * k + v / 4});
    }
    ASSERT_EQ(out.at(i, j, k), std::floor(sum / 12.0 + 0.5)) << i << " " << j << " " << k;
  });
}

TEST(WriteVolumeOnce, AHalfVoxelOffWouldBeSeen) {
  const ScratchFolder folder;
  test::write_with_itk(folder.path("in.nrrd"), test::plain(test::oblique_volume()));
  auto [model, input] =
      imported(scene_of(folder.path("in.nrrd"), test::kObliqueSolidAbove, 6e-5, 96));
  input.file_from_world.translation() += 0.5 * input.direction * input.spacing_m;
  write_volume_in_file_space(folder.path("out.nrrd"), model, VolumeContent::kMask, input);
  const MedicalVolume out = read_medical_volume(folder.path("out.nrrd"));
  double furthest = 0.0;
  for_each_voxel(out, [&](int i, int j, int k) {
    const double d = test::oblique_distance_mm(centre_file_mm(out, i, j, k));
    furthest = std::max(furthest, out.at(i, j, k) > 0 ? d : -d);
  });
  EXPECT_GT(furthest, 0.15);
}

TEST(WriteVolumeOnce, ARealToothLiesOverItsScan) {
  const std::string file = SULCUS_SOURCE_DIR "/../shared/data/ge_tooth/tooth_103x94x161_u16.nrrd";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const ScratchFolder folder;
  const MedicalVolume in = read_medical_volume(file);
  for (const double voxel_m : {1.3e-4, 9e-5}) {
    Scene scene = scene_of(file, 600.0, voxel_m, voxel_m > 1e-4 ? 192 : 248);
    if (voxel_m > 1e-4) scene.workpiece.rotation.setZero();  // the file's own voxels
    if (voxel_m > 1e-4) scene.workpiece.spacing_m = Eigen::Vector3d::Constant(1.3e-4);
    scene.workpiece.position_m.setZero();
    const auto [model, input] = imported(scene);
    write_volume_on_input(folder.path("out.nrrd"), model, VolumeContent::kMask, input);
    const MedicalVolume out = read_medical_volume(folder.path("out.nrrd"));
    ASSERT_EQ(out.sizes, in.sizes);
    int solid = 0, differ = 0, away = 0;
    for_each_voxel(in, [&](int i, int j, int k) {
      const bool was = in.at(i, j, k) >= 600.0f;
      solid += was;
      if (was == (out.at(i, j, k) > 0)) return;
      ++differ;
      // Where the surface passes within half a voxel or so: a neighbour is on its other side.
      bool surface = false;
      for (int n = 0; n < 27; ++n) {
        const int x = i + n % 3 - 1, y = j + n / 3 % 3 - 1, z = k + n / 9 - 1;
        if (x < 0 || y < 0 || z < 0 || x >= in.sizes.x() || y >= in.sizes.y() ||
            z >= in.sizes.z()) {
          continue;
        }
        surface |= (in.at(x, y, z) >= 600.0f) != was;
      }
      away += !surface;
    });
    EXPECT_EQ(solid, 395232);
    EXPECT_EQ(away, 0) << voxel_m;
    if (voxel_m > 1e-4) {
      EXPECT_EQ(differ, 0);  // nothing was resampled
    } else {
      EXPECT_LT(differ, solid / 25);
    }
  }
}

TEST(WriteVolumeOnce, AShearedLatticeIsHeldByNrrdAloneAndRefusedByTheOthers) {
  const ScratchFolder folder;
  Eigen::Matrix3d tilted = test::oblique_direction();
  tilted.col(2) = (tilted.col(2) + 0.27 * tilted.col(1)).normalized();
  const MedicalVolume in = test::oblique_volume(tilted);
  test::write_with_itk(folder.path("in.nrrd"), test::plain(in));
  const auto [model, input] =
      imported(scene_of(folder.path("in.nrrd"), test::kObliqueSolidAbove, 6e-5, 96));
  write_volume_on_input(folder.path("out.nrrd"), model, VolumeContent::kMask, input);
  const MedicalVolume out = read_medical_volume(folder.path("out.nrrd"));
  EXPECT_LT((out.direction - tilted).norm(), 1e-6);
  int solid = 0;
  for_each_voxel(out, [&](int i, int j, int k) {
    const double d = test::oblique_distance_mm(centre_file_mm(out, i, j, k));
    solid += out.at(i, j, k) > 0;
    ASSERT_LT(out.at(i, j, k) > 0 ? d : -d, 0.15) << i << " " << j << " " << k;
  });
  EXPECT_GT(solid, 4000);
  for (const char* name : {"out.mha", "out.nii.gz"}) {
    try {
      write_volume_on_input(folder.path(name), model, VolumeContent::kMask, input);
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("geometry: found axes at 74.89 degrees"),
                std::string::npos)
          << error.what();
    }
    EXPECT_FALSE(std::filesystem::exists(folder.path(name)));
    // The grid's own voxels lie at right angles, whatever the scan's do.
    write_volume_in_file_space(folder.path(name), model, VolumeContent::kMask, input);
  }
}

TEST(WriteVolumeOnce, OtherNamesAreRefused) {
  for (const char* name : {"a.nii", "a.tif", "a", "nrrd", "a.nrrd.bak"}) {
    try {
      check_volume_name(name);
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(".nrrd, .mha or .nii.gz"), std::string::npos);
    }
  }
  EXPECT_NO_THROW(check_volume_name("A.NII.GZ"));
}

TEST(WriteVolumeOnce, AMeshHasNoLattice) {
  VoxelModel model;
  model.grid = {{8, 8, 8}, 1e-4};
  model.leaves.resize(1);
  EXPECT_THROW(write_volume_on_input("never.nrrd", model, VolumeContent::kMask, InputGeometry()),
               InputError);
  InputGeometry huge;
  huge.sizes.setConstant(1 << 24);
  EXPECT_THROW(write_volume_on_input("never.nrrd", model, VolumeContent::kMask, huge), InputError);
}

}  // namespace
}  // namespace sulcus::write_volume_test
