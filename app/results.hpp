#pragma once

#include <string>
#include <vector>

#include "app/session.hpp"

namespace sulcus {

/// Where the results of a run go unless told: out/NAME, by a scene's or a recording's file.
std::string default_folder(const std::string& file, const std::string& suffix = "");

/// Starts log.txt in a folder that it makes; messages also go to the terminal. InputError where the
/// folder cannot be written.
void open_log(const std::string& folder);

/// Writes summary.json and forces.png of a run, and says on the terminal what happened and which
/// files there are. Throws what made a part of the run fail; std::runtime_error where a file cannot
/// be written, log.txt among them.
void write_results(const Simulation& simulation, const SessionResult& result,
                   const SessionOptions& options, const std::vector<PartUse>& loading);

}  // namespace sulcus
