#pragma once

#include "engine/core/triangle_mesh.hpp"
#include "engine/tool/burr_profile.hpp"

namespace sulcus {

/// The burr as a closed mesh in tool space, m, outward: the profile revolved about +y. Vertices lie
/// on the surface, chords stay within 6e-4 of the largest radius of it.
TriangleMesh revolve(const BurrProfile& profile);

/// From a burr's mesh file to tool space. In the file the axis is z, from tip to shank; where the
/// origin is does not matter: the tip (lowest z) goes to the tool's origin and the middle of the
/// bounding box in x and y to the tool's axis. Lengths are kept. An empty mesh stays empty.
TriangleMesh tool_from_file(const TriangleMesh& mesh_file);

/// The handpiece that a burr hangs in, for pictures alone, in tool space, m, outward: what more of
/// the shank is seen, a chuck, a short rounded head as of a contra-angle, and a neck that goes off
/// at an angle towards +x. It neither touches nor cuts anything. `mesh_tool`, `head_length_m`: the
/// burr's, whose shank it takes up at the end; an empty one has none.
TriangleMesh handpiece_mesh(const TriangleMesh& mesh_tool, double head_length_m);

}  // namespace sulcus
