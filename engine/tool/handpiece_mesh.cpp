#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/units.hpp"
#include "engine/tool/burr_mesh.hpp"

namespace sulcus {
namespace {

// About those of a contra-angle for friction grip, with a small head.
constexpr double kFreeShank = 6.5 * kMillimetre;  // from the blades to the chuck, at least
constexpr double kChuckRadius = 1.9 * kMillimetre, kChuckLength = 1.6 * kMillimetre;
constexpr double kHeadRadius = 3.8 * kMillimetre, kHeadLength = 9.5 * kMillimetre;
constexpr double kNeckRadius = 2.6 * kMillimetre, kNeckLength = 30.0 * kMillimetre;
constexpr double kHandleRadius = 4.2 * kMillimetre;
constexpr double kNeckRise = 18.0 * kDegree;  // from square to the burr's axis, away from its tip

constexpr std::uint32_t kRodSectors = 64;  // round an axis

/// Radius and place along the axis, from the axis back to it.
using Outline = std::vector<Eigen::Vector2d>;

/// A quarter of an ellipse round an edge, both ends left out.
void round_off(Outline& outline, const Eigen::Vector2d& from, const Eigen::Vector2d& edge,
               const Eigen::Vector2d& to) {
  constexpr int kSteps = 10;
  // Before the outline grows: the ends may be points of it.
  const Eigen::Vector2d centre = from + to - edge;
  const Eigen::Vector2d first = from - centre, last = to - centre;
  for (int step = 1; step < kSteps; ++step) {
    const double angle = 0.5 * std::numbers::pi * step / kSteps;
    outline.push_back(centre + std::cos(angle) * first + std::sin(angle) * last);
  }
}

/// A closed rod of this outline with an axis of its own: its y goes where `tool_from_rod` says.
void add_rod(TriangleMesh& mesh, const Outline& outline, const Eigen::Isometry3d& tool_from_rod) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const auto rings = static_cast<std::uint32_t>(outline.size());
  for (const Eigen::Vector2d& p : outline) {
    for (std::uint32_t s = 0; s < kRodSectors; ++s) {
      const double angle = 2.0 * std::numbers::pi * s / kRodSectors;
      const Eigen::Vector3d p_rod(p.x() * std::cos(angle), p.y(), p.x() * std::sin(angle));
      mesh.positions.emplace_back((tool_from_rod * p_rod).cast<float>());
    }
  }
  const auto vertex = [&](std::uint32_t ring, std::uint32_t s) {
    return first + ring * kRodSectors + s % kRodSectors;
  };
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
    for (std::uint32_t s = 0; s < kRodSectors; ++s) {
      const std::uint32_t a = vertex(ring, s), b = vertex(ring, s + 1);
      const std::uint32_t c = vertex(ring + 1, s + 1), d = vertex(ring + 1, s);
      // At its ends a ring is a point, and one of the two has no area.
      if (ring + 2 < rings) mesh.triangles.push_back({a, d, c});
      if (ring > 0) mesh.triangles.push_back({a, c, b});
    }
  }
}

}  // namespace

TriangleMesh handpiece_mesh(const TriangleMesh& mesh_tool, double head_length_m) {
  TriangleMesh mesh;
  if (mesh_tool.positions.empty()) return mesh;
  double top = 0.0;
  for (const Eigen::Vector3f& p : mesh_tool.positions) {
    top = std::max(top, static_cast<double>(p.y()));
  }
  double shank_radius = 0.0;
  for (const Eigen::Vector3f& p : mesh_tool.positions) {
    if (p.y() < 0.95 * top) continue;
    shank_radius = std::max(shank_radius, static_cast<double>(std::hypot(p.x(), p.z())));
  }
  shank_radius = std::min(shank_radius, 0.8 * kChuckRadius);
  const double chuck = std::max(top, head_length_m + kFreeShank), head = chuck + kChuckLength;
  const double end = head + kHeadLength;
  constexpr double kEdge = 0.7 * kMillimetre, kDome = 2.6 * kMillimetre;

  // It begins within the burr's shank and comes out of it before that ends: neither a crack shows
  // between them, nor, as bright specks, the edge of the shank's end face.
  constexpr double kOverlap = 0.2 * kMillimetre;
  const double sleeve =
      shank_radius / std::cos(std::numbers::pi / kRodSectors);  // its flat sides too
  Outline outline{
      {0.0, top - kOverlap}, {0.99 * shank_radius, top - kOverlap}, {sleeve, top}, {sleeve, chuck}};
  outline.emplace_back(kChuckRadius, chuck);
  outline.emplace_back(kChuckRadius, head);
  outline.emplace_back(kHeadRadius - kEdge, head);
  round_off(outline, outline.back(), {kHeadRadius, head}, {kHeadRadius, head + kEdge});
  outline.emplace_back(kHeadRadius, head + kEdge);
  outline.emplace_back(kHeadRadius, end - kDome);
  round_off(outline, outline.back(), {kHeadRadius, end}, {0.4 * kHeadRadius, end});
  outline.emplace_back(0.4 * kHeadRadius, end);
  outline.emplace_back(0.0, end);
  add_rod(mesh, outline, Eigen::Isometry3d::Identity());

  Eigen::Isometry3d tool_from_neck = Eigen::Isometry3d::Identity();
  tool_from_neck.translation() = Eigen::Vector3d(0.0, head + 0.5 * kHeadLength, 0.0);
  tool_from_neck.rotate(
      Eigen::AngleAxisd(kNeckRise - 0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()));
  Outline neck{{0.0, 0.0}, {kNeckRadius, 0.0}, {kNeckRadius, 0.4 * kNeckLength}};
  neck.emplace_back(kHandleRadius, 0.75 * kNeckLength);
  neck.emplace_back(kHandleRadius, kNeckLength);
  neck.emplace_back(0.0, kNeckLength);
  add_rod(mesh, neck, tool_from_neck);
  return mesh;
}

}  // namespace sulcus
