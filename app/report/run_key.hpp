#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "app/report/assessment.hpp"
#include "app/session/simulation.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/scene/assessment_table.hpp"

namespace sulcus {

// What a run's results, or an assessment's, follow from to the bit, as 32 hexadecimal digits: two
// runs of one key are the same run. Pace, threads and the build are no part of it.

/// Of a scene's run, before its first tick, but one with a hand in it. `goal`: what the file of the
/// scene's goal holds, null where it names none; `renders`: whether it draws frames.
std::string key_of_run(const Simulation& simulation, const VoxelModel* goal, std::uint64_t ticks,
                       bool renders);

/// Of a recording run again as it was, looked at, or assessed.
enum class RecordingUse : std::uint8_t { kReplay, kView, kAssess };
std::string key_of_recording(const RecordingReader& reader, RecordingUse use);

/// Of an assessment: what is assessed, and what by. Where it lies is no part of it.
std::string key_of_assessment(const RecordingReader& reader, const AssessmentSettings& settings);
std::string key_of_assessment(const ScannedTooth& tooth, const AssessmentSettings& settings);
/// Of several beside each other, by their own.
std::string key_of_assessments(std::span<const std::string> keys);

}  // namespace sulcus
