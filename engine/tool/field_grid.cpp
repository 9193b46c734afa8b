#include "engine/tool/field_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"

namespace sulcus {
namespace {

constexpr int kMinSamples = 8, kMaxSamples = 1024;             // along an axis
constexpr std::int64_t kMaxTotal = std::int64_t{1} << 27;      // 512 MiB of floats
constexpr std::int64_t kMaxTotalAuto = std::int64_t{1} << 25;  // 128 MiB
constexpr double kMinAcrossHead = 4.0;                         // samples
constexpr double kAutoAcrossHead = 16.0;                       // samples
constexpr double kAutoError = 1.0 / 512.0;                     // voxels

std::string text(const char* format, double a, double b = 0.0, double c = 0.0) {
  char buffer[128];
  std::snprintf(buffer, sizeof buffer, format, a, b, c);
  return buffer;
}

std::string samples_text(const Eigen::Vector3d& n) {
  return text("%.0f x %.0f x %.0f samples", n.x(), n.y(), n.z());
}

std::string box_text(const Eigen::Vector3d& size_m) {
  const Eigen::Vector3d mm = size_m / kMillimetre;
  return text("%.4g x %.4g x %.4g mm", mm.x(), mm.y(), mm.z());
}

/// Samples that hold `extent` and its margin, per axis; as doubles, since they may be absurdly
/// many.
Eigen::Vector3d samples_needed(const Eigen::Vector3d& extent, double spacing) {
  // A hair less, so that an extent that is a whole number of cells does not take one more.
  const Eigen::Vector3d cells = (extent.array() / spacing - 1e-9).ceil();
  return (cells.array() + (2 * kFieldMargin + 1)).max(kMinSamples);
}

bool fits(const Eigen::Vector3d& samples, std::int64_t total) {
  return samples.maxCoeff() <= kMaxSamples && samples.prod() <= static_cast<double>(total);
}

/// Spacing at which the samples just hold the burr and its margin.
double finest_spacing(const Eigen::Vector3d& extent, const Eigen::Vector3i& samples) {
  const Eigen::Vector3d cells = samples.cast<double>().array() - (2 * kFieldMargin + 1);
  return (extent.array() / cells.array()).maxCoeff();
}

double auto_spacing(const Eigen::Vector3d& extent, double head_diameter, double voxel) {
  const double flat = std::sqrt(4.0 * head_diameter * kAutoError * voxel);
  double spacing = std::min({voxel, flat, head_diameter / kAutoAcrossHead});
  while (!fits(samples_needed(extent, spacing), kMaxTotalAuto)) spacing *= 1.02;
  return spacing;
}

}  // namespace

FieldGrid plan_field(const BurrSettings& settings, const Eigen::AlignedBox3d& bounds_tool,
                     double head_diameter_m, double voxel_m, std::string_view scene_file) {
  const Eigen::Vector3d extent = bounds_tool.sizes();
  FieldGrid grid;

  if (settings.field_samples) {
    grid.samples = *settings.field_samples;
    const Eigen::Vector3d samples = grid.samples.cast<double>();
    if (grid.samples.minCoeff() < kMinSamples || !fits(samples, kMaxTotal)) {
      throw InputError(scene_file, "burr.field", samples_text(samples),
                       text("%.0f to %.0f along each axis and at most %.0f in all", kMinSamples,
                            kMaxSamples, static_cast<double>(kMaxTotal)));
    }
  }

  const char* place = "burr.field";
  if (settings.field_spacing_m) {
    place = "burr.field_spacing_mm";
    grid.spacing_m = *settings.field_spacing_m;
    if (!(grid.spacing_m > 0.0) || !std::isfinite(grid.spacing_m)) {
      throw InputError(scene_file, place, text("%g mm", grid.spacing_m / kMillimetre),
                       "more than 0 mm");
    }
    const Eigen::Vector3d needed = samples_needed(extent, grid.spacing_m);
    if (!settings.field_samples) {
      if (!fits(needed, kMaxTotal)) {
        throw InputError(scene_file, place,
                         text("%g mm, at which the burr takes ", grid.spacing_m / kMillimetre) +
                             samples_text(needed),
                         text("at most %.0f along each axis and %.0f in all", kMaxSamples,
                              static_cast<double>(kMaxTotal)));
      }
      grid.samples = needed.cast<int>();
    } else if ((grid.samples.cast<double>().array() < needed.array()).any()) {
      const Eigen::Vector3d box =
          (grid.samples.cast<double>() - Eigen::Vector3d::Ones()) * grid.spacing_m;
      const double margin = 2.0 * kFieldMargin * grid.spacing_m;
      throw InputError(scene_file, place, "a box of " + box_text(box),
                       "at least " + box_text(extent.array() + margin) + " to hold the burr");
    }
  } else if (settings.field_samples) {
    grid.spacing_m = finest_spacing(extent, grid.samples);
  } else {
    grid.spacing_m = auto_spacing(extent, head_diameter_m, voxel_m);
    grid.samples = samples_needed(extent, grid.spacing_m).cast<int>();
  }

  const double across = head_diameter_m / grid.spacing_m;
  if (across < kMinAcrossHead) {
    throw InputError(scene_file, place, text("%.2g samples across the head", across),
                     text("at least %.0f", kMinAcrossHead));
  }
  grid.origin_tool = bounds_tool.center() -
                     0.5 * grid.spacing_m * (grid.samples.cast<double>() - Eigen::Vector3d::Ones());
  return grid;
}

}  // namespace sulcus
