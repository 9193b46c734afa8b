#include "app/scene_trajectory.hpp"

#include <string>
#include <utility>
#include <vector>

#include "app/recorded_run.hpp"
#include "engine/core/error.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/recording/tick_record.hpp"

namespace sulcus {

Trajectory scene_trajectory(const Scene& scene, const InputLimits& limits) {
  const TrajectorySettings& settings = scene.trajectory;
  if (settings.recording.empty()) {
    TrajectorySettings with_last = settings;
    // The last row of a table has its tick as well.
    if (!settings.file.empty()) with_last.hold_s += 1.0 / scene.haptics.rate_hz;
    return make_trajectory(with_last, limits);
  }
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

}  // namespace sulcus
