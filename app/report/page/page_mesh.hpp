#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// How far the surface that a page shows may be from a vertex of the surface that it stands for.
inline constexpr double kMostPageError_m = 0.05e-3;

/// Outward unit normals of a mesh's vertices, area-weighted, then averaged with their neighbours'
/// so many times: the steps of voxels, which triangles alone would show, are lit away.
std::vector<Eigen::Vector3f> smoothed_normals(const TriangleMesh& mesh, int passes = 3);

/// The greatest distance of the vertices of `from` to the surface of `to`, where it is not above
/// `limit_m`; else infinity. Exact. Runs on oneTBB.
double greatest_distance(const TriangleMesh& from, const TriangleMesh& to, double limit_m);

/// Some triangles of a mesh by themselves: a mesh, and which vertex of the whole each of its is.
struct MeshPart {
  TriangleMesh mesh;
  std::vector<std::uint32_t> vertex_of;
};
MeshPart part_of(const TriangleMesh& mesh, const std::vector<std::size_t>& triangles);

/// The same surface in fewer triangles, which keeps some of its vertices: none of those that go is
/// farther from it than `most_m`, which is measured and not left to the estimate of the method
/// [Garland and Heckbert 1997, by meshoptimizer]. Edges of one triangle stay as they are, so that
/// parts that fitted together still do. Only vertices that are used are left.
MeshPart simplified(const TriangleMesh& mesh, double most_m = kMostPageError_m);

}  // namespace sulcus
