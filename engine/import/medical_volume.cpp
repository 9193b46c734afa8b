#include "engine/import/medical_volume.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>

#include "engine/core/error.hpp"
#include "engine/import/itk_volume_io.hpp"

namespace sulcus {
namespace {

void check_placement(const MedicalVolume& volume) {
  if (!volume.origin_m.allFinite() || !volume.direction.allFinite() ||
      std::abs(volume.direction.determinant()) < 1e-3) {
    throw InputError(volume.file, "direction", "axes that span no volume or are not finite",
                     "three independent axes");
  }
}

/// A value that is not a number would spread along whole lines when the grid is interpolated.
void replace_non_finite(MedicalVolume& volume) {
  float least = std::numeric_limits<float>::infinity();
  bool all = true;
  for (const float v : volume.values) {
    if (std::isfinite(v)) {
      least = std::min(least, v);
    } else {
      all = false;
    }
  }
  if (all) return;
  if (!std::isfinite(least)) {
    throw InputError(volume.file, "data", "no finite grey value", "grey values");
  }
  for (float& v : volume.values) v = std::isfinite(v) ? v : least;
}

}  // namespace

MedicalVolume read_medical_volume(const std::string& path, const InputLimits& limits) {
  ItkVolume read = read_volume_with_itk(path, limits);
  MedicalVolume volume;
  volume.file = path;
  volume.spacing_known = read.spacing_known;
  for (int d = 0; d < 3; ++d) {
    volume.sizes[d] = read.sizes[d];
    volume.spacing_m[d] = read.spacing_m[d];
    volume.origin_m[d] = read.origin_m[d];
    volume.direction.col(d) = Eigen::Vector3d(read.axes[d].data());
  }
  volume.values = std::move(read.values);
  check_placement(volume);
  replace_non_finite(volume);
  return volume;
}

}  // namespace sulcus
