#pragma once

#include <string>

#include "engine/core/input_limits.hpp"
#include "engine/core/mesh_extension.hpp"  // is_mesh_file
#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// Reads STL (binary or text), OBJ or PLY through assimp. Lengths in the file are mm, positions
/// here are metres. Polygons are cut into triangles; vertices at the same place are welded, which
/// STL needs to have any neighbours at all; triangles that lose a corner by it are dropped. No
/// vertex is without a triangle.
/// Announced counts are compared with the length of the file and with the limits before memory is
/// taken. No other file is opened: materials, textures and what a format may refer to are not read.
/// @throws InputError: missing, empty, not of its format, truncated, a position that is not
/// finite, an index out of range, fewer than 4 triangles, no area, more than the limits allow.
TriangleMesh read_mesh(const std::string& path, const InputLimits& limits = {});

/// Writes a mesh in metres as .stl (binary), .obj or .ply (binary) in mm, through assimp.
/// @throws InputError for another extension; std::runtime_error where it cannot be written.
void write_mesh(const std::string& path, const TriangleMesh& mesh);

}  // namespace sulcus
