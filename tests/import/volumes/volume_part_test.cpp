#include "engine/import/volumes/volume_part.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/import/volumes/voxelise_volume.hpp"
#include "tests/import/oblique_volume.hpp"

namespace sulcus::volume_part_test {
namespace {

const std::vector<TissueSettings> kOneTissue = {{.name = "tooth", .above = {}}};
const std::vector<TissueSettings> kLabelled = {{.name = "enamel", .above = {}, .label = 7},
                                               {.name = "dentine", .above = {}, .label = 3}};

/// Three bars along y in a lattice of 0.2 mm, each 6 x 20 x 6 voxels and 4 apart: grey 1000 in air
/// of 100, with a rim of 600; `values`: of a label map instead.
MedicalVolume bars(const std::vector<float>& values = {}) {
  MedicalVolume volume;
  volume.file = values.empty() ? "bars.nrrd" : "labels.nrrd";
  volume.sizes = {40, 30, 16};
  volume.spacing_m.setConstant(2e-4);
  volume.origin_m = {0.01, -0.02, 0.03};
  volume.values.assign(40 * 30 * 16, values.empty() ? 100.0f : 0.0f);
  for (int bar = 0; bar < 3; ++bar) {
    for (int k = 4; k < 12; ++k) {
      for (int j = 4; j < 26; ++j) {
        for (int i = 4 + 10 * bar; i < 12 + 10 * bar; ++i) {
          const bool rim =
              k == 4 || k == 11 || j == 4 || j == 25 || i == 4 + 10 * bar || i == 11 + 10 * bar;
          float& v = volume.values[volume.index(i, j, k)];
          if (values.empty()) {
            v = rim ? 600.0f : 1000.0f;
          } else if (!rim) {
            v = values[bar];
          }
        }
      }
    }
  }
  return volume;
}
constexpr std::uint64_t kBarVoxels = 6 * 20 * 6;

WorkpieceSettings above(double value) {
  WorkpieceSettings settings;
  settings.solid_above = value;
  return settings;
}

struct Result {
  VoxelModel model;
  VolumeImportReport report;
  std::vector<std::string> warnings;
};

/// On a grid that is the file's lattice.
Result taken(const MedicalVolume& volume, const WorkpieceSettings& settings,
             const std::vector<TissueSettings>& tissues = kOneTissue,
             const MedicalVolume* labels = nullptr) {
  Result result;
  const MedicalVolume part = take_part(volume, labels, settings, tissues, result.warnings);
  const VoxelGrid grid{{48, 48, 48}, 2e-4};
  result.model = voxelise_volume(part, grid, settings, tissues, &result.report);
  return result;
}

std::string error_of(const MedicalVolume& volume, const WorkpieceSettings& settings,
                     const std::vector<TissueSettings>& tissues = kOneTissue,
                     const MedicalVolume* labels = nullptr) {
  try {
    (void)taken(volume, settings, tissues, labels);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// In the middle of the solid's box, in the file's space, mm.
Eigen::Vector3d middle_file_mm(const Result& result) {
  Eigen::AlignedBox3d box;
  for (std::uint32_t v = 0; v < result.model.grid.cell_count(); ++v) {
    const Cell c = result.model.grid.cell_of_linear(v);
    if (result.model.solid(c)) {
      box.extend(result.report.file_from_world * result.model.grid.centre_world(c));
    }
  }
  return box.center() * 1e3;
}

// The bar's middle lies at (i, 14.5, 7.5) of the lattice.
const Eigen::Vector3d kSecondBar_mm{10 + 0.2 * 17.5, -20 + 0.2 * 14.5, 30 + 0.2 * 7.5};

TEST(VolumePart, ABoxTakesOneToothOutOfARow) {
  WorkpieceSettings settings = above(800);
  const Eigen::Vector3d half(0.9, 3, 1);
  settings.box_file =
      Eigen::AlignedBox3d((kSecondBar_mm - half) * 1e-3, (kSecondBar_mm + half) * 1e-3);
  const Result result = taken(bars(), settings);
  EXPECT_EQ(result.report.solid_voxels, kBarVoxels);
  EXPECT_EQ(result.model.solid_count(), kBarVoxels);
  EXPECT_LT((middle_file_mm(result) - kSecondBar_mm).norm(), 1e-9);
  EXPECT_TRUE(result.warnings.empty());

  // Through its middle: half of it.
  settings.box_file->max().x() = kSecondBar_mm.x() * 1e-3;
  EXPECT_EQ(taken(bars(), settings).model.solid_count(), kBarVoxels / 2);
}

TEST(VolumePart, OfAnObliqueLatticeTheBoxIsTheFilesSpaceNotItsAxes) {
  WorkpieceSettings settings = above(test::kObliqueSolidAbove);
  settings.box_file =
      Eigen::AlignedBox3d((test::kObliqueMiddle_mm - Eigen::Vector3d(0.7, 0.8, 0.5)) * 1e-3,
                          (test::kObliqueMiddle_mm + Eigen::Vector3d(0.2, 0.3, 0.9)) * 1e-3);
  std::vector<std::string> warnings;
  const MedicalVolume part =
      take_part(test::oblique_volume(), nullptr, settings, kOneTissue, warnings);
  int inside = 0, outside = 0;
  for (int k = 0; k < part.sizes.z(); ++k) {
    for (int j = 0; j < part.sizes.y(); ++j) {
      for (int i = 0; i < part.sizes.x(); ++i) {
        const Eigen::Vector3d p_file =
            part.origin_m + part.direction * Eigen::Vector3d(i, j, k).cwiseProduct(part.spacing_m);
        const bool solid = part.at(i, j, k) >= test::kObliqueSolidAbove;
        ASSERT_EQ(solid, settings.box_file->contains(p_file) &&
                             test::oblique_distance_mm(p_file * 1e3) <= 1e-3)
            << i << " " << j << " " << k;
        ++(solid ? inside : outside);
      }
    }
  }
  EXPECT_GT(inside, 100);
  EXPECT_GT(outside, 100);
}

TEST(VolumePart, ALabelTakesOneToothOfGreyValues) {
  WorkpieceSettings settings = above(800);
  settings.label = 19;
  settings.labels = "labels.nrrd";
  const MedicalVolume labels = bars({18, 19, 20});
  const Result result = taken(bars(), settings, kOneTissue, &labels);
  EXPECT_EQ(result.model.solid_count(), kBarVoxels);
  EXPECT_LT((middle_file_mm(result) - kSecondBar_mm).norm(), 1e-9);

  settings.label = 21;
  EXPECT_EQ(error_of(bars(), settings, kOneTissue, &labels),
            "labels.nrrd: label: found no voxel of value 21, expected one of 18, 19, 20");
}

TEST(VolumePart, ALabelOfTheFileItself) {
  WorkpieceSettings settings;
  settings.label = 19;
  EXPECT_EQ(taken(bars({18, 19, 20}), settings).model.solid_count(), kBarVoxels);
}

TEST(VolumePart, LabelsOnAnotherLatticeAreRefused) {
  WorkpieceSettings settings = above(800);
  settings.label = 19;
  const auto error_with = [&](const auto& change) {
    MedicalVolume labels = bars({18, 19, 20});
    change(labels);
    return error_of(bars(), settings, kOneTissue, &labels);
  };
  EXPECT_EQ(error_with([](MedicalVolume&) {}), "no error");
  // As NIfTI's single precision has it.
  EXPECT_EQ(error_with([](MedicalVolume& v) { v.origin_m.x() += 1e-8; }), "no error");
  EXPECT_EQ(error_with([](MedicalVolume& v) { v.origin_m.x() += 1e-4; }),
            "labels.nrrd: origin: found 10.1, -20, 30, expected 10, -20, 30, that of bars.nrrd");
  EXPECT_EQ(error_with([](MedicalVolume& v) { v.spacing_m.y() = 3e-4; }),
            "labels.nrrd: spacing: found 0.2, 0.3, 0.2, expected 0.2, 0.2, 0.2, that of bars.nrrd");
  EXPECT_NE(error_with([](MedicalVolume& v) {
              v.direction = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
            }).find("labels.nrrd: direction: "),
            std::string::npos);
  EXPECT_EQ(error_with([](MedicalVolume& v) {
              v.sizes.z() -= 1;
              v.values.resize(40 * 30 * 15);
            }),
            "labels.nrrd: sizes: found 40, 30, 15, expected 40, 30, 16, those of bars.nrrd");
}

/// `labels` on its own lattice with other axes: axis d runs along `axes[d]`, where `down[d]` the
/// other way; values by place, one after the other.
MedicalVolume with_axes(const MedicalVolume& labels, const std::array<int, 3>& axes,
                        const std::array<bool, 3>& down) {
  MedicalVolume turned = labels;
  turned.values.clear();
  turned.origin_m = labels.origin_m;
  for (int d = 0; d < 3; ++d) {
    const int axis = axes[d];
    turned.sizes[d] = labels.sizes[axis];
    turned.spacing_m[d] = labels.spacing_m[axis];
    turned.direction.col(d) = labels.direction.col(axis) * (down[d] ? -1.0 : 1.0);
    if (down[d]) {
      turned.origin_m +=
          labels.direction.col(axis) * labels.spacing_m[axis] * (labels.sizes[axis] - 1);
    }
  }
  for (int k = 0; k < turned.sizes.z(); ++k) {
    for (int j = 0; j < turned.sizes.y(); ++j) {
      for (int i = 0; i < turned.sizes.x(); ++i) {
        const Eigen::Vector3d p_file =
            turned.origin_m +
            turned.direction * Eigen::Vector3d(i, j, k).cwiseProduct(turned.spacing_m);
        const Eigen::Vector3d p = (labels.direction.inverse() * (p_file - labels.origin_m))
                                      .cwiseQuotient(labels.spacing_m);
        turned.values.push_back(labels.at(static_cast<int>(std::lround(p.x())),
                                          static_cast<int>(std::lround(p.y())),
                                          static_cast<int>(std::lround(p.z()))));
      }
    }
  }
  return turned;
}

TEST(VolumePart, LabelsWhoseAxesAreTurnedAreMatchedByPlace) {
  WorkpieceSettings settings = above(800);
  settings.label = 19;
  MedicalVolume volume = bars(), labels = bars({18, 19, 20});
  for (MedicalVolume* v : {&volume, &labels}) {
    v->spacing_m = {2e-4, 2e-4, 2e-4};
    v->direction = test::oblique_direction();
  }
  // No symmetry hides a wrong turn: one corner of the second bar is another's.
  labels.values[labels.index(16, 6, 5)] = 20;
  const Result expected = taken(volume, settings, kOneTissue, &labels);
  ASSERT_EQ(expected.report.solid_voxels, kBarVoxels - 1);
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (int senses = 0; senses < 8; ++senses) {
      const std::array<bool, 3> down{(senses & 1) != 0, (senses & 2) != 0, (senses & 4) != 0};
      MedicalVolume turned = with_axes(labels, axes, down);
      EXPECT_EQ(taken(volume, settings, kOneTissue, &turned).model.leaves, expected.model.leaves)
          << axes[0] << axes[1] << axes[2] << " " << senses;
      turned.origin_m.x() += 1e-4;
      EXPECT_NE(error_of(volume, settings, kOneTissue, &turned).find("labels.nrrd: origin: "),
                std::string::npos);
    }
  } while (std::ranges::next_permutation(axes).found);
}

TEST(VolumePart, TissuesByLabelAndWhatHasNoneIsLeftOutAndSaid) {
  const Result result = taken(bars({3, 5, 7}), {}, kLabelled);
  EXPECT_EQ(result.model.solid_count(), 2 * kBarVoxels);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_NE(result.warnings[0].find("left out: 5"), std::string::npos) << result.warnings[0];
  std::array<std::uint64_t, 2> voxels{};
  for (std::uint32_t v = 0; v < result.model.grid.cell_count(); ++v) {
    const Cell c = result.model.grid.cell_of_linear(v);
    if (result.model.solid(c)) ++voxels[result.model.tissue(c)];
  }
  EXPECT_EQ(voxels[0], kBarVoxels);
  EXPECT_EQ(voxels[1], kBarVoxels);

  EXPECT_EQ(
      error_of(bars({1, 2, 2}), {}, kLabelled),
      "labels.nrrd: label: found no voxel whose value a [[tissue]] has, expected label = 1, 2");
}

// Between 1 and 9 lies 5, which is another tissue: no voxel may become that.
TEST(VolumePart, LabelsAreNeverMixedIntoOthers) {
  MedicalVolume map = bars({1, 1, 1});
  for (int k = 0; k < 16; ++k) {
    for (int j = 0; j < 30; ++j) {
      for (int i = 0; i < 8; ++i) {
        float& v = map.values[map.index(i, j, k)];
        if (v != 0.0f) v = 9.0f;
      }
    }
  }
  const std::vector<TissueSettings> tissues = {{.name = "a", .above = {}, .label = 9},
                                               {.name = "b", .above = {}, .label = 5},
                                               {.name = "c", .above = {}, .label = 1}};
  WorkpieceSettings settings;
  settings.rotation = {0.2, 0.3, 0.4};
  std::vector<std::string> warnings;
  const MedicalVolume part = take_part(map, nullptr, settings, tissues, warnings);
  const VoxelGrid grid{{96, 96, 96}, 8e-5};
  const VoxelModel model = voxelise_volume(part, grid, settings, tissues);
  std::array<std::uint64_t, 3> voxels{};
  for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
    const Cell c = grid.cell_of_linear(v);
    if (model.solid(c)) ++voxels[model.tissue(c)];
  }
  const double per_voxel = 2.5 * 2.5 * 2.5;
  const auto first = static_cast<double>(voxels[0]);
  EXPECT_NEAR(first, per_voxel * static_cast<double>(kBarVoxels) / 2, 0.06 * first);
  EXPECT_EQ(voxels[1], 0u);
  EXPECT_GT(voxels[2], voxels[0]);
}

TEST(VolumePart, ABoxBesideTheVolumeSaysWhereItLies) {
  WorkpieceSettings settings = above(800);
  settings.box_file =
      Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e-3, 1e-3, 1e-3));
  EXPECT_EQ(error_of(bars(), settings),
            "bars.nrrd: box_mm: found [0, 0, 0, 1, 1, 1], without a voxel of it, expected a box "
            "within [10, -20, 30, 17.8, -14.2, 33]");
  // In the volume, and only air.
  settings.box_file = Eigen::AlignedBox3d(Eigen::Vector3d(0.01, -0.02, 0.03),
                                          Eigen::Vector3d(0.0105, -0.0195, 0.0305));
  EXPECT_NE(
      error_of(bars(), settings).find("found grey values from 100 to 100 in box_mm, expected some"),
      std::string::npos)
      << error_of(bars(), settings);
}

}  // namespace
}  // namespace sulcus::volume_part_test
