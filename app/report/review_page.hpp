#pragma once

#include <cstdint>
#include <string>

#include "engine/recording/recording_reader.hpp"

namespace sulcus {

/// Whether a page has a video of the run, which needs ffmpeg.
enum class ReviewVideo : std::uint8_t { kNone, kWithSound };

/// Writes a page on a run that needs nothing beside it (HTML, pictures and curves in it): the tooth
/// before and after from each side, a section through what was cut, when what was cut, the way
/// there, curves over the whole run, how warm the tooth became where the scene has [heat], and what
/// came of it. All of it is from the recording, so that a copy of that gives the same page. Of a
/// run that goes on from another the outcome is that of the whole, with that of its own part beside
/// it. InputError as RecordedFilm; std::runtime_error where nothing can be drawn or the file cannot
/// be written.
void write_review_page(const RecordingReader& reader, const std::string& recording,
                       const std::string& file, ReviewVideo video = ReviewVideo::kNone);

}  // namespace sulcus
