#include "engine/surface/normal_cone.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace sulcus {
namespace {

/// Twice the area of a triangle along its normal.
Eigen::Vector3f area_normal(const DrawnMesh& mesh, std::size_t first_index) {
  const auto corner = [&](std::size_t i) -> Eigen::Vector3f {
    const auto& p = mesh.vertices[mesh.indices[first_index + i]].position_m;
    return {p[0], p[1], p[2]};
  };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

}  // namespace

NormalCone normal_cone(const DrawnMesh& mesh) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) sum += area_normal(mesh, i);
  NormalCone cone{sum.stableNormalized(), mesh.indices.empty() ? -1.0f : 1.0f};
  const float sliver = 1e-6f * sum.stableNorm() / static_cast<float>(mesh.indices.size() + 1);
  for (std::size_t i = 0; i < mesh.indices.size() && cone.cosine > 0.0f; i += 3) {
    const Eigen::Vector3f normal = area_normal(mesh, i);
    const float length = normal.stableNorm();
    // The direction of a sliver is rounding; it covers no pixel from either side.
    if (length > sliver) cone.cosine = std::min(cone.cosine, cone.axis.dot(normal) / length);
  }
  return cone;
}

bool faces_away(const NormalCone& cone, const Eigen::AlignedBox3f& box,
                const Eigen::Vector3f& eye) {
  if (cone.cosine <= 0.0f) return false;
  // From any point of the ball round the box the eye is within `spread` of this direction; a
  // triangle faces away where it is 90 degrees or more from its normal.
  const Eigen::Vector3f towards = eye - box.center();
  const float distance = towards.norm();
  const float sine_spread = 0.5f * box.diagonal().norm() / distance;
  if (!(sine_spread < 1.0f)) return false;
  const float cosine_spread = std::sqrt(1.0f - sine_spread * sine_spread);
  const float sine_cone = std::sqrt(std::max(0.0f, 1.0f - cone.cosine * cone.cosine));
  // cos(angle) < cos(90 deg + cone + spread), with their sum below 90 degrees.
  const float sine_sum = sine_cone * cosine_spread + cone.cosine * sine_spread;
  const float cosine_sum = cone.cosine * cosine_spread - sine_cone * sine_spread;
  return cosine_sum > 0.0f && cone.axis.dot(towards) < -sine_sum * distance;
}

}  // namespace sulcus
