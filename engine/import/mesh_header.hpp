#pragma once

#include <string>

#include "engine/core/input_limits.hpp"

namespace sulcus {

// Light checks of mesh files that announce more than they hold, made before a library believes
// them. All throw InputError.

/// STL: the count of a binary file against its length; the end of a text file.
void check_stl(const std::string& path, const InputLimits& limits);
/// OBJ: how many triangles its faces are, how many parts it has, and that no face has so many
/// corners that cutting it up would take for ever.
void check_obj(const std::string& path, const InputLimits& limits);
/// PLY: that every announced row is there and every index of a face names a vertex. The file is
/// walked through once, since assimp reads past the end of a truncated one.
void check_ply(const std::string& path, const InputLimits& limits);

}  // namespace sulcus
