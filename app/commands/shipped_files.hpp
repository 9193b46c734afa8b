#pragma once

#include <string>
#include <vector>

namespace sulcus {

// What came with the program is found from where that lies, so that the whole may be moved.

/// The scene file that a command is to read: `given` where there is such a file; else, for NAME,
/// NAME.toml or scenes/NAME.toml, the one of that name which came with the program, installed or
/// built; else `given`, for whoever reads it to refuse.
std::string scene_file_of(const std::string& given);

/// Where plug-ins are looked for: `given` (of --plugins) first where it is not empty, then the
/// folder of the installation. A scene has no say in it.
std::vector<std::string> plugin_folders(const std::string& given);

}  // namespace sulcus
