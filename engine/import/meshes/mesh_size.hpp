#pragma once

#include <span>
#include <string>

#include "engine/import/meshes/voxelise_mesh.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// The longest side of the box about meshes of one space, metres.
double longest_side_m(std::span<const TissueSurface> surfaces);

/// Doubt about the unit of a mesh of a tooth, by its longest side, metres, as read in `unit`: "0.71
/// mm long, as no tooth is; in inches it would be 18 mm (unit = "in")", with every unit that makes
/// a tooth or a jaw of it, the likeliest first. Empty where it may be a tooth or a jaw as it is.
std::string doubt_size(double longest_m, MeshUnit unit);

}  // namespace sulcus
