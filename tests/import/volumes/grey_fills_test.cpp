#include "engine/import/volumes/grey_fills.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/import/volumes/voxelise_volume.hpp"
#include "tests/support/fills.hpp"

// Fill levels from grey values, through the importer: volumes as a scanner averages them, made by
// counting points in each voxel.

namespace sulcus::grey_fills_test {
namespace {

using Eigen::Vector3d;
using test::share;

constexpr double kAir = 400.0, kTooth = 900.0, kHalf = 650.0, kSpacing = 1e-4;
constexpr int kCells = 56;
const std::vector<TissueSettings> kOneTissue = {{.name = "tooth", .above = {}, .file = {}}};

/// The share of the voxel around `middle` that is inside, by 8^3 points. A solid has nothing
/// thinner than 3 voxels here: where 27 points that far around are all alike, so is what lies
/// between.
template <class Inside>
double averaged_share(const Inside& inside, const Vector3d& middle) {
  constexpr int kParts = 8, kAround = 3;
  int around = 0, in = 0;
  for_each_cell(Cell::Constant(-1), Cell::Constant(2), [&](const Cell& to) {
    around += inside(Vector3d(middle + 1.5 * to.cast<double>())) ? 1 : 0;
  });
  if (around == 0 || around == kAround * kAround * kAround) return around > 0 ? 1.0 : 0.0;
  for_each_cell(Cell::Zero(), Cell::Constant(kParts), [&](const Cell& part) {
    const Vector3d to = (part.cast<double>().array() + 0.5) / kParts - 0.5;
    in += inside(Vector3d(middle + to)) ? 1 : 0;
  });
  return in / double(kParts * kParts * kParts);
}

/// Grey values of 56^3 voxels, each the mean over 8^3 points of what `inside(p)` says, p in voxels
/// from the middle; with noise of a deviation.
template <class Inside>
MedicalVolume averaged(const Inside& inside, double noise = 0.0) {
  MedicalVolume volume;
  volume.file = "averaged.nrrd";
  volume.sizes = Eigen::Vector3i::Constant(kCells);
  volume.spacing_m = Vector3d::Constant(kSpacing);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for_each_cell(Cell::Zero(), volume.sizes, [&](const Cell& c) {
    const Vector3d middle = c.cast<double>() - Vector3d::Constant(0.5 * (kCells - 1));
    const double grey = kAir + (kTooth - kAir) * averaged_share(inside, middle);
    volume.values.push_back(static_cast<float>(grey + noise * normal(random)));
  });
  return volume;
}

WorkpieceSettings settings_of(SurfaceKind surface, std::optional<double> above = kHalf) {
  WorkpieceSettings settings;
  settings.solid_above = above;
  settings.surface = surface;
  return settings;
}

VoxelModel loaded(const MedicalVolume& volume, SurfaceKind surface, int cells = kCells,
                  double voxel_m = kSpacing) {
  return voxelise_volume(volume, {Eigen::Vector3i::Constant(cells), voxel_m}, settings_of(surface),
                         kOneTissue);
}

/// Where a block begins in the columns along z that lie within `within` of the middle: their
/// sums, against the height that is true of them, less the mean (a solid is placed to whole
/// voxels). Root mean square in voxels.
template <class Height>
double error_of_columns(const VoxelModel& model, double within, const Height& height) {
  std::vector<double> errors;
  double mean = 0.0;
  for (int j = 0; j < model.grid.cells.y(); ++j) {
    for (int i = 0; i < model.grid.cells.x(); ++i) {
      const Eigen::Vector2d p(i - 0.5 * (model.grid.cells.x() - 1),
                              j - 0.5 * (model.grid.cells.y() - 1));
      if (p.norm() > within) continue;
      double sum = 0.0;
      for (int k = 0; k < model.grid.cells.z(); ++k) sum += share(model, {i, j, k});
      errors.push_back(sum - height(p));
      mean += errors.back();
    }
  }
  mean /= static_cast<double>(errors.size());
  double squares = 0.0;
  for (const double e : errors) squares += (e - mean) * (e - mean);
  EXPECT_GT(errors.size(), 300u);
  return std::sqrt(squares / static_cast<double>(errors.size()));
}

/// A block with a flat bottom on a face of voxels and a tilted top.
struct TiltedBlock {
  double dx, dy;
  double top(double x, double y) const { return 5.2 + dx * x + dy * y; }
  bool operator()(const Vector3d& p) const {
    return std::abs(p.x()) < 20 && std::abs(p.y()) < 20 && p.z() > -20 && p.z() < top(p.x(), p.y());
  }
};

TEST(GreyFills, PlanesLieWhereTheyAre) {
  for (const auto& [dx, dy] : {std::pair{0.01, 0.02}, {0.1, -0.05}, {0.35, 0.2}, {-0.6, 0.3}}) {
    const TiltedBlock block{dx, dy};
    const auto height = [&](const Eigen::Vector2d& p) { return block.top(p.x(), p.y()); };
    for (const double noise : {0.0, 15.0}) {
      const MedicalVolume volume = averaged(block, noise);
      const double fine = error_of_columns(loaded(volume, SurfaceKind::kFractions), 13.0, height);
      const double coarse = error_of_columns(loaded(volume, SurfaceKind::kBinary), 13.0, height);
      EXPECT_LT(fine, noise > 0.0 ? 0.045 : 0.04) << dx << ' ' << dy << ' ' << noise;
      EXPECT_GT(coarse, 0.15) << dx << ' ' << dy << ' ' << noise;
    }
  }
}

TEST(GreyFills, ABallLiesWhereItIs) {
  const double radius = 20.3;
  const MedicalVolume volume = averaged([&](const Vector3d& p) { return p.norm() < radius; }, 15.0);
  const auto height = [&](const Eigen::Vector2d& p) {
    return 2.0 * std::sqrt(radius * radius - p.squaredNorm());
  };
  // Two faces in each column.
  const double both = std::numbers::sqrt2;
  const VoxelModel filled = loaded(volume, SurfaceKind::kFractions);
  EXPECT_LT(error_of_columns(filled, 14.0, height) / both, 0.04);
  EXPECT_GT(error_of_columns(loaded(volume, SurfaceKind::kBinary), 14.0, height) / both, 0.2);
  // The kernel moves the surface inwards by 1 / (3 R), and so does the averaging by 1 / (12 R).
  const double moved = radius - (1.0 / 3.0 + 1.0 / 12.0) / radius;
  EXPECT_NEAR(test::filled_voxels_of(filled) / (4.0 / 3.0 * std::numbers::pi * std::pow(moved, 3)),
              1.0, 1e-3);
}

TEST(GreyFills, OnAFinerGridToo) {
  const double radius = 20.3, voxel_m = 0.43e-4;
  const MedicalVolume volume = averaged([&](const Vector3d& p) { return p.norm() < radius; });
  const double moved = (radius - (1.0 / 3.0 + 1.0 / 12.0) / radius) * kSpacing;
  const double exact = 4.0 / 3.0 * std::numbers::pi * std::pow(moved, 3);
  const VoxelModel filled = loaded(volume, SurfaceKind::kFractions, 104, voxel_m);
  EXPECT_NEAR(test::filled_m3(filled) / exact, 1.0, 5e-4);
  const auto height = [&](const Eigen::Vector2d& p) {
    return 2.0 * std::sqrt(std::pow(moved / voxel_m, 2) - p.squaredNorm());
  };
  // In voxels of the file.
  const double each = voxel_m / kSpacing / std::numbers::sqrt2;
  EXPECT_LT(error_of_columns(filled, 32.0, height) * each, 0.04);
  const VoxelModel whole = loaded(volume, SurfaceKind::kBinary, 104, voxel_m);
  EXPECT_GT(error_of_columns(whole, 32.0, height) * each, 0.1);
}

/// Every voxel that is not as in binary, or in part, has voxels of both kinds around it there, and
/// nothing that is solid there is lost.
void expect_only_beside_the_surface(const MedicalVolume& volume, double above) {
  const VoxelGrid grid{Eigen::Vector3i::Constant(kCells), kSpacing};
  const VoxelModel whole =
      voxelise_volume(volume, grid, settings_of(SurfaceKind::kBinary, above), kOneTissue);
  const VoxelModel filled =
      voxelise_volume(volume, grid, settings_of(SurfaceKind::kFractions, above), kOneTissue);
  const auto beside = [&](const Cell& c, bool solid) {
    return any_cell(Cell::Constant(-1), Cell::Constant(2), [&](const Cell& to) {
      return grid.contains(c + to) && whole.solid(c + to) == solid;
    });
  };
  int changed = 0, alone = 0, lost = 0;
  for_each_cell(Cell::Zero(), grid.cells, [&](const Cell& c) {
    lost += whole.solid(c) && !filled.solid(c) ? 1 : 0;
    if (filled.level(c) == (whole.solid(c) ? kFullLevel : 0)) return;
    ++changed;
    alone += beside(c, true) && beside(c, false) ? 0 : 1;
  });
  EXPECT_EQ(alone, 0) << above;
  EXPECT_EQ(lost, 0) << above;
  EXPECT_GT(changed, 1000) << above;
}

TEST(GreyFills, OnlyWhatIsNextToTheSurfaceIsTouched) {
  const auto ball = [](const Vector3d& p) { return p.norm() < 18.0; };
  // One voxel in 40 of the air is above, and of the tooth below.
  expect_only_beside_the_surface(averaged(ball, 125.0), kHalf);
  // The kernel's surface lies deep under the voxels that are above.
  expect_only_beside_the_surface(averaged(ball, 0.1), 899.5);
}

TEST(GreyFills, AMaskIsFullAndAsEver) {
  MedicalVolume volume = averaged([](const Vector3d& p) { return p.norm() < 18.0; });
  for (float& v : volume.values) v = v >= kHalf ? (v < kTooth ? 1.0f : 2.0f) : 0.0f;
  std::vector<TissueSettings> tissues = {{.name = "rind", .above = {}, .label = 1, .file = {}},
                                         {.name = "core", .above = {}, .label = 2, .file = {}}};
  // The lattice's own voxels, and others.
  for (const double voxel_m : {kSpacing, 0.8 * kSpacing}) {
    const VoxelGrid grid{Eigen::Vector3i::Constant(64), voxel_m};
    const VoxelModel whole =
        voxelise_volume(volume, grid, settings_of(SurfaceKind::kBinary, {}), tissues);
    const VoxelModel filled =
        voxelise_volume(volume, grid, settings_of(SurfaceKind::kFractions, {}), tissues);
    EXPECT_FALSE(whole.fills);
    ASSERT_TRUE(filled.fills);
    EXPECT_TRUE(filled.fills->pages().empty());
    EXPECT_EQ(whole.leaves, filled.leaves);
    for_each_cell(Cell::Zero(), grid.cells,
                  [&](const Cell& c) { ASSERT_EQ(whole.tissue(c), filled.tissue(c)); });
  }
}

TEST(GreyFills, WhatIsAddedIsOfTheTissueBeneath) {
  // Enamel above z = 0, dentine below, both beside air: none is dentine for its partial volume.
  MedicalVolume volume = averaged([](const Vector3d& p) { return p.norm() < 18.0; });
  std::size_t v = 0;
  for_each_cell(Cell::Zero(), volume.sizes, [&](const Cell& c) {
    float& grey = volume.values[v++];
    if (c.z() >= kCells / 2) grey += 0.6f * (grey - static_cast<float>(kAir));
  });
  const std::vector<TissueSettings> tissues = {{.name = "dentine", .above = {}, .file = {}},
                                               {.name = "enamel", .above = 1050.0, .file = {}}};
  const VoxelGrid grid{Eigen::Vector3i::Constant(kCells), kSpacing};
  const VoxelModel whole =
      voxelise_volume(volume, grid, settings_of(SurfaceKind::kBinary), tissues);
  const VoxelModel filled =
      voxelise_volume(volume, grid, settings_of(SurfaceKind::kFractions), tissues);
  int added = 0;
  for_each_cell(Cell::Zero(), grid.cells, [&](const Cell& c) {
    if (!filled.solid(c)) return;
    if (whole.solid(c)) {
      ASSERT_EQ(filled.tissue(c), whole.tissue(c)) << c.transpose();
    } else if (std::abs(c.z() - kCells / 2) > 4) {
      ++added;
      ASSERT_EQ(filled.tissue(c), c.z() > kCells / 2 ? 1 : 0) << c.transpose();
    }
  });
  EXPECT_GT(added, 300);
}

TEST(GreyFills, ThreadsDoNotMatter) {
  const MedicalVolume volume = averaged([](const Vector3d& p) { return p.norm() < 18.0; }, 15.0);
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return loaded(volume, SurfaceKind::kFractions, 72, 0.7e-4);
  };
  test::expect_same_levels(with_threads(1), with_threads(4));
}

TEST(GreyFills, TheRampIsTheSlopeAtTheSurface) {
  // Smeared by a normal distribution of one voxel, to which the kernel's is added.
  const Eigen::Vector3i sizes(24, 16, 16);
  std::vector<float> values;
  for_each_cell(Cell::Zero(), sizes, [&](const Cell& c) {
    const double depth = c.x() - 11.3;
    values.push_back(
        static_cast<float>(kAir + (kTooth - kAir) * 0.5 * std::erfc(-depth / std::numbers::sqrt2)));
  });
  const double slope = (kTooth - kAir) / std::sqrt(2.0 * std::numbers::pi * (1.0 + 1.0 / 3.0));
  const auto [low, high] = grey_ramp(values, sizes, static_cast<float>(kHalf));
  EXPECT_NEAR(low, kHalf - 0.5 * slope, 0.02 * slope);
  EXPECT_NEAR(high, kHalf + 0.5 * slope, 0.02 * slope);
  const auto none = grey_ramp(values, sizes, 2000.0f);
  EXPECT_EQ(none[0], 2000.0);
  EXPECT_EQ(none[1], 2000.0);
}

}  // namespace
}  // namespace sulcus::grey_fills_test
