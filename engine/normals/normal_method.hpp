#pragma once

#include <span>

#include "engine/normals/normal_settings.hpp"
#include "engine/normals/surface_estimate.hpp"
#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Makes the tables that the methods share, so that no tick does. Called when a scene loads.
void prepare_normals() noexcept;

/// Normals of surface voxels by the method that a scene names, one for each query. What is felt is
/// what is seen: forces and pictures call this. What the tool knows is for the methods that
/// `use_tool` is true of; the others do without it.
constexpr bool use_tool(NormalMethod method) {
  return method == NormalMethod::kLdm || method == NormalMethod::kLdmFast;
}
void estimate_surfaces(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                       const NormalSettings& settings,
                       std::span<SurfaceEstimate> estimates) noexcept;

SurfaceEstimate estimate_surface(const Workpiece& workpiece, const Cell& voxel,
                                 const NormalSettings& settings,
                                 const Eigen::Vector3f& outward = Eigen::Vector3f::Zero()) noexcept;

}  // namespace sulcus
