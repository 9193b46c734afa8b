#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sulcus {

/// Where the file of a workpiece lies: what brings the result back over it. Of a volume the lattice
/// too: the centre of its voxel (i, j, k) lies at `origin_m + direction * (spacing_m .* (i, j, k))`
/// in the file's own space (of medical files the patient's, +x left, +y posterior, +z superior).
struct InputGeometry {
  static constexpr std::size_t kNumbers = 30;

  Eigen::Affine3d file_from_world = Eigen::Affine3d::Identity();  // rigid; m
  Eigen::Vector3i sizes = Eigen::Vector3i::Zero();  // voxels; 0: a mesh, which has no lattice
  Eigen::Vector3d spacing_m = Eigen::Vector3d::Constant(1e-3);
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d direction = Eigen::Matrix3d::Identity();  // columns: the lattice's axes

  bool has_lattice() const { return sizes.x() > 0; }
  Eigen::Affine3d file_from_lattice() const;

  /// All of it in this order: the three rows of file_from_world, sizes, spacing_m, origin_m, the
  /// three rows of direction.
  std::array<double, kNumbers> numbers() const;
  /// None where they describe no geometry: not finite, not rigid, axes that span no volume, sizes
  /// that are not all positive or all 0.
  static std::optional<InputGeometry> of(std::span<const double, kNumbers> numbers);
};

/// What an import tells beside the voxels that it made.
struct ImportNotes {
  std::optional<InputGeometry> input;  // none: a built-in shape
  std::vector<std::string> warnings;   // for the user, a line each
};

}  // namespace sulcus
