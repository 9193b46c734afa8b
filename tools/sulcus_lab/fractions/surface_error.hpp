#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/core/triangle_mesh.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus::lab {

/// How far a point is from a surface that is known.
struct KnownDistance {
  double off_m = 0.0;  // signed, positive outside; not finite: not to be measured
  int zone = 0;
};

/// A body in closed form, and the voxels that are made of it.
struct KnownBody {
  std::string name;
  std::vector<std::string> zones;  // of its surface, told apart
  double voxel_m = 0.0;
  std::function<VoxelModel(SurfaceKind)> model;
  std::function<KnownDistance(const Eigen::Vector3d& p_world)> distance;
};

/// Bodies in tilted positions, off the lattice: sphere, torus, planes, rotated_cube, molar.
/// `quick`: without the molar. Planes are one body each, with the same name.
std::vector<KnownBody> known_bodies(bool quick);

/// What distances (voxels) of a mesh from the surface that it should have come to: their squares
/// by the area that each stands for, and that area.
struct SurfaceSum {
  double squares_m2 = 0.0, area_m2 = 0.0;
};
/// One for each zone, of three points of every triangle, each with a third of its area.
std::vector<SurfaceSum> surface_sums(const TriangleMesh& mesh, const KnownBody& body);

/// What is exported of a model (closed_surface), and what is drawn of it in full detail
/// (DrawnSurface): world, m.
TriangleMesh exported_mesh(const VoxelModel& model);
TriangleMesh drawn_mesh(VoxelModel model);

}  // namespace sulcus::lab
