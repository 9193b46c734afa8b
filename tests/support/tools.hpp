#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/tool/burr.hpp"

namespace sulcus::test {

/// Settings of a burr with a field small enough to be made in milliseconds.
inline BurrSettings small_burr(BurrShape shape = BurrShape::kRound, double diameter_m = 1.4e-3) {
  BurrSettings settings;
  settings.shape = shape;
  settings.diameter_m = diameter_m;
  settings.field_samples = Eigen::Vector3i(48, 192, 48);
  return settings;
}

/// A pose with the tip at `tip_world` and the shank along `axis_world` (unit).
inline Pose pose_along(const Eigen::Vector3d& tip_world, const Eigen::Vector3d& axis_world) {
  return {tip_world, orientation_along(axis_world)};
}

/// A pose with the tip at `tip_world` and the shank straight up +z.
inline Pose upright(const Eigen::Vector3d& tip_world) {
  return pose_along(tip_world, Eigen::Vector3d::UnitZ());
}

/// One tissue: 30 N/mm, 3.5 J/mm^3, as enamel.
inline std::vector<TissueSettings> one_tissue() {
  TissueSettings tissue;
  tissue.name = "enamel";
  return {tissue};
}

}  // namespace sulcus::test
