#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "app/session.hpp"

namespace sulcus {

/// summary.json of a run, with the pinned keys of the README.
nlohmann::ordered_json make_summary(const Simulation& simulation, const SessionResult& result,
                                    Pace pace, const std::vector<PartUse>& loading);

/// Writes text to a file. std::runtime_error where that fails.
void write_text(const std::string& file, const std::string& text);

}  // namespace sulcus
