#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/triangle_mesh.hpp"

// Solids with flat walls, for tests, of which each side leans by an angle of its own.

namespace sulcus::test {

/// A rectangle across z, mm: mesial is +x, buccal -y.
struct Rectangle {
  double distal, mesial, buccal, lingual;  // its edges: x, x, y, y
  double z;
};

/// How walls lean out, deg.
struct Tapers {
  double mesial, distal, buccal, lingual;
};

/// The rectangle `up` mm higher, each of its edges further out by the taper of its side.
inline Rectangle raised(const Rectangle& from, double up, const Tapers& tapers) {
  const auto wider = [&](double degrees) {
    return up * std::tan(degrees * std::numbers::pi / 180.0);
  };
  return {from.distal - wider(tapers.distal), from.mesial + wider(tapers.mesial),
          from.buccal - wider(tapers.buccal), from.lingual + wider(tapers.lingual), from.z + up};
}

/// From rectangle to rectangle, closed by the first from below and by the last from above: their
/// z goes down where there is a cavity. Each face in 2 n^2 triangles.
inline TriangleMesh lofted_mesh(const std::vector<Rectangle>& rectangles, int n,
                                const Eigen::Affine3d& placed) {
  TriangleMesh mesh;
  const auto face = [&](const std::array<Eigen::Vector3d, 4>& corner) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const auto across = static_cast<std::uint32_t>(n + 1);
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
        const Eigen::Vector3d p = (1 - v) * ((1 - u) * corner[0] + u * corner[1]) +
                                  v * ((1 - u) * corner[3] + u * corner[2]);
        // Rounded, so that faces meet to the bit.
        const Eigen::Vector3d rounded = (p * 1e9).array().round() / 1e9;
        mesh.positions.push_back((placed * (1e-3 * rounded)).cast<float>());
      }
    }
    for (std::uint32_t j = 0; j + 1 < across; ++j) {
      for (std::uint32_t i = 0; i + 1 < across; ++i) {
        const std::uint32_t a = first + j * across + i, b = a + 1, c = b + across, d = a + across;
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      }
    }
  };
  const auto corners = [](const Rectangle& r) {
    return std::array<Eigen::Vector3d, 4>{
        Eigen::Vector3d(r.distal, r.buccal, r.z), Eigen::Vector3d(r.mesial, r.buccal, r.z),
        Eigen::Vector3d(r.mesial, r.lingual, r.z), Eigen::Vector3d(r.distal, r.lingual, r.z)};
  };
  const auto bottom = corners(rectangles.front());
  face({bottom[0], bottom[3], bottom[2], bottom[1]});
  face(corners(rectangles.back()));
  for (std::size_t ring = 0; ring + 1 < rectangles.size(); ++ring) {
    const auto low = corners(rectangles[ring]), high = corners(rectangles[ring + 1]);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t j = (i + 1) % 4;
      face({low[i], low[j], high[j], high[i]});
    }
  }
  return mesh;
}

}  // namespace sulcus::test
