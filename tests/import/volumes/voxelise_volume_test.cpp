#include "engine/import/volumes/voxelise_volume.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/volumes/write_volume.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::voxelise_volume_test {
namespace {

constexpr float kAir = 400.0f, kDentine = 840.0f, kEnamel = 1190.0f;

/// A volume whose grey values are `grey(p)` at p in metres from the middle of the lattice.
template <class Grey>
MedicalVolume sampled(const Eigen::Vector3i& sizes, const Eigen::Vector3d& spacing_m, Grey grey) {
  MedicalVolume volume;
  volume.file = "sampled.nrrd";
  volume.sizes = sizes;
  volume.spacing_m = spacing_m;
  const Eigen::Vector3d middle = 0.5 * (sizes - Eigen::Vector3i::Ones()).cast<double>();
  for (int k = 0; k < sizes.z(); ++k) {
    for (int j = 0; j < sizes.y(); ++j) {
      for (int i = 0; i < sizes.x(); ++i) {
        const Eigen::Vector3d p = (Eigen::Vector3d(i, j, k) - middle).cwiseProduct(spacing_m);
        volume.values.push_back(static_cast<float>(grey(p)));
      }
    }
  }
  return volume;
}

/// From `in` to `out` across a surface at signed distance 0 (negative inside), smeared as a
/// scanner does over about two voxels.
double blurred(double distance, double in, double out, double deviation) {
  return out + (in - out) * 0.5 * std::erfc(distance / (deviation * std::numbers::sqrt2));
}

MedicalVolume sphere(double radius_m, const Eigen::Vector3d& spacing_m,
                     const Eigen::Vector3d& centre_m = Eigen::Vector3d::Zero()) {
  return sampled({40, 40, 40}, spacing_m, [&](const Eigen::Vector3d& p) {
    return blurred((p - centre_m).norm() - radius_m, 1000.0, 0.0, spacing_m.maxCoeff());
  });
}

VoxelGrid grid_of(int cells, double voxel_m) {
  VoxelGrid grid;
  grid.cells = Eigen::Vector3i::Constant(cells);
  grid.voxel_m = voxel_m;
  return grid;
}

WorkpieceSettings above(double value) {
  WorkpieceSettings settings;
  settings.solid_above = value;
  return settings;
}

const std::vector<TissueSettings> kOneTissue = {{.name = "tooth", .above = {}, .file = {}}};

std::vector<TissueSettings> enamel_and_dentine() {
  return {{.name = "dentine", .above = {}, .file = {}},
          {.name = "enamel", .above = 1010.0, .file = {}}};
}

template <class Visit>
void for_each_solid(const VoxelModel& model, Visit visit) {
  for (int k = 0; k < model.grid.cells.z(); ++k) {
    for (int j = 0; j < model.grid.cells.y(); ++j) {
      for (int i = 0; i < model.grid.cells.x(); ++i) {
        if (model.solid({i, j, k})) visit(Cell(i, j, k));
      }
    }
  }
}

bool at_surface(const VoxelModel& model, const Cell& c) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!model.solid(c - Cell::Unit(axis)) || !model.solid(c + Cell::Unit(axis))) return true;
  }
  return false;
}

Eigen::AlignedBox3d bounds_world(const VoxelModel& model) {
  Eigen::AlignedBox3d box;
  for_each_solid(model, [&](const Cell& c) { box.extend(model.grid.centre_world(c)); });
  return box;
}

double volume_m3(const VoxelModel& model) {
  return static_cast<double>(model.solid_count()) * model.grid.voxel_volume_m3();
}

TEST(VoxeliseVolume, AnisotropicSphereKeepsItsVolumeAndPlace) {
  // Off the middle of its file, in voxels of 0.1 x 0.15 x 0.2 mm.
  const double radius = 1.5e-3;
  const MedicalVolume volume = sphere(radius, {1e-4, 1.5e-4, 2e-4}, {0.2e-3, 0.7e-3, -1.1e-3});
  VolumeImportReport report;
  const VoxelModel model =
      voxelise_volume(volume, grid_of(96, 4e-5), above(500), kOneTissue, &report);
  // A kernel of variance s^2 moves the level surface of a ball inwards by s^2 / R; the B-spline's
  // is a third of the spacing's square, here different along each axis.
  const double variance = volume.spacing_m.squaredNorm() / 3.0 / 3.0;
  const double smoothed = radius - variance / radius;
  const double expected = 4.0 / 3.0 * std::numbers::pi * std::pow(smoothed, 3);
  EXPECT_NEAR(volume_m3(model) / expected, 1.0, 0.003);
  const Eigen::AlignedBox3d box = bounds_world(model);
  EXPECT_LT(box.center().norm(), 4e-5);
  EXPECT_NEAR(box.sizes().maxCoeff(), box.sizes().minCoeff(), 2.1 * 4e-5);
  EXPECT_FALSE(model.clipped);
  EXPECT_EQ(model.tissues, nullptr);
  EXPECT_TRUE(report.resampled);
  EXPECT_NEAR(report.greatest, 1000, 1);
}

TEST(VoxeliseVolume, SurfaceIsSmoothBelowAVoxelOfTheFile) {
  // Seven grid voxels to one of the file: no voxel of the surface may be off the sphere by more
  // than a fraction of the file's.
  const double radius = 1.5e-3, spacing = 2e-4, voxel = 3e-5;
  const VoxelModel model = voxelise_volume(sphere(radius, Eigen::Vector3d::Constant(spacing)),
                                           grid_of(112, voxel), above(500), kOneTissue);
  double least = 1.0, most = 0.0;
  for_each_solid(model, [&](const Cell& c) {
    if (!at_surface(model, c)) return;
    const double r = model.grid.centre_world(c).norm();
    least = std::min(least, r);
    most = std::max(most, r);
  });
  // A surface voxel's centre lies up to sqrt(3) voxels inside.
  EXPECT_GT(least, radius - 1.8 * voxel - 0.1 * spacing);
  EXPECT_LT(most, radius + 0.1 * spacing);
}

TEST(VoxeliseVolume, PositionRotationAndDirection) {
  // A bar along the file's x, which its direction lays along y and the scene turns to z.
  MedicalVolume volume =
      sampled({40, 20, 20}, Eigen::Vector3d::Constant(1e-4), [](const Eigen::Vector3d& p) {
        return (p.cwiseAbs().array() < Eigen::Array3d(1.5e-3, 0.5e-3, 0.3e-3)).all() ? 1000.0 : 0.0;
      });
  volume.direction.col(0) = Eigen::Vector3d::UnitY();
  volume.direction.col(1) = -Eigen::Vector3d::UnitX();
  WorkpieceSettings settings = above(500);
  settings.position_m = {0.2e-3, 0, -0.1e-3};
  settings.rotation = {90 * kDegree, 0, 0};
  const Eigen::AlignedBox3d box =
      bounds_world(voxelise_volume(volume, grid_of(96, 4e-5), settings, kOneTissue));
  EXPECT_LT((box.center() - settings.position_m).norm(), 4e-5);
  EXPECT_NEAR(box.sizes().x(), 1.0e-3, 0.1e-3);
  EXPECT_NEAR(box.sizes().y(), 0.6e-3, 0.1e-3);
  EXPECT_NEAR(box.sizes().z(), 3.0e-3, 0.1e-3);
}

TEST(VoxeliseVolume, RotationsGoAboutXThenYThenZ) {
  const MedicalVolume volume =
      sampled({40, 20, 20}, Eigen::Vector3d::Constant(1e-4), [](const Eigen::Vector3d& p) {
        return (p.cwiseAbs().array() < Eigen::Array3d(1.5e-3, 0.5e-3, 0.3e-3)).all() ? 1000.0 : 0.0;
      });
  WorkpieceSettings settings = above(500);
  settings.rotation = {90 * kDegree, 90 * kDegree, 0};
  const Eigen::AlignedBox3d box =
      bounds_world(voxelise_volume(volume, grid_of(96, 4e-5), settings, kOneTissue));
  // About x: y <-> z. Then about y: x <-> z. The other order would end with x, z, y.
  EXPECT_NEAR(box.sizes().x(), 1.0e-3, 0.1e-3);
  EXPECT_NEAR(box.sizes().y(), 0.6e-3, 0.1e-3);
  EXPECT_NEAR(box.sizes().z(), 3.0e-3, 0.1e-3);
}

TEST(VoxeliseVolume, SpacingOfTheSceneOverridesTheFile) {
  const MedicalVolume volume = sphere(1.5e-3, Eigen::Vector3d::Constant(1e-4));
  WorkpieceSettings settings = above(500);
  settings.spacing_m = Eigen::Vector3d(0.5e-4, 1e-4, 1e-4);
  const Eigen::Vector3d size =
      bounds_world(voxelise_volume(volume, grid_of(96, 4e-5), settings, kOneTissue)).sizes();
  EXPECT_NEAR(size.x() / size.y(), 0.5, 0.05);

  MedicalVolume unknown = volume;
  unknown.spacing_known = false;
  EXPECT_NO_THROW(voxelise_volume(unknown, grid_of(96, 4e-5), settings, kOneTissue));
  settings.spacing_m.reset();
  EXPECT_THROW(voxelise_volume(unknown, grid_of(96, 4e-5), settings, kOneTissue), InputError);
}

TEST(VoxeliseVolume, WhatLiesBesidePositionSoThatVoxelsStayWholeIsTold) {
  // 7 x 6 x 9 voxels of the grid's own size, along turned axes.
  MedicalVolume volume = sampled({20, 20, 20}, Eigen::Vector3d::Constant(1e-4),
                                 [](const Eigen::Vector3d&) { return 0.0; });
  volume.direction.col(0) = Eigen::Vector3d::UnitY();
  volume.direction.col(1) = -Eigen::Vector3d::UnitX();
  for (int k = 4; k < 13; ++k) {
    for (int j = 5; j < 11; ++j) {
      for (int i = 6; i < 13; ++i) volume.values[volume.index(i, j, k)] = 1.0f;
    }
  }
  for (const Eigen::Vector3d& position :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2e-4, -1.3e-4, 0.5e-4)}) {
    WorkpieceSettings settings;
    settings.position_m = position;
    VolumeImportReport report;
    const VoxelModel model =
        voxelise_volume(volume, grid_of(48, 1e-4), settings, kOneTissue, &report);
    EXPECT_EQ(model.solid_count(), 7u * 6u * 9u);
    ASSERT_FALSE(report.resampled);
    const Eigen::Vector3d beside = bounds_world(model).center() - position;
    EXPECT_GT(beside.norm(), 1e-5);
    EXPECT_LT((report.beside_m - beside).norm(), 1e-9)
        << report.beside_m.transpose() << ", not " << beside.transpose();
  }
  VolumeImportReport report;
  voxelise_volume(volume, grid_of(48, 0.9e-4), WorkpieceSettings{}, kOneTissue, &report);
  EXPECT_EQ(report.beside_m, Eigen::Vector3d::Zero());  // resampled, and where it is to be
}

TEST(VoxeliseVolume, SpecksAreDroppedFromGreyValuesButNotFromAMask) {
  MedicalVolume volume = sphere(1.2e-3, Eigen::Vector3d::Constant(1e-4));
  volume.values[volume.index(2, 2, 2)] = 1000;
  volume.values[volume.index(37, 30, 3)] = 1000;
  VolumeImportReport report;
  const VoxelModel grey =
      voxelise_volume(volume, grid_of(96, 4e-5), above(500), kOneTissue, &report);
  EXPECT_EQ(report.dropped_components, 2u);
  EXPECT_EQ(report.dropped_voxels, 2u);
  EXPECT_LT(bounds_world(grey).center().norm(), 4e-5);

  for (float& v : volume.values) v = v >= 500 ? 255.0f : 0.0f;
  const VoxelModel mask =
      voxelise_volume(volume, grid_of(48, 1e-4), WorkpieceSettings{}, kOneTissue, &report);
  EXPECT_EQ(report.dropped_components, 0u);
  EXPECT_EQ(mask.solid_count(), report.solid_voxels);
}

TEST(VoxeliseVolume, CoarseMaskIsSmoothed) {
  const double radius = 1.5e-3, spacing = 1.5e-4, voxel = 3e-5;
  MedicalVolume volume = sphere(radius, Eigen::Vector3d::Constant(spacing));
  for (float& v : volume.values) v = v >= 500 ? 1.0f : 0.0f;
  const VoxelModel model =
      voxelise_volume(volume, grid_of(112, voxel), WorkpieceSettings{}, kOneTissue);
  const double exact = 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
  EXPECT_NEAR(volume_m3(model) / exact, 1.0, 0.02);
  // The steps of a mask left as it is reach 0.9 of its voxels.
  for_each_solid(model, [&](const Cell& c) {
    EXPECT_LT(model.grid.centre_world(c).norm(), radius + 0.6 * spacing);
  });
}

TEST(VoxeliseVolume, ExportsComeBackVoxelByVoxel) {
  const ScratchFolder folder;
  const MedicalVolume volume =
      sampled({40, 40, 40}, Eigen::Vector3d::Constant(1e-4), [](const Eigen::Vector3d& p) {
        return p.norm() < 1.5e-3 ? (p.z() > 0 ? 1200.0 : 800.0) : 0.0;
      });
  VoxelModel model = voxelise_volume(volume, grid_of(96, 4e-5), above(500), enamel_and_dentine());
  // A cut that leaves an odd box and loose bits.
  for (int i = 0; i < 96; ++i) {
    for (int j = 40; j < 56; ++j) {
      for (int k = 0; k < 96; ++k) {
        if (k > 70 || i % 5 == 0) model.set({i, j, k}, false);
      }
    }
  }
  const std::string path = folder.path("cut.nrrd");
  write_volume(path, model, VolumeContent::kLabels);
  std::vector<TissueSettings> tissues = enamel_and_dentine();
  tissues[1].above = 2.0;  // a label of the export
  VolumeImportReport report;
  const VoxelModel back =
      voxelise_volume(read_medical_volume(path), model.grid, WorkpieceSettings{}, tissues, &report);
  EXPECT_FALSE(report.resampled);
  EXPECT_EQ(back.solid_count(), model.solid_count());
  // Where it lay, up to the whole voxels by which the box's centre was rounded.
  const Eigen::Vector3d shift =
      (bounds_world(back).center() - bounds_world(model).center()) / model.grid.voxel_m;
  const Cell step = shift.array().round().cast<int>();
  ASSERT_LT((shift - step.cast<double>()).norm(), 1e-6);
  for_each_solid(model, [&](const Cell& c) {
    ASSERT_TRUE(back.solid(c + step)) << c.transpose();
    ASSERT_EQ(back.tissue(c + step), model.tissue(c)) << c.transpose();
  });
}

TEST(VoxeliseVolume, EmptyAndMissedSolidsSayWhatTheyFound) {
  const MedicalVolume volume = sphere(1.2e-3, Eigen::Vector3d::Constant(1e-4));
  try {
    voxelise_volume(volume, grid_of(48, 8e-5), above(5000), kOneTissue);
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("grey values from"), std::string::npos) << text;
    EXPECT_NE(text.find("to 1000"), std::string::npos) << text;
    EXPECT_NE(text.find("at or above 5000"), std::string::npos) << text;
  }
  WorkpieceSettings beside = above(500);
  beside.position_m = {1.0, 0, 0};
  EXPECT_THROW(voxelise_volume(volume, grid_of(48, 8e-5), beside, kOneTissue), InputError);
}

TEST(VoxeliseVolume, ASolidLargerThanTheGridIsClipped) {
  const MedicalVolume volume = sphere(1.2e-3, Eigen::Vector3d::Constant(1e-4));
  EXPECT_TRUE(voxelise_volume(volume, grid_of(48, 4e-5), above(500), kOneTissue).clipped);
  EXPECT_FALSE(voxelise_volume(volume, grid_of(64, 4e-5), above(500), kOneTissue).clipped);
}

TEST(VoxeliseVolume, SolidAtTheFacesOfItsFileEndsThere) {
  const MedicalVolume volume =
      sampled({20, 20, 20}, Eigen::Vector3d::Constant(1e-4),
              [](const Eigen::Vector3d& p) { return std::abs(p.x()) < 0.5e-3 ? 1000.0 : 0.0; });
  const Eigen::Vector3d size =
      bounds_world(voxelise_volume(volume, grid_of(96, 4e-5), above(500), kOneTissue)).sizes();
  EXPECT_NEAR(size.y(), 2e-3, 1e-4);
  EXPECT_NEAR(size.z(), 2e-3, 1e-4);
}

/// Enamel 0.8 mm thick around dentine around a pulp of air, as a scanner blurs them.
MedicalVolume layered_crown() {
  const double spacing = 1.3e-4;
  return sampled({50, 50, 50}, Eigen::Vector3d::Constant(spacing), [&](const Eigen::Vector3d& p) {
    const double r = p.norm();
    return blurred(r - 2.8e-3, kEnamel, kAir, 0.8 * spacing) +
           blurred(r - 2.0e-3, kDentine, kEnamel, 0.8 * spacing) - kEnamel +
           blurred(r - 0.8e-3, kAir, kDentine, 0.8 * spacing) - kDentine;
  });
}

TEST(VoxeliseVolume, PartialVolumeLeavesNoShell) {
  const VoxelModel model =
      voxelise_volume(layered_crown(), grid_of(128, 5e-5), above(600), enamel_and_dentine());
  ASSERT_NE(model.tissues, nullptr);
  std::size_t outer = 0, outer_enamel = 0, inner = 0, inner_dentine = 0;
  double junction_least = 1.0, junction_most = 0.0;
  for_each_solid(model, [&](const Cell& c) {
    const double r = model.grid.centre_world(c).norm();
    const bool enamel = model.tissue(c) == 1;
    if (enamel) junction_least = std::min(junction_least, r);
    if (!enamel && r < 2.6e-3) junction_most = std::max(junction_most, r);
    if (r > 2.4e-3) {
      ++outer;
      outer_enamel += enamel ? 1 : 0;
    }
    if (r < 1.6e-3) {
      ++inner;
      inner_dentine += enamel ? 0 : 1;
    }
  });
  EXPECT_EQ(outer_enamel, outer);
  EXPECT_EQ(inner_dentine, inner);  // the pulp's wall, too
  EXPECT_NEAR(junction_least, 2.0e-3, 1e-4);
  EXPECT_NEAR(junction_most, 2.0e-3, 1e-4);
}

TEST(VoxeliseVolume, TissuesGoByTheHighestThresholdReached) {
  const MedicalVolume volume =
      sampled({40, 40, 40}, Eigen::Vector3d::Constant(1e-4), [](const Eigen::Vector3d& p) {
        if ((p.cwiseAbs().array() > 1.6e-3).any()) return 0.0;
        return p.x() < -0.5e-3 ? 700.0 : p.x() < 0.5e-3 ? 1100.0 : 2000.0;
      });
  // In no order, and one that takes the rest.
  const std::vector<TissueSettings> tissues = {{.name = "enamel", .above = 1000.0, .file = {}},
                                               {.name = "filling", .above = 1800.0, .file = {}},
                                               {.name = "dentine", .above = {}, .file = {}}};
  const VoxelModel model = voxelise_volume(volume, grid_of(96, 4e-5), above(500), tissues);
  const auto at = [&](double x_mm) {
    const Eigen::Vector3d p = model.grid.index_from_world({x_mm * kMillimetre, 0, 0});
    return int{model.tissue(p.array().round().cast<int>())};
  };
  EXPECT_EQ(at(-1.0), 2);
  EXPECT_EQ(at(0.0), 0);
  EXPECT_EQ(at(1.0), 1);
}

TEST(VoxeliseVolume, ThreadsChangeNothing) {
  const MedicalVolume volume = layered_crown();
  const auto made = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return voxelise_volume(volume, grid_of(64, 1e-4), above(600), enamel_and_dentine());
  };
  const VoxelModel one = made(1), two = made(2);
  EXPECT_EQ(one.leaves, two.leaves);
  for_each_solid(one, [&](const Cell& c) { ASSERT_EQ(one.tissue(c), two.tissue(c)); });
}

TEST(VoxeliseVolume, RealTooth) {
  const std::string path = SULCUS_SOURCE_DIR "/../shared/data/ge_tooth/tooth_103x94x161_u16.nrrd";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  VolumeImportReport report;
  const VoxelModel model = voxelise_volume(read_medical_volume(path), grid_of(192, 1.2e-4),
                                           above(600), enamel_and_dentine(), &report);
  EXPECT_EQ(report.solid_voxels, 395232u);
  EXPECT_EQ(report.dropped_components, 0u);
  EXPECT_FALSE(model.clipped);
  EXPECT_NEAR(volume_m3(model), 868e-9, 0.01 * 868e-9);
  EXPECT_LT(bounds_world(model).center().cwiseAbs().maxCoeff(), 1.3e-4);

  std::size_t enamel = 0, crown = 0, crown_enamel = 0, root = 0, root_dentine = 0;
  for_each_solid(model, [&](const Cell& c) {
    const bool is_enamel = model.tissue(c) == 1;
    enamel += is_enamel ? 1 : 0;
    if (!at_surface(model, c)) return;
    const double z_mm = model.grid.centre_world(c).z() / kMillimetre;
    if (z_mm > 5.0) {  // above the neck, where there is no pulp
      ++crown;
      crown_enamel += is_enamel ? 1 : 0;
    } else if (z_mm < 0.0) {
      ++root;
      root_dentine += is_enamel ? 0 : 1;
    }
  });
  // 24 % by thresholds alone; the shell that they call dentine makes the rest.
  const double share = static_cast<double>(enamel) / static_cast<double>(model.solid_count());
  EXPECT_GT(share, 0.24);
  EXPECT_LT(share, 0.32);
  EXPECT_GT(static_cast<double>(crown_enamel), 0.98 * static_cast<double>(crown));
  EXPECT_GT(static_cast<double>(root_dentine), 0.98 * static_cast<double>(root));
}

}  // namespace
}  // namespace sulcus::voxelise_volume_test
