#pragma once

#include <vector>

#include "engine/core/pose.hpp"
#include "engine/surface/drawn_surface.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// A body as it is given to the renderer: the workpiece, a neighbouring tooth, a jaw.
struct RenderedBody {
  VoxelModel model;
  std::vector<TissueLook> looks;  // one per tissue label of the model
  Pose world_from_grid;           // of the grid's centre; of the workpiece: the identity
};

}  // namespace sulcus
