#pragma once

#include <string>

#include "engine/core/input_limits.hpp"
#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

// A reader for each format; read_mesh chooses among them.

/// Reads an STL file, binary or text. It is binary where its length is what its count of triangles
/// asks for, whatever its header says, and else where it does not begin with "solid".
///
/// Text: any case, blanks and ends of lines wherever they please, solids one after another, facets
/// without normals or with ones that are no numbers (the corners tell the side), loops of more than
/// three corners. Binary: attributes (colours) are skipped; behind the counted triangles there
/// may be padding (zeros, blanks) or less than a triangle's bytes. More there is refused: the count
/// or the file is wrong.
/// Contract and errors as read_mesh.
TriangleMesh read_stl(const std::string& path, const InputLimits& limits);

/// Reads the polygons of a Wavefront OBJ file: `v` with or without a weight of 1 and colours, `f`
/// of whatever of v, v/vt, v//vn, v/vt/vn, counted from the first or from the last vertex. Comments
/// end lines and a backslash carries a line on. What has no share in a surface of polygons (names,
/// normals, materials, lines, points, curves) is skipped; what has, and is not read (surfaces
/// by control points, calls of other files), is refused, as is a statement that OBJ does not know.
/// Contract and errors as read_mesh.
TriangleMesh read_obj(const std::string& path, const InputLimits& limits);

/// Reads a PLY file, text or binary of either order of bytes: x, y and z of `vertex`, the lists
/// vertex_indices or vertex_index of `face` and, as strips of triangles that -1 parts, of
/// `tristrips`, in whatever order the elements and their properties are. Others are skipped. A
/// row of a text is a line. Behind the last row there may be padding: zeros or blanks.
/// Contract and errors as read_mesh.
TriangleMesh read_ply(const std::string& path, const InputLimits& limits);

}  // namespace sulcus
