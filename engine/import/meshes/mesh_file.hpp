#pragma once

#include <string>

#include "engine/core/file_kind.hpp"
#include "engine/core/input_limits.hpp"
#include "engine/core/triangle_mesh.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

/// Reads STL (binary or text), OBJ or PLY (read_stl, read_obj, read_ply say what of them). Lengths
/// in the file are `unit_m` metres, positions here are metres. Polygons are cut into triangles,
/// concave ones too; vertices at the same place are welded, which STL needs to have any neighbours
/// at all; triangles that lose a corner by it are dropped. No vertex is without a triangle.
/// Announced counts are compared with the length of the file and with the limits before memory is
/// taken. No other file is opened: materials, textures and what a format may refer to are not read.
/// @throws InputError, with the line, row or triangle: missing, empty, not of its format, cut
/// short, longer than its counts say, a corner that is not finite or beyond 1 km, an index out of
/// range, fewer than 4 triangles, no area, more than the limits allow.
TriangleMesh read_mesh(const std::string& path, const InputLimits& limits = {},
                       double unit_m = kMillimetre);

/// Writes a mesh in metres as .stl (binary), .obj or .ply (binary, little endian) in mm, to the
/// nearest float.
/// @throws InputError for another extension and as WholeFile; std::runtime_error where not all of
/// it can be written.
void write_mesh(const std::string& path, const TriangleMesh& mesh);

}  // namespace sulcus
