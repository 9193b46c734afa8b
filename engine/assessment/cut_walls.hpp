#pragma once

#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// A piece of a cut wall. Frame: mm, z is the path of insertion.
struct WallSample {
  Eigen::Vector3d at_mm;
  Eigen::Vector3d normal;  // out of the tooth
  double area_mm2;
};

/// What a patch of a wall is like, by a fit to it.
struct WallPatch {
  Eigen::Vector3d at_mm;   // on the wall, halfway up
  Eigen::Vector2d facing;  // out of the tooth, a unit vector
  double taper_deg;        // against the path of insertion; above 0 it opens outward
  double roughness_um;     // Ra: the mean distance of the wall from the fit
  double area_mm2;         // of the samples it is about
};

/// Patches of 0.8 mm along the walls, as high as these are, every 0.25 mm. Over each a surface is
/// fitted,
///
///   w = a + b t + c z + d t^2 + e t z + f t^2 z,
///
/// w out of the tooth, t along the wall, by least squares over area: its taper is atan(-c), on
/// which the steps of voxels have no part that does not shrink with the height. What stands 0.15 mm
/// before or behind it is another wall. Patches with less
/// than 0.25 mm of height, or too few samples, give none.
std::vector<WallPatch> wall_patches(const std::vector<WallSample>& samples);

/// How walls that face each other converge, or how far those of a crown do, deg: twice the mean of
/// their tapers, over all directions in which walls face both ways.
struct Convergence {
  double mean_deg = 0.0;
  const WallPatch* worst = nullptr;  // whose taper is furthest from the others'
};
/// Without `worst` where no walls face each other. It points into `patches`.
Convergence convergence_of(const std::vector<WallPatch>& patches);

/// How the walls that face one way lean, by area.
struct WallTaper {
  double mean_deg = 0.0;             // against the path of insertion; above 0 they open outward
  const WallPatch* worst = nullptr;  // whose taper is furthest from that
};
/// Of those that face less than 45 degrees from a direction, a unit vector across the path of
/// insertion. Without `worst` where there are none. It points into `patches`.
WallTaper taper_facing(const std::vector<WallPatch>& patches, const Eigen::Vector2d& direction);

}  // namespace sulcus
