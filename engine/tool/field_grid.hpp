#pragma once

#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/scene/scene.hpp"

namespace sulcus {

/// Where a distance field has its samples: an upright box of cubic cells in tool space. Field space
/// counts samples: sample (i, j, k) is at (i, j, k).
struct FieldGrid {
  Eigen::Vector3i samples = Eigen::Vector3i::Zero();
  Eigen::Vector3d origin_tool = Eigen::Vector3d::Zero();  // of sample (0, 0, 0), m
  double spacing_m = 0.0;

  Eigen::Vector3d field_from_tool(const Eigen::Vector3d& p_tool) const {
    return (p_tool - origin_tool) / spacing_m;
  }
  Eigen::Vector3d tool_from_field(const Eigen::Vector3d& p_field) const {
    return origin_tool + p_field * spacing_m;
  }
};

/// Samples that stay free between the burr and each face of the box.
inline constexpr int kFieldMargin = 2;

/// Chooses the grid for a burr that fills `bounds_tool` and whose head is `head_diameter_m` wide;
/// the burr lies in its middle.
/// - samples and no spacing: as fine as the longest axis allows.
/// - spacing and no samples: as many samples as it takes.
/// - neither: as coarse as leaves the head's surface within 1/512 of a voxel, by linear
///   interpolation over a ball as wide as it (h^2 / 8 r), at most `voxel_m` and a sixteenth of the
///   head; coarser if that needs more than 2^25 samples (128 MiB) or 1024 along an axis. What a
///   tick reads of a field that is finer than it need be does not stay in the caches.
/// InputError (`scene_file`, burr.field or burr.field_spacing_mm): fewer than 8 or more than 1024
/// samples along an axis, more than 2^27 in all, a box that does not hold the burr and its margin,
/// fewer than 4 samples across the head. Nothing is allocated here.
FieldGrid plan_field(const BurrSettings& settings, const Eigen::AlignedBox3d& bounds_tool,
                     double head_diameter_m, double voxel_m, std::string_view scene_file = {});

}  // namespace sulcus
