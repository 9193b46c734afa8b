#pragma once

#include "engine/scene/scene.hpp"
#include "engine/scene/trajectory.hpp"

namespace sulcus {

/// The trajectory of a scene, also one that is a recording's: the poses of its device, where that
/// answered, from its first row on. The last row of a table or recording has a tick. InputError as
/// make_trajectory and RecordingReader; also of a recording without a pose.
Trajectory scene_trajectory(const Scene& scene, const InputLimits& limits = {});

}  // namespace sulcus
