#include "haptics/normals.hpp"

#include "engine/normals/normal_method.hpp"

namespace sulcus {

namespace {

/// Away from the burr's surface at a point, turned into the burr: out of the tooth. Of any length.
Eigen::Vector3f out_of_tooth(const DistanceField& field, const Pose& world_from_tool,
                             const Eigen::Vector3d& point_world) {
  Eigen::Vector3f gradient_tool;
  field.sample_with_gradient(
      field.field_from_tool(world_from_tool.inverse_point(point_world)).cast<float>(),
      gradient_tool);
  return -world_from_tool.direction(gradient_tool.cast<double>()).cast<float>();
}

}  // namespace

void normals(const Workpiece& workpiece, const DistanceField& field, const Pose& world_from_tool,
             const HapticsSettings& settings, ContactScratch& scratch) noexcept {
  const auto voxel_m = static_cast<float>(workpiece.grid().voxel_m);
  for (Contact& contact : scratch.contacts) {
    SurfaceEstimate estimate = estimate_surface(workpiece, contact.cell, settings);
    if (!estimate.defined) {
      const Eigen::Vector3d centre_world = workpiece.grid().centre_world(contact.cell);
      estimate = estimate_surface(workpiece, contact.cell, settings,
                                  out_of_tooth(field, world_from_tool, centre_world));
    }
    if (!estimate.defined) continue;
    contact.normal = estimate.normal;
    contact.offset_m = estimate.offset * voxel_m;
  }
}

}  // namespace sulcus
