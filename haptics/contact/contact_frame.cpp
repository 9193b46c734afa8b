#include "haptics/contact/contact_frame.hpp"

#include <algorithm>
#include <cmath>

namespace sulcus {

ContactFrame::ContactFrame(const VoxelGrid& grid, const DistanceField& field, const Pose& pose,
                           double reference_m)
    : values(field.values().data()),
      row(static_cast<std::int32_t>(field.row_pitch())),
      slice(static_cast<std::int32_t>(field.slice_pitch())),
      spacing_m(static_cast<float>(field.spacing_m())),
      voxel_m(static_cast<float>(grid.voxel_m)) {
  const Eigen::Matrix3d rotation = pose.orientation.toRotationMatrix();
  const Eigen::Vector3d tip = grid.index_from_world(pose.position);
  Cell from;
  for (int a = 0; a < 3; ++a) {
    from[a] = static_cast<int>(std::clamp(std::round(tip[a]), -2048.0, 4096.0));
  }
  const Eigen::Vector3d centre_world = grid.centre_world(from);
  const Eigen::Vector3d at = field.field_from_tool(pose.inverse_point(centre_world));
  const Eigen::Matrix3d per_voxel = rotation.transpose() * (grid.voxel_m / field.spacing_m());
  const Eigen::Vector3d arm = centre_world - (pose.position + reference_m * rotation.col(1));
  for (int a = 0; a < 3; ++a) {
    most[a] = field.samples()[a] - 2;
    most_kept[a] = field.kept()[a] - 2;
    last[a] = static_cast<float>(field.samples()[a] - 1);
    cell[a] = from[a];
    base[a] = static_cast<float>(at[a]);
    arm_m[a] = static_cast<float>(arm[a]);
    for (int b = 0; b < 3; ++b) {
      step[a][b] = static_cast<float>(per_voxel(a, b));
      world_from_tool[a][b] = static_cast<float>(rotation(a, b));
    }
  }
}

}  // namespace sulcus
