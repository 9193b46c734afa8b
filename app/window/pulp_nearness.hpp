#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// How far points and a burr are from the pulp as it is at the start. Keeps the centres of the
/// pulp's outer voxels, and asks them all: some tens of microseconds for a point, a millisecond for
/// a burr. Used by one thread.
class PulpNearness {
 public:
  /// Nothing is kept where no tissue of the scene is called "pulp", or the tooth has none of it.
  PulpNearness(const VoxelModel& start, std::span<const TissueSettings> tissues);

  bool has_pulp() const { return !outer_world_.empty(); }
  /// To the nearest centre of a voxel of the pulp, m; none without a pulp. (Of a point outside.)
  std::optional<double> distance_m(const Eigen::Vector3d& point_world) const;
  /// Between the burr's surface and that; below 0 where it is inside.
  std::optional<double> distance_m(const Burr& burr, const Pose& world_from_tool) const;

 private:
  std::vector<Eigen::Vector3f> outer_world_;
};

}  // namespace sulcus
