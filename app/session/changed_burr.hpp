#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/playback/recorded_run.hpp"
#include "engine/tool/burr.hpp"

namespace sulcus {

/// The burr that overrides (as of --set) put in the place of a recording's; none where they leave
/// it. InputError as load_burr and parse_scene.
std::optional<Burr> changed_burr(const RecordedRun& run, const std::vector<std::string>& overrides);

}  // namespace sulcus
