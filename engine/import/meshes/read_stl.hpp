#pragma once

#include <string>

#include "engine/core/input_limits.hpp"
#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// Reads an STL file, binary or text. It is binary where its length is what its count of triangles
/// asks for, whatever its header says, and else where it does not begin with "solid".
///
/// Text: any case, blanks and ends of lines wherever they please, solids one after another, facets
/// without normals or with ones that are no numbers (the corners tell the side), loops of more than
/// three corners. Binary: attributes (colours) are passed over; behind the counted triangles there
/// may be padding (zeros, blanks) or less than a triangle's bytes. More there is refused: the count
/// or the file is wrong.
/// Contract and errors as read_mesh.
TriangleMesh read_stl(const std::string& path, const InputLimits& limits);

}  // namespace sulcus
