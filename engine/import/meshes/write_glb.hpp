#pragma once

#include <span>
#include <string>

#include <Eigen/Core>

#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// Writes a mesh in metres as binary glTF 2.0 (.glb), as other programs take it: in metres, turned
/// so that what was up (+z) is +y, every vertex with its colour (COLOR_0, linear RGB; none where
/// `colours` is empty, else one for each). By assimp. An empty mesh is not written.
/// @throws InputError where it is empty, and as WholeFile; std::runtime_error where it cannot be
/// made or not all of it can be written.
void write_glb(const std::string& path, const TriangleMesh& mesh,
               std::span<const Eigen::Vector3f> colours);

}  // namespace sulcus
