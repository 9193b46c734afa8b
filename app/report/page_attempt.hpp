#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "app/report/assessment.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/scene/assessment_table.hpp"

namespace sulcus {

inline constexpr std::size_t kPageMoments = 32;

/// What a page's viewer shows of a recording, as page/web/viewer.js reads it: tooth, neighbours and
/// burr over time, what they are coloured by, the goal, and pins at what was not met. Surfaces stay
/// within kMostPageError_m. Lengths in mm, world space; arrays of numbers in base64, little endian.
///
/// `assessment`: null where there is none; `settings`: what it was marked by; `moments`: at how
/// many steps of the work the tooth is shown, besides those of pins. InputError as RecordedFilm.
nlohmann::ordered_json page_attempt(const RecordingReader& reader, const std::string& path,
                                    const Assessment* assessment,
                                    const AssessmentSettings& settings,
                                    std::size_t moments = kPageMoments);

}  // namespace sulcus
