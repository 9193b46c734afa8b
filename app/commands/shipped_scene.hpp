#pragma once

#include <string>

namespace sulcus {

/// The scene file that a command is to read: `given` where there is such a file; else, for NAME,
/// NAME.toml or scenes/NAME.toml, the one of that name which came with the program, installed or
/// built; else `given`, for whoever reads it to refuse.
std::string scene_file_of(const std::string& given);

}  // namespace sulcus
