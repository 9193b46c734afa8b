#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/scene/scene.hpp"

namespace sulcus {

/// Timed poses of the burr's tip, world from tool; positions linear in between, orientations by
/// normalised linear interpolation (no libm but sqrt: a tick asks for them). Before the first and
/// after the last pose it rests.
class Trajectory {
 public:
  /// At least one pose, times strictly rising from 0.
  explicit Trajectory(std::vector<TimedPose> poses, double clock_at_start_s = 0.0);

  Pose pose_at(double time_s) const noexcept;
  std::span<const TimedPose> poses() const { return poses_; }
  double duration_s() const { return poses_.back().time_s; }
  /// What the clock of the table that it came from says at its time 0.
  double clock_at_start_s() const { return clock_at_start_s_; }

 private:
  std::vector<TimedPose> poses_;
  double clock_at_start_s_;
};

/// Along `points_m` at constant speed with a fixed axis, or from the CSV that `file` names
/// (pose_table.hpp); a recording is read elsewhere. InputError as read_pose_table.
Trajectory make_trajectory(const TrajectorySettings& settings, const InputLimits& limits = {});

/// That of a scene which names no recording: the last row of a table has its tick as well.
Trajectory scene_path(const Scene& scene, const InputLimits& limits = {});

/// Ticks that a run of so many seconds has, one at least.
std::uint64_t ticks_in(double duration_s, double rate_hz);

/// `poses` with the last of them a second time, `hold_s` later.
std::vector<TimedPose> hold(std::vector<TimedPose> poses, double hold_s);

/// Shortest rotation that takes the tool's +y, its axis from tip to shank, to `axis_world` (unit).
Eigen::Quaterniond orientation_along(const Eigen::Vector3d& axis_world);

}  // namespace sulcus
