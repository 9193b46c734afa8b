#pragma once

#include <cstdint>
#include <string>

#include "engine/recording/recording_reader.hpp"

namespace sulcus {

/// Whether a page has a video of the run, which needs ffmpeg.
enum class ReviewVideo : std::uint8_t { kNone, kWithSound };

/// Writes a page on a run that needs nothing beside it and lets nothing leave it: the tooth over
/// time to be turned, with the goal as a ghost, coloured by error, depth, tissue or the order of
/// cutting, and pins at what the scene's [assessment] finds not met; the assessment, curves over
/// the whole run, pictures of the way there, how warm the tooth became where the scene has [heat],
/// and what came of it. All of it is from the recording, so that a copy of that gives the same
/// page. Of a run that goes on from another tooth, assessment and outcome are those of the whole.
/// InputError as RecordedFilm and three_js(); std::runtime_error where nothing can be drawn or the
/// file cannot be written.
void write_review_page(const RecordingReader& reader, const std::string& recording,
                       const std::string& file, ReviewVideo video = ReviewVideo::kNone);

}  // namespace sulcus
