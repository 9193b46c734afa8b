#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/scene/scene.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

class LoadCache;

/// What a scene is made of, read and built.
struct SceneParts {
  Burr burr;
  VoxelModel workpiece;
  std::vector<VoxelModel> bodies;  // beside it, in the scene's order
  Trajectory trajectory;
};

/// Builds them; `own`: the workpiece's voxels, where they do not come from the scene; `cache`:
/// where what loading makes is kept. InputError as the importers, and where the trajectory is a
/// recording's. In a build without import, where the scene names a file of a volume or mesh.
SceneParts load_parts(const Scene& scene, std::optional<VoxelModel> own = {},
                      LoadCache* cache = nullptr);

/// One byte a voxel of the scene's grid, x fastest: 0 empty, else 1 + its tissue. InputError where
/// there are not as many as cells, one is of a tissue that the scene has not, or all are empty.
VoxelModel own_voxels(const Scene& scene, std::span<const std::uint8_t> voxels);

}  // namespace sulcus
