#include "app/window/burr_lift.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/units.hpp"

namespace sulcus {

double room_round(const VoxelModel& model, const Burr& burr, const Pose& tool, double most_m) {
  const VoxelGrid& grid = model.grid;
  const Eigen::Vector3d wide(burr.rim_radius_m, 0.0, burr.rim_radius_m);
  Eigen::AlignedBox3d head_tool(-wide, wide + burr.head_length_m * Eigen::Vector3d::UnitY());
  Eigen::AlignedBox3d box;
  for (int corner = 0; corner < 8; ++corner) {
    box.extend(tool.point(head_tool.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
  }
  const auto leaf_at = [&](const Eigen::Vector3d& p) {
    const Cell c = grid.index_from_world(p).array().round().cast<int>();
    return Eigen::Vector3i(c.cwiseMax(0).cwiseMin(grid.cells - Cell::Ones()) / kLeafEdge);
  };
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(most_m + grid.voxel_m);
  const Eigen::Vector3i first = leaf_at(box.min() - margin), last = leaf_at(box.max() + margin);
  double room = most_m;
  for (int k = first.z(); k <= last.z(); ++k) {
    for (int j = first.y(); j <= last.y(); ++j) {
      for (int i = first.x(); i <= last.x(); ++i) {
        const Cell origin = kLeafEdge * Cell(i, j, k);
        for_each_voxel(model.leaves[grid.leaf_of(origin)], [&](int place) {
          const Eigen::Vector3d p_tool =
              tool.inverse_point(grid.centre_world(origin + cell_in_leaf(place)));
          if (p_tool.y() > burr.head_length_m + most_m) return;  // at the shank
          const Eigen::Vector3f p_field = burr.field.field_from_tool(p_tool).cast<float>();
          room = std::min(room, static_cast<double>(burr.field.sample(p_field)));
        });
      }
    }
  }
  return room;
}

std::optional<Pose> drawn_back(const VoxelModel& model, const Burr& burr, const Pose& tool,
                               double clearance_m) {
  const double now = room_round(model, burr, tool, clearance_m);
  if (now >= clearance_m) return tool;
  // A burr in contact is a part of a voxel inside.
  const double least = std::min(now, 0.0) - 0.5 * model.grid.voxel_m;
  struct Way {
    Eigen::Vector3d along_tool;
    double longest_m;
  };
  constexpr double kAcross_m = 4.0 * kMillimetre;
  const std::array<Way, 5> ways{{{Eigen::Vector3d::UnitY(), 25.0 * kMillimetre},
                                 {Eigen::Vector3d::UnitX(), kAcross_m},
                                 {-Eigen::Vector3d::UnitX(), kAcross_m},
                                 {Eigen::Vector3d::UnitZ(), kAcross_m},
                                 {-Eigen::Vector3d::UnitZ(), kAcross_m}}};
  // Steps as long as what is left to a gap: nothing is nearer after one, and none is stepped over
  // that the head would go into by more than a part of a voxel.
  const double step = std::min(0.5 * clearance_m, model.grid.voxel_m);
  for (const Way& way : ways) {
    Pose pose = tool;
    for (double gone = step; gone <= way.longest_m; gone += step) {
      pose.position = tool.position + gone * tool.direction(way.along_tool);
      const double room = room_round(model, burr, pose, clearance_m);
      if (room < least) break;
      if (room >= clearance_m) return pose;
    }
  }
  return {};
}

}  // namespace sulcus
