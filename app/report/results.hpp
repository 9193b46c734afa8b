#pragma once

#include <string>
#include <vector>

#include "app/report/results_folder.hpp"
#include "app/session/session.hpp"

namespace sulcus {

/// Where the results of a scene go without -o: out/NAME, by its file; by none of dots alone
/// (...toml) out/scene.
std::string folder_of_scene(const std::string& file, const std::string& suffix = "");
/// The same of a recording: by its file, or by its folder where the file has the name that all
/// have.
std::string folder_of_recording(const std::string& file, const std::string& suffix);

/// Runs a session into a folder: its recording, log and frames, summary.json, which is a copy of
/// what the recording holds, and forces.png. Says on the terminal what happened and which files
/// there are. `options.folder` and `options.summarise` are set here. Throws what made a part of the
/// run fail; std::runtime_error where a file cannot be written, log.txt among them.
void run_into(ResultsFolder& folder, Simulation& simulation, Device& device,
              SessionOptions& options, const std::vector<PartUse>& loading);

}  // namespace sulcus
