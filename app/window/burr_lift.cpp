#include "app/window/burr_lift.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/core/units.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

double room_round(const VoxelModel& model, const Burr& burr, const Pose& tool, double most_m) {
  const VoxelGrid& grid = model.grid;
  const Eigen::Vector3d wide(burr.rim_radius_m, 0.0, burr.rim_radius_m);
  const Eigen::AlignedBox3d head_tool(-wide, wide + burr.head_length_m * Eigen::Vector3d::UnitY());
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

namespace {

/// The centres of the solid's outer voxels in a box of tool space: who comes from outside meets
/// them first.
std::vector<Eigen::Vector3d> outer_voxels(const VoxelModel& model, const Pose& tool,
                                          const Eigen::AlignedBox3d& box_tool) {
  const VoxelGrid& grid = model.grid;
  const double leaf_m = kLeafEdge * grid.voxel_m;  // more than from its middle to any of its voxels
  std::vector<Eigen::Vector3d> outer;
  for (std::uint32_t leaf = 0; leaf < grid.leaf_count(); ++leaf) {
    if (!any(model.leaves[leaf])) continue;
    const Cell first = grid.leaf_origin(leaf);
    const Eigen::Vector3d middle =
        tool.inverse_point(grid.centre_world(first + Cell::Constant(kLeafEdge / 2)));
    if (box_tool.exteriorDistance(middle) > leaf_m) continue;
    for_each_voxel(surface_of_leaf(model, leaf), [&](int place) {
      const Eigen::Vector3d p_tool =
          tool.inverse_point(grid.centre_world(first + cell_in_leaf(place)));
      if (box_tool.contains(p_tool)) outer.push_back(p_tool);
    });
  }
  return outer;
}

/// How far the head goes along a way, of unit length, until the gap is there; none where something
/// is in the way that it would go deeper into than `least_m`.
std::optional<double> way_out(const VoxelModel& model, const Burr& burr, const Pose& tool,
                              const Eigen::Vector3d& along_tool, double longest_m, double least_m,
                              double clearance_m) {
  const Eigen::Vector3d wide(burr.rim_radius_m, 0.0, burr.rim_radius_m);
  Eigen::AlignedBox3d swept(-wide, wide + burr.head_length_m * Eigen::Vector3d::UnitY());
  swept.extend(Eigen::AlignedBox3d(swept).translate(longest_m * along_tool));
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(clearance_m);
  const std::vector<Eigen::Vector3d> outer =
      outer_voxels(model, tool, {swept.min() - margin, swept.max() + margin});
  const double step = std::max(0.25 * clearance_m, model.grid.voxel_m);
  for (double gone = step; gone <= longest_m; gone += step) {
    double room = clearance_m;
    for (const Eigen::Vector3d& p_tool : outer) {
      const Eigen::Vector3d now = p_tool - gone * along_tool;
      if (now.y() > burr.head_length_m + clearance_m) continue;  // at the shank
      room = std::min(room, static_cast<double>(
                                burr.field.sample(burr.field.field_from_tool(now).cast<float>())));
      if (room < least_m) return {};
    }
    if (room >= clearance_m) return gone;
  }
  return {};
}

}  // namespace

std::optional<Pose> drawn_back(const VoxelModel& model, const Burr& burr, const Pose& tool,
                               double clearance_m) {
  const double now = room_round(model, burr, tool, clearance_m);
  if (now >= clearance_m) return tool;
  // A burr in contact is a part of a voxel inside.
  const double least = std::min(now, 0.0) - 0.5 * model.grid.voxel_m;
  constexpr double kAlong_m = 25.0 * kMillimetre, kAcross_m = 4.0 * kMillimetre;
  const std::array<Eigen::Vector3d, 5> ways{{Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX(),
                                             -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(),
                                             -Eigen::Vector3d::UnitZ()}};
  for (const Eigen::Vector3d& along : ways) {
    const double longest = along.y() > 0.0 ? kAlong_m : kAcross_m;
    const auto gone = way_out(model, burr, tool, along, longest, least, clearance_m);
    if (gone) return Pose{tool.position + *gone * tool.direction(along), tool.orientation};
  }
  return {};
}

}  // namespace sulcus
