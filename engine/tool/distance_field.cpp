#include "engine/tool/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/parallel.hpp"

namespace sulcus {

DistanceField field_from_profile(const BurrProfile& profile, const FieldGrid& grid) {
  DistanceField field(grid, FieldMirrors::kXAndZ);
  const Eigen::Vector3i n = grid.samples, kept = field.kept();
  // As near to the axis as the sample is that it mirrors.
  const auto radius = [&](int i, int k) {
    const Eigen::Vector3d p = grid.tool_from_field(
        Eigen::Vector3d(std::min(i, n.x() - 1 - i), 0, std::min(k, n.z() - 1 - k)));
    return std::sqrt(p.x() * p.x() + p.z() * p.z());
  };
  // Of a square also the mirror image in its diagonal.
  const bool square = n.x() == n.z() && grid.origin_tool.x() == grid.origin_tool.z();
  std::vector<double> radii;
  radii.reserve(static_cast<std::size_t>(kept.x()) * kept.z());
  for (int k = 0; k < kept.z(); ++k) {
    for (int i = 0; i < kept.x(); ++i) radii.push_back(radius(i, k));
  }
  parallel_ranges(0, n.y(), 1, [&](int low, int high) {
    for (int j = low; j < high; ++j) {
      const double y = grid.tool_from_field(Eigen::Vector3d(0, j, 0)).y();
      for (int k = 0; k < kept.z(); ++k) {
        for (int i = square ? k : 0; i < kept.x(); ++i) {
          const double r = radii[static_cast<std::size_t>(i + k * kept.x())];
          const auto value = static_cast<float>(profile.distance(r, y));
          field.kept_at(i, j, k) = value;
          if (square) field.kept_at(k, j, i) = value;
        }
      }
    }
  });
  return field;
}

}  // namespace sulcus
