#include "engine/scene/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/scene/pose_table.hpp"

namespace sulcus {

std::vector<TimedPose> hold(std::vector<TimedPose> poses, double hold_s) {
  if (hold_s > 0.0) {
    poses.push_back(poses.back());
    poses.back().time_s += hold_s;
  }
  return poses;
}

Trajectory::Trajectory(std::vector<TimedPose> poses, double clock_at_start_s)
    : poses_(std::move(poses)), clock_at_start_s_(clock_at_start_s) {}

Pose Trajectory::pose_at(double time_s) const noexcept {
  const auto after = std::upper_bound(poses_.begin(), poses_.end(), time_s,
                                      [](double t, const TimedPose& p) { return t < p.time_s; });
  if (after == poses_.begin()) return poses_.front().world_from_tool;
  if (after == poses_.end()) return poses_.back().world_from_tool;
  const TimedPose& a = *(after - 1);
  const TimedPose& b = *after;
  const double part = (time_s - a.time_s) / (b.time_s - a.time_s);
  const Pose &from = a.world_from_tool, &to = b.world_from_tool;
  Pose pose;
  pose.position = from.position + part * (to.position - from.position);
  Eigen::Quaterniond q_to = to.orientation;
  if (from.orientation.dot(q_to) < 0.0) q_to.coeffs() = -q_to.coeffs();  // the short way round
  pose.orientation.coeffs() =
      from.orientation.coeffs() + part * (q_to.coeffs() - from.orientation.coeffs());
  pose.orientation.normalize();
  return pose;
}

Eigen::Quaterniond orientation_along(const Eigen::Vector3d& axis_world) {
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), axis_world);
}

Trajectory make_trajectory(const TrajectorySettings& settings, const InputLimits& limits) {
  if (!settings.file.empty()) {
    PoseTable table = read_pose_table(settings.file, limits);
    return Trajectory(hold(std::move(table.poses), settings.hold_s), table.clock_at_start_s);
  }
  const Eigen::Quaterniond orientation = orientation_along(settings.axis);
  std::vector<TimedPose> poses;
  for (const Eigen::Vector3d& point : settings.points_m) {
    TimedPose pose{0.0, {point, orientation}};
    if (!poses.empty()) {
      const TimedPose& last = poses.back();
      const double length = (point - last.world_from_tool.position).norm();
      if (length == 0.0) continue;  // a point said twice takes no time
      pose.time_s = last.time_s + length / settings.speed_m_per_s;
    }
    poses.push_back(pose);
  }
  return Trajectory(hold(std::move(poses), settings.hold_s));
}

Trajectory scene_path(const Scene& scene, const InputLimits& limits) {
  TrajectorySettings settings = scene.trajectory;
  if (!settings.file.empty()) settings.hold_s += 1.0 / scene.haptics.rate_hz;
  return make_trajectory(settings, limits);
}

std::uint64_t ticks_in(double duration_s, double rate_hz) {
  constexpr double kRounding = 1e-6;  // of a tick
  return static_cast<std::uint64_t>(std::max(1.0, std::ceil(duration_s * rate_hz - kRounding)));
}

}  // namespace sulcus
