#pragma once

#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// The handpiece that a burr hangs in, for pictures alone, in tool space, m, outward: what more of
/// the shank is seen, a chuck, a short rounded head as of a contra-angle, and a neck that goes off
/// at an angle towards +x. It neither touches nor cuts anything. `mesh_tool`, `head_length_m`: the
/// burr's, whose shank it takes up at the end; an empty one has none.
TriangleMesh handpiece_mesh(const TriangleMesh& mesh_tool, double head_length_m);

}  // namespace sulcus
