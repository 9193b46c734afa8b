#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/cache/load_cache.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/input_geometry.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The voxels of a scene's workpiece: a built-in shape (build_shape), a medical volume or a mesh,
/// told apart by the file's name, with a mesh those of the tissues as well; with a cache it may
/// come from there, the same voxels and the same tissues of them. `notes`: what else the import
/// tells, also from the cache. InputError as the importers; also where the grid holds no solid
/// voxel. Runs on oneTBB.
VoxelModel build_workpiece(const Scene& scene, LoadCache* cache = nullptr,
                           ImportNotes* notes = nullptr);

/// Those of its other bodies, each in its own grid, in their order. A body of one tissue has no
/// labels; a mesh is of one, since the tissues' own meshes are the workpiece's. `warnings`: what
/// their imports tell is added, each with its table ahead.
std::vector<VoxelModel> build_bodies(const Scene& scene, LoadCache* cache = nullptr,
                                     std::vector<std::string>* warnings = nullptr);

/// What the file of its goal holds, on the workpiece's grid; none where no goal names one.
std::optional<VoxelModel> build_goal(const Scene& scene, LoadCache* cache = nullptr,
                                     std::vector<std::string>* warnings = nullptr);

}  // namespace sulcus
