#pragma once

#include <string_view>

#include "engine/core/triangle_mesh.hpp"
#include "engine/tool/distance_field.hpp"

namespace sulcus {

/// The field of a burr given as a mesh in tool space, m.
///
/// Distances are exact within three samples of the surface. Beyond, the nearest triangle is handed
/// on from sample to sample in sweeps along the axes and the distance to it is exact. It may be a
/// neighbour of the nearest: then the distance is too large, by half a sample at most in burrs of
/// 10,000 triangles.
///
/// Inside is what most of three rays through a sample, one along each axis, say. A ray goes by its
/// winding number, so that parts that overlap count as one solid; by parity where windings do not
/// add up (triangles of mixed orientation); it abstains where it crosses an odd number of times (a
/// hole). Where votes are even, the side of the nearest triangle decides.
///
/// The grid holds the mesh, as plan_field makes it. Triangles face outwards, or mostly so.
/// InputError (`file`): no triangles, an index or position that is not valid, a mesh so open that
/// along some axis more than 5 % of the rays through it find a hole. Does not depend on threads.
DistanceField field_from_mesh(const TriangleMesh& mesh_tool, const FieldGrid& grid,
                              std::string_view file = {});

/// Throws the InputErrors of field_from_mesh that need no field.
void check_burr_mesh(const TriangleMesh& mesh_tool, std::string_view file);

}  // namespace sulcus
