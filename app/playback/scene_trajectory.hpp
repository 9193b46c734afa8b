#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/device/pedal.hpp"

namespace sulcus {

/// The trajectory of a scene, also one that is a recording's: the poses of its device, where that
/// answered, from its first row on. The last row of a table or recording has a tick. InputError as
/// make_trajectory and RecordingReader; also of a recording without a pose.
Trajectory scene_trajectory(const Scene& scene, const InputLimits& limits = {});

/// What the hand and the foot of a recording did, tick by tick from 0 on.
struct PlayedBack {
  std::vector<std::optional<Pose>> poses;
  std::vector<PedalChange> pedal;  // rising by tick
};

/// Of a scene whose trajectory is a recording's, to the bit, so that what was done then is done
/// again. Ticks that were not recorded, and those after the last, are
/// the trajectory's; so are those in which the device did not answer, but with `model =
/// "played_back"`, where it does not again. Empty where the poses are not played back as they were:
/// no recording, another rate, a load, a simulated hand; nor is the pedal then. InputError as
/// RecordingReader.
PlayedBack played_back(const Scene& scene, const Trajectory& trajectory, std::uint64_t ticks);

}  // namespace sulcus
