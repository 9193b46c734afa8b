#pragma once

#include <string>
#include <vector>

#include "app/report/assessment.hpp"
#include "engine/recording/recording_reader.hpp"

namespace sulcus {

/// Draws the moment of each limit that is not met, into a folder that is there: depth_mm.png, the
/// burr cut open at the place, and depth_mm.mp4, two seconds that end half a second after it. Names
/// them in the assessment. What came before the recording's own ticks is not drawn. Returns the
/// files, by their names in the folder. @throws as RecordedFilm and VideoWriter; std::runtime_error
/// where nothing can be drawn.
std::vector<std::string> draw_moments(const RecordingReader& reader, const std::string& recording,
                                      const std::string& folder, Assessment& assessment);

}  // namespace sulcus
