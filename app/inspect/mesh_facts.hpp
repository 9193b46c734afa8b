#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/core/triangle_mesh.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// What inspect says of a mesh, and what its picture shows. Scene: the middle of the mesh's box is
/// at (0, 0, 0), as where a scene does not move or turn it.
struct MeshFacts {
  Eigen::AlignedBox3d box_file_m;
  double volume_m3 = 0.0;  // as the triangles sum it up; below 0: they face inwards
  std::size_t open_edges = 0, non_manifold_edges = 0;
  Eigen::Vector3d highest_scene_m = Eigen::Vector3d::Zero();

  Eigen::Vector3d scene_from_file(const Eigen::Vector3d& p_file) const {
    return p_file - box_file_m.center();
  }
};
MeshFacts mesh_facts(const TriangleMesh& mesh);

/// The command that cuts it, to be given to a shell as it is: the shipped scene for a mesh, a grid
/// that just holds it, and a way for the burr, down on its highest place.
std::string mesh_command(const std::string& file, MeshUnit unit, const MeshFacts& facts);

/// Draws it from above, from the front and from the side, at one scale, with axes in millimetres of
/// the scene and its highest place marked. False where gnuplot cannot.
bool draw_mesh(const TriangleMesh& mesh, const MeshFacts& facts, const std::string& name,
               const std::string& file_png);

}  // namespace sulcus
