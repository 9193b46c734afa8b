#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// A ball of radius 1 about the origin from an icosahedron cut `levels` times, counter-clockwise
/// from outside.
inline TriangleMesh icosphere(int levels) {
  const float g = (1.0f + std::sqrt(5.0f)) / 2.0f;
  TriangleMesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Eigen::Vector3f& p : mesh.positions) p.normalize();
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, inserted] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (inserted) {
        mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]).normalized());
      }
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  return mesh;
}

/// A box about the origin.
inline TriangleMesh box_mesh(const Eigen::Vector3f& size) {
  TriangleMesh mesh;
  for (int v = 0; v < 8; ++v) {
    mesh.positions.push_back(size.cwiseProduct(
        Eigen::Vector3f(static_cast<float>(v & 1) - 0.5f, static_cast<float>(v >> 1 & 1) - 0.5f,
                        static_cast<float>(v >> 2) - 0.5f)));
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline void scale(TriangleMesh& mesh, float factor) {
  for (Eigen::Vector3f& p : mesh.positions) p *= factor;
}

/// By the divergence theorem, of a closed mesh.
inline double enclosed_volume(const TriangleMesh& mesh) {
  double six = 0.0;
  const Eigen::Vector3d o = mesh.positions.front().cast<double>();
  for (const auto& [a, b, c] : mesh.triangles) {
    six +=
        (mesh.positions[a].cast<double>() - o)
            .dot(
                (mesh.positions[b].cast<double>() - o).cross(mesh.positions[c].cast<double>() - o));
  }
  return six / 6.0;
}

}  // namespace sulcus
