#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/core/triangle_mesh.hpp"
#include "engine/surface/drawn_surface.hpp"

namespace sulcus::test {

/// All bricks of a drawn surface, those that share vertices each with its own.
inline std::vector<DrawnMesh> all_bricks(const DrawnSurface& surface) {
  std::vector<DrawnMesh> bricks(static_cast<std::size_t>(surface.brick_count()));
  DrawnSurface::Scratch scratch;
  for (int b = 0; b < surface.brick_count(); ++b) {
    surface.mesh(b, scratch, bricks[static_cast<std::size_t>(b)]);
  }
  return bricks;
}

inline TriangleMesh joined(const std::vector<DrawnMesh>& bricks) {
  TriangleMesh mesh;
  for (const DrawnMesh& brick : bricks) {
    const auto before = static_cast<std::uint32_t>(mesh.positions.size());
    for (const DrawnVertex& v : brick.vertices) {
      mesh.positions.emplace_back(v.position_m[0], v.position_m[1], v.position_m[2]);
    }
    for (std::size_t i = 0; i < brick.indices.size(); i += 3) {
      mesh.triangles.push_back({before + brick.indices[i], before + brick.indices[i + 1],
                                before + brick.indices[i + 2]});
    }
  }
  return mesh;
}

/// Edges of triangles whose opposite no triangle has. Vertices at the same place are one.
inline std::size_t open_edges(const TriangleMesh& mesh) {
  using Place = std::array<float, 3>;
  std::vector<std::pair<Place, std::uint32_t>> places;
  places.reserve(mesh.positions.size());
  for (const Eigen::Vector3f& p : mesh.positions) {
    places.push_back({{p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(places.size())});
  }
  std::sort(places.begin(), places.end());
  std::vector<std::uint64_t> first_of(places.size());  // of the vertices at a vertex's place
  for (std::size_t i = 0, first = 0; i < places.size(); ++i) {
    if (places[i].first != places[first].first) first = i;
    first_of[places[i].second] = first;
  }
  std::vector<std::pair<std::uint64_t, int>> edges;  // ends, the lesser first; 1 from it, -1 to it
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t a = first_of[t[i]], b = first_of[t[(i + 1) % 3]];
      if (a != b) edges.emplace_back(std::min(a, b) << 32 | std::max(a, b), a < b ? 1 : -1);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (std::size_t i = 0; i < edges.size();) {
    const std::uint64_t edge = edges[i].first;
    int balance = 0;
    for (; i < edges.size() && edges[i].first == edge; ++i) balance += edges[i].second;
    open += balance != 0 ? 1 : 0;
  }
  return open;
}

/// How far a mesh is from a surface that it should have.
struct Distances {
  double vertices_rms = 0.0, inside_rms = 0.0;  // m: at vertices; inside triangles, by their area
  double most = 0.0;                            // m, of both
  std::size_t vertices = 0;
  std::size_t turned = 0;  // triangles that face into the solid
};

/// `distance(p)`: signed, m, of a point in world; NaN: not to be measured. `outward(p)`: up it.
template <class Distance, class Outward>
Distances distances(const TriangleMesh& mesh, const Distance& distance, const Outward& outward) {
  Distances all;
  double vertex_sum = 0.0, inside_sum = 0.0, area_sum = 0.0;
  for (const Eigen::Vector3f& p : mesh.positions) {
    const double d = distance(Eigen::Vector3d(p.cast<double>()));
    if (std::isnan(d)) continue;
    ++all.vertices;
    vertex_sum += d * d;
    all.most = std::max(all.most, std::abs(d));
  }
  // Three points of each triangle, all of which it is the mean of.
  constexpr std::array<std::array<double, 3>, 3> kInside{
      {{0.6, 0.2, 0.2}, {0.2, 0.6, 0.2}, {0.2, 0.2, 0.6}}};
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[t[2]].cast<double>();
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const Eigen::Vector3d middle = (a + b + c) / 3.0;
    if (std::isnan(distance(middle))) continue;
    all.turned += normal.dot(outward(middle)) < 0.0 ? 1 : 0;
    for (const auto& [u, v, w] : kInside) {
      const double d = distance(Eigen::Vector3d(u * a + v * b + w * c));
      if (std::isnan(d)) continue;
      inside_sum += normal.norm() * d * d;
      area_sum += normal.norm();
      all.most = std::max(all.most, std::abs(d));
    }
  }
  all.vertices_rms = std::sqrt(vertex_sum / static_cast<double>(all.vertices));
  all.inside_rms = std::sqrt(inside_sum / area_sum);
  return all;
}

}  // namespace sulcus::test
