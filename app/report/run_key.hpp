#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/session/simulation.hpp"
#include "engine/recording/recording_reader.hpp"

namespace sulcus {

// What a run's results follow from to the bit, as 32 hexadecimal digits: two runs of one key are
// the same run. Pace, threads and the build are no part of it.

/// Of a scene's run, before its first tick, but one with a hand in it. `goal`: what the file of the
/// scene's goal holds, null where it names none; `renders`: whether it draws frames.
std::string key_of_run(const Simulation& simulation, const VoxelModel* goal, std::uint64_t ticks,
                       bool renders);

/// Of a recording run again as it was, or looked at.
enum class RecordingUse : std::uint8_t { kReplay, kView };
std::string key_of_recording(const RecordingReader& reader, RecordingUse use);

}  // namespace sulcus
