#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/session.hpp"

namespace sulcus {

/// summary.json of a run, with the pinned keys of the README.
nlohmann::ordered_json make_summary(const Simulation& simulation, const SessionResult& result,
                                    Pace pace, const std::vector<PartUse>& loading);

}  // namespace sulcus
