#pragma once

#include <string>

#include "engine/core/input_limits.hpp"
#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// Reads the polygons of a Wavefront OBJ file: `v` with or without a weight of 1 and colours, `f`
/// of whatever of v, v/vt, v//vn, v/vt/vn, counted from the first or from the last vertex. Comments
/// end lines and a backslash carries a line on. What has no share in a surface of polygons (names,
/// normals, materials, lines, points, curves) is passed over; what has, and is not read (surfaces
/// by control points, calls of other files), is refused, as is a statement that OBJ does not know.
/// Contract and errors as read_mesh.
TriangleMesh read_obj(const std::string& path, const InputLimits& limits);

}  // namespace sulcus
