#pragma once

#include <functional>
#include <string_view>

#include <Eigen/Core>

#include "engine/core/triangle_mesh.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/distance_field.hpp"

namespace sulcus {

/// All points within a radius of a segment, in tool space, m.
struct Capsule {
  Eigen::Vector3d a_tool = Eigen::Vector3d::Zero();  // end near the tip
  Eigen::Vector3d b_tool = Eigen::Vector3d::Zero();  // end near the shank
  double radius_m = 0.0;
};

/// The tool as the tick and the renderer need it. Tool space: tip at the origin, +y to the shank.
struct Burr {
  TriangleMesh mesh_tool;  // closed, outward, m
  DistanceField field;
  Capsule capsule;             // holds all of the burr: where the field is not positive
  double head_length_m = 0.0;  // the cutting part is y <= this
  double rim_radius_m = 0.0;   // the largest of the head
  double reference_m = 0.0;    // torques are about the point this far from the tip along +y
  double speed_rad_per_s = 0.0;
  double tangential_ratio = 0.0;  // beta of [Kim and Park 2019, eq. 7]
};

/// How a burr comes by its field: by `make`, or by what an earlier call of it made for the same
/// burr and grid. `mesh_tool` is null for a generated burr.
using FieldSource =
    std::function<DistanceField(const FieldGrid& grid, const TriangleMesh* mesh_tool,
                                const std::function<DistanceField()>& make)>;
/// Always makes it.
inline DistanceField make_field(const FieldGrid&, const TriangleMesh*,
                                const std::function<DistanceField()>& make) {
  return make();
}

/// A generated burr. `voxel_m` is the workpiece's, for `field = "auto"`; `scene_file` is named in
/// errors. InputError as make_burr_profile and plan_field.
Burr make_burr(const BurrSettings& settings, double voxel_m, std::string_view scene_file = {},
               const FieldSource& field_source = make_field);

/// A burr from a closed mesh in tool space, m (tool_from_file makes one of a file's). One whose
/// triangles face inwards is turned. All of it cuts, unless `length_m` says how much; the diameter
/// of the settings plays no part. InputError as field_from_mesh and plan_field, and (of
/// `settings.file`) where its size is not that of a burr.
Burr make_burr(const BurrSettings& settings, double voxel_m, TriangleMesh mesh_tool,
               std::string_view scene_file = {}, const FieldSource& field_source = make_field);

/// The thinnest capsule along the tool's axis that holds all vertices; of those the shortest.
Capsule axial_capsule(const TriangleMesh& mesh_tool);

}  // namespace sulcus
