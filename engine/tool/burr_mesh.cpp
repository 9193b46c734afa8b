#include "engine/tool/burr_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sulcus {
namespace {

using Eigen::Vector2d;

constexpr int kSectors = 96;
constexpr double kSag = 6e-4;  // of the largest radius; what 96 sectors leave around

/// The outline as points, ends exact, arcs in equal steps fine enough for kSag.
std::vector<Vector2d> outline_points(const BurrProfile& profile) {
  std::vector<Vector2d> points{profile.pieces().front().start};
  for (const ProfilePiece& piece : profile.pieces()) {
    if (piece.radius > 0.0) {
      const Vector2d a = (piece.start - piece.centre) / piece.radius;
      const Vector2d b = (piece.end - piece.centre) / piece.radius;
      const double span = std::acos(std::clamp(a.dot(b), -1.0, 1.0));
      // A chord over the angle s leaves radius (1 - cos(s / 2)), about radius s^2 / 8.
      const double step = std::sqrt(8.0 * kSag * profile.max_radius_m() / piece.radius);
      const int steps = std::max(2, static_cast<int>(std::ceil(span / step)));
      for (int s = 1; s < steps; ++s) {
        const Eigen::Rotation2Dd turn(piece.turn * span * s / steps);
        points.push_back(piece.centre + turn * (piece.start - piece.centre));
      }
    }
    points.push_back(piece.end);
  }
  return points;
}

}  // namespace

TriangleMesh revolve(const BurrProfile& profile) {
  const std::vector<Vector2d> points = outline_points(profile);
  const int rings = static_cast<int>(points.size()) - 2;  // first and last point are on the axis

  TriangleMesh mesh;
  mesh.positions.emplace_back(Eigen::Vector3d(0.0, points.front().y(), 0.0).cast<float>());
  for (int ring = 1; ring <= rings; ++ring) {
    for (int s = 0; s < kSectors; ++s) {
      const double angle = 2.0 * std::numbers::pi * s / kSectors;
      const Vector2d& p = points[ring];
      mesh.positions.emplace_back(
          Eigen::Vector3d(p.x() * std::cos(angle), p.y(), p.x() * std::sin(angle)).cast<float>());
    }
  }
  mesh.positions.emplace_back(Eigen::Vector3d(0.0, points.back().y(), 0.0).cast<float>());

  const auto vertex = [](int ring, int s) {
    return static_cast<std::uint32_t>(1 + (ring - 1) * kSectors + s % kSectors);
  };
  const std::uint32_t tip = 0;
  const auto top = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (int s = 0; s < kSectors; ++s) {
    mesh.triangles.push_back({tip, vertex(1, s), vertex(1, s + 1)});
    for (int ring = 1; ring < rings; ++ring) {
      const std::uint32_t a = vertex(ring, s), b = vertex(ring, s + 1);
      const std::uint32_t c = vertex(ring + 1, s + 1), d = vertex(ring + 1, s);
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({a, d, c});
    }
    mesh.triangles.push_back({top, vertex(rings, s + 1), vertex(rings, s)});
  }
  return mesh;
}

TriangleMesh tool_from_file(const TriangleMesh& mesh_file) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh_file.positions) box.extend(p);

  TriangleMesh mesh_tool = mesh_file;
  for (Eigen::Vector3f& p : mesh_tool.positions) {
    const Eigen::Vector3f from_tip(p.x() - 0.5f * (box.min().x() + box.max().x()),
                                   p.y() - 0.5f * (box.min().y() + box.max().y()),
                                   p.z() - box.min().z());
    // A quarter turn about x: file z becomes tool y, handedness kept.
    p = Eigen::Vector3f(from_tip.x(), from_tip.z(), -from_tip.y());
  }
  return mesh_tool;
}

}  // namespace sulcus
