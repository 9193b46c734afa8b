#include "engine/tool/distance_field.hpp"

#include <cmath>
#include <vector>

#include "engine/core/parallel.hpp"

namespace sulcus {

DistanceField field_from_profile(const BurrProfile& profile, const FieldGrid& grid) {
  DistanceField field(grid);
  const Eigen::Vector3i n = grid.samples;
  const int half_x = (n.x() + 1) / 2, half_z = (n.z() + 1) / 2;

  // Radii of one quadrant of samples; the other three are its mirror images.
  std::vector<double> radii(static_cast<std::size_t>(half_x) * half_z);
  for (int k = 0; k < half_z; ++k) {
    for (int i = 0; i < half_x; ++i) {
      const Eigen::Vector3d p = grid.tool_from_field(Eigen::Vector3d(i, 0, k));
      radii[static_cast<std::size_t>(i + k * half_x)] = std::sqrt(p.x() * p.x() + p.z() * p.z());
    }
  }
  parallel_ranges(0, n.y(), 1, [&](int low, int high) {
    for (int j = low; j < high; ++j) {
      const double y = grid.tool_from_field(Eigen::Vector3d(0, j, 0)).y();
      for (int k = 0; k < half_z; ++k) {
        for (int i = 0; i < half_x; ++i) {
          const double r = radii[static_cast<std::size_t>(i + k * half_x)];
          const auto value = static_cast<float>(profile.distance(r, y));
          const int i2 = n.x() - 1 - i, k2 = n.z() - 1 - k;
          field.at(i, j, k) = value;
          field.at(i2, j, k) = value;
          field.at(i, j, k2) = value;
          field.at(i2, j, k2) = value;
        }
      }
    }
  });
  return field;
}

}  // namespace sulcus
