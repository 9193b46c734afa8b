#pragma once

#include <array>
#include <cmath>
#include <string>

#include <Eigen/Core>

#include "engine/import/volumes/medical_volume.hpp"
#include "engine/shapes/cell_coverage.hpp"
#include "engine/volume/grid.hpp"

// Grey volumes of which it is known in closed form where the surface is.

namespace sulcus::test {

inline constexpr double kAirGrey = 400.0, kSolidGrey = 900.0, kHalfGrey = 650.0;

/// Signed distance, positive outside, and the outward normal at the closest point; lattice steps.
struct KnownGreySurface {
  double distance;
  Eigen::Vector3d normal;
};
struct GreyBall {
  Eigen::Vector3d centre;
  double radius;
  KnownGreySurface operator()(const Eigen::Vector3d& p) const {
    return {(p - centre).norm() - radius, (p - centre).normalized()};
  }
};
struct GreyPlane {
  Eigen::Vector3d point, normal;
  KnownGreySurface operator()(const Eigen::Vector3d& p) const {
    return {normal.dot(p - point), normal};
  }
};

/// A scanner that smears a step: the grey value is kHalfGrey just where the surface is.
struct Smeared {
  double width = 1.5;  // lattice steps
  double share(const KnownGreySurface& at) const {
    return 0.5 - 0.5 * std::tanh(at.distance / width);
  }
};
/// One that takes the mean over a voxel, which the surface cuts as the plane does that touches it.
struct Averaged {
  double share(const KnownGreySurface& at) const {
    return share_behind_plane(at.normal, at.distance);
  }
};

template <class Surface, class Scanner>
MedicalVolume scanned(const Eigen::Vector3i& sizes, const Surface& surface,
                      const Scanner& scanner) {
  MedicalVolume volume;
  volume.file = "scanned.nrrd";
  volume.sizes = sizes;
  for_each_cell(Cell::Zero(), sizes, [&](const Cell& c) {
    const double share = scanner.share(surface(c.cast<double>()));
    volume.values.push_back(static_cast<float>(kAirGrey + (kSolidGrey - kAirGrey) * share));
  });
  return volume;
}

/// The bytes of an NRRD file of it, with the edge of its voxels along each axis, mm.
inline std::string nrrd_of(const MedicalVolume& volume, const std::array<double, 3>& edges_mm) {
  std::string bytes = "NRRD0004\ntype: float\ndimension: 3\nsizes:";
  for (const int size : volume.sizes) bytes += ' ' + std::to_string(size);
  bytes += "\nspacings:";
  for (const double edge_mm : edges_mm) bytes += ' ' + std::to_string(edge_mm);
  bytes += "\nendian: little\nencoding: raw\n\n";
  bytes.append(reinterpret_cast<const char*>(volume.values.data()), 4 * volume.values.size());
  return bytes;
}

}  // namespace sulcus::test
