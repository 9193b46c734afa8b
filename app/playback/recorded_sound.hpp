#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/whole_file.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/scene/scene.hpp"
#include "engine/sound/handpiece_sound.hpp"

namespace sulcus {

/// What makes the sound of a recording: speed and power of its rows, and the tissues that went.
/// `option`: what asks for it. InputError where its scene has no [cutting], so that no spindle
/// turned.
std::vector<SoundTick> recorded_sound(const RecordingReader& reader, const Scene& scene,
                                      const std::string& option);

/// Writes it as .wav beside the file's name, from a time on the clock of the run to the recording's
/// end. @throws as recorded_sound and write_wav.
void write_recorded_sound(const RecordingReader& reader, const Scene& scene, double begin_s,
                          double end_s, const std::string& option, const WholeFile& file);

}  // namespace sulcus
