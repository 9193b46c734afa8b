#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/triangle_mesh.hpp"
#include "engine/volume/voxel_model.hpp"
#include "tests/support/shapes.hpp"

// Solids of revolution about z, for tests: as triangles, and as voxels.

namespace sulcus::test {

/// Corners (radius, height), mm, counter-clockwise in the half plane with the axis to the left:
/// from the axis out along the bottom, up, and in along the top. On the axis at both ends.
using Profile = std::vector<std::pair<double, double>>;

/// With `sides` corners to a circle; between two of them it lies inside of the circle.
inline TriangleMesh turned_mesh(const Profile& profile, int sides, const Eigen::Affine3d& placed) {
  TriangleMesh mesh;
  const auto add = [&](double r, double angle, double z) {
    const Eigen::Vector3d p(r * std::cos(angle), r * std::sin(angle), z);
    mesh.positions.push_back((placed * (1e-3 * p)).cast<float>());
  };
  const auto rings = static_cast<std::uint32_t>(profile.size() - 2);
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto [r, z] = profile[ring + 1];
      add(r, 2.0 * std::numbers::pi * (i + 0.37) / n, z);
    }
  }
  const auto bottom = static_cast<std::uint32_t>(mesh.positions.size()), top = bottom + 1;
  add(0.0, 0.0, profile.front().second);
  add(0.0, 0.0, profile.back().second);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n, last = (rings - 1) * n;
    mesh.triangles.push_back({bottom, j, i});
    mesh.triangles.push_back({top, last + i, last + j});
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
      const std::uint32_t low = ring * n, high = low + n;
      mesh.triangles.push_back({low + i, low + j, high + j});
      mesh.triangles.push_back({low + i, high + j, high + i});
    }
  }
  return mesh;
}

inline bool is_in(const Profile& profile, double r, double z) {
  bool in = false;
  for (std::size_t i = 0, j = profile.size() - 1; i < profile.size(); j = i++) {
    const auto [ri, zi] = profile[i];
    const auto [rj, zj] = profile[j];
    if ((zi > z) != (zj > z) && r < (rj - ri) * (z - zi) / (zj - zi) + ri) in = !in;
  }
  return in;
}

/// In a grid of a whole number of voxels, `half_mm` to each side of the origin.
inline VoxelModel turned_voxels(const Profile& profile, double voxel_mm, double half_mm,
                                const Eigen::Affine3d& placed) {
  const VoxelGrid grid{Eigen::Vector3i::Constant(8 * static_cast<int>(half_mm / (4.0 * voxel_mm))),
                       1e-3 * voxel_mm};
  const Eigen::Affine3d back = placed.inverse();
  return make_model(grid.cells, grid.voxel_m, [&](const Cell& c) {
    const Eigen::Vector3d p = 1e3 * (back * grid.centre_world(c));
    return is_in(profile, p.head<2>().norm(), p.z());
  });
}

}  // namespace sulcus::test
