#include "app/playback/scene_trajectory.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "app/playback/recorded_run.hpp"
#include "engine/core/error.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/recording/tick_record.hpp"

namespace sulcus {

Trajectory scene_trajectory(const Scene& scene, const InputLimits& limits) {
  const TrajectorySettings& settings = scene.trajectory;
  if (settings.recording.empty()) return scene_path(scene, limits);
  const RecordingReader reader(settings.recording);
  say_what_is_missing(reader);
  if (reader.tick_count() > limits.poses()) {
    throw InputError(settings.recording, "/ticks", std::to_string(reader.tick_count()) + " rows",
                     "at most " + std::to_string(limits.poses()) + " (--limit-gib)");
  }
  std::vector<TimedPose> poses;
  double first_s = 0.0;
  for (const TickRecord& row : reader.ticks()) {
    if (row.faults & kFaultsWithoutPose) continue;
    if (poses.empty()) first_s = row.time_s;
    poses.push_back({row.time_s - first_s, pose_of(row.device_position_m, row.device_orientation)});
  }
  if (poses.empty()) {
    throw InputError(settings.recording, "/ticks", "no pose of a device", "at least one");
  }
  // The last pose has its tick as well.
  const double tick_s = 1.0 / reader.header().rate_hz;
  return Trajectory(hold(std::move(poses), tick_s + settings.hold_s));
}

PlayedBack played_back(const Scene& scene, const Trajectory& trajectory, std::uint64_t ticks) {
  const TrajectorySettings& settings = scene.trajectory;
  const bool by_a_hand = scene.device && !scene.device->played_back;
  if (settings.recording.empty() || settings.load_N || by_a_hand) return {};
  const RecordingReader reader(settings.recording);
  const double rate_hz = scene.haptics.rate_hz;
  if (reader.header().rate_hz != rate_hz || reader.tick_count() == 0) return {};
  PlayedBack back;
  std::vector<std::optional<Pose>>& poses = back.poses;
  poses.resize(ticks);
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    poses[tick] = trajectory.pose_at(static_cast<double>(tick) / rate_hz);
  }
  std::optional<std::uint64_t> first;  // with a pose: there the trajectory begins
  for (const TickRecord& row : reader.ticks()) {
    const bool silent = (row.faults & kFaultsWithoutPose) != 0;
    if (!first && silent) continue;
    if (!first) first = row.tick;
    if (row.tick - *first >= ticks) break;
    std::optional<Pose>& pose = poses[row.tick - *first];
    if (!silent) {
      pose = pose_of(row.device_position_m, row.device_orientation);
    } else if (scene.device) {
      pose.reset();
    }
  }
  for (PedalChange change : recorded_pedal(reader)) {
    change.tick -= std::min(change.tick, first.value_or(0));
    if (!back.pedal.empty() && back.pedal.back().tick == change.tick) back.pedal.pop_back();
    back.pedal.push_back(change);
  }
  return back;
}

}  // namespace sulcus
