#pragma once

#include <string>
#include <vector>

namespace sulcus {

// What came with the program is found from where that lies, so that the whole may be moved.

/// The scene file that a command is to read: `given` where there is such a file; else, for NAME,
/// NAME.toml or scenes/NAME.toml, the one of that name which came with the program, installed or
/// built; else `given`, for whoever reads it to refuse.
std::string scene_file_of(const std::string& given);

/// For whoever runs one: as scene_file_of; @throws InputError where there is no such file, with the
/// names of the scenes that came with the program, and where it is a recording, a mesh or a volume,
/// with what takes it.
std::string scene_to_run(const std::string& given);

/// Names and titles of the scenes that came with the program, a line each.
std::string shipped_scene_help();

/// The recording that is meant: of a folder of results that in it, else `given`.
std::string recording_file_of(const std::string& given);

/// Where plug-ins are looked for: `given` (of --plugins) first where it is not empty, then those
/// built beside the program, then the folder of the installation. A scene has no say in it.
std::vector<std::string> plugin_folders(const std::string& given);

}  // namespace sulcus
