#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "engine/import/volumes/medical_volume.hpp"
#include "tests/support/itk_files.hpp"

namespace sulcus::test {

// A solid that is its own in no mirror and no turn: a ball of 1.4 mm with a smaller one at each of
// three axes, in the patient's space, cut by a lattice aslant of 0.1 x 0.1 x 0.3 mm.

inline const Eigen::Vector3d kObliqueMiddle_mm{31.2, -17.5, 142.6};

/// Distance to the solid's surface at a point of the file's space, mm; negative inside.
inline double oblique_distance_mm(const Eigen::Vector3d& p_file_mm) {
  const Eigen::Vector3d p = p_file_mm - kObliqueMiddle_mm;
  double distance = p.norm() - 1.4;
  distance = std::min(distance, (p - Eigen::Vector3d(1.3, 0, 0)).norm() - 0.9);
  distance = std::min(distance, (p - Eigen::Vector3d(0, 1.5, 0.3)).norm() - 0.7);
  return std::min(distance, (p - Eigen::Vector3d(0.3, 0, 1.7)).norm() - 0.6);
}

inline Eigen::Matrix3d oblique_direction() {
  return (Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()) *
          Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY()))
      .toRotationMatrix();
}

/// Grey values 400 outside to 1000 inside, 600 to 800 at the surface.
inline MedicalVolume oblique_volume(const Eigen::Matrix3d& direction = oblique_direction()) {
  MedicalVolume volume;
  volume.file = "oblique";
  volume.sizes = {56, 58, 24};
  volume.spacing_m = Eigen::Vector3d(0.1, 0.1, 0.3) * 1e-3;
  volume.direction = direction;
  const Eigen::Vector3d half = 0.5 * (volume.sizes - Eigen::Vector3i::Ones()).cast<double>();
  // The solid's box is not in the middle of the lattice.
  volume.origin_m = (kObliqueMiddle_mm + Eigen::Vector3d(0.5, 0.3, 0.4)) * 1e-3 -
                    direction * half.cwiseProduct(volume.spacing_m);
  for (int k = 0; k < volume.sizes.z(); ++k) {
    for (int j = 0; j < volume.sizes.y(); ++j) {
      for (int i = 0; i < volume.sizes.x(); ++i) {
        const Eigen::Vector3d p_file_m =
            volume.origin_m + direction * Eigen::Vector3d(i, j, k).cwiseProduct(volume.spacing_m);
        const double d = oblique_distance_mm(p_file_m * 1e3);
        volume.values.push_back(
            static_cast<float>(std::round(700.0 - 300.0 * std::clamp(d / 0.3, -1.0, 1.0))));
      }
    }
  }
  return volume;
}
inline constexpr double kObliqueSolidAbove = 700.0;

inline PlainVolume plain(const MedicalVolume& volume) {
  PlainVolume p;
  for (int d = 0; d < 3; ++d) {
    p.sizes[d] = volume.sizes[d];
    p.spacing_mm[d] = volume.spacing_m[d] * 1e3;
    p.origin_mm[d] = volume.origin_m[d] * 1e3;
    for (int row = 0; row < 3; ++row) p.axes[d][row] = volume.direction(row, d);
  }
  p.values.assign(volume.values.begin(), volume.values.end());
  return p;
}

}  // namespace sulcus::test
