#pragma once

#include <string>

#include "engine/core/input_limits.hpp"
#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// Reads a PLY file, text or binary of either order of bytes: x, y and z of `vertex`, the lists
/// vertex_indices or vertex_index of `face` and, as strips of triangles that -1 parts, of
/// `tristrips`, in whatever order the elements and their properties are. Others are passed over. A
/// row of a text is a line. Behind the last row there may be padding: zeros or blanks.
/// Contract and errors as read_mesh.
TriangleMesh read_ply(const std::string& path, const InputLimits& limits);

}  // namespace sulcus
