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
  const bool told = use_tool(settings.normals);
  scratch.queries.clear();
  for (const Contact& contact : scratch.contacts) {
    VoxelQuery& query = scratch.queries.emplace_back(VoxelQuery{contact.cell});
    if (!told) continue;
    query.outward =
        out_of_tooth(field, world_from_tool, workpiece.grid().centre_world(contact.cell));
  }
  scratch.estimates.resize(scratch.queries.size());
  estimate_surfaces(workpiece, scratch.queries, settings, scratch.estimates);

  const auto voxel_m = static_cast<float>(workpiece.grid().voxel_m);
  for (std::size_t k = 0; k < scratch.contacts.size(); ++k) {
    const SurfaceEstimate& estimate = scratch.estimates[k];
    if (!estimate.defined) continue;
    scratch.contacts[k].normal = estimate.normal;
    scratch.contacts[k].offset_m = estimate.offset * voxel_m;
  }
}

}  // namespace sulcus
