#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "app/report/page/page_mesh.hpp"
#include "engine/outcome/voxel_set.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// A surface as a page draws it: simplified (kMostPageError_m), grid space, m.
struct PageSurface {
  TriangleMesh mesh;
  std::vector<Eigen::Vector3f> normals;
};

/// A tooth over time: what never changes, and for each moment what may, which fit together at
/// edges that both have.
struct PageSolid {
  /// Of the tissue of that label; empty where none of it is seen.
  std::vector<PageSurface> still;
  /// In their order; none where nothing changes. `shown`: which of them, of each moment.
  std::vector<PageSurface> moving;
  std::vector<std::size_t> shown;
  /// What `moving` lies in, voxels [low, high); empty where nothing changes.
  Eigen::AlignedBox3i box;
};

/// `start`: before the first edit; `edits`: of all bodies, of which those of `body` are made;
/// `ends`: of each moment, rising, how many of them have been made by then; `also`: voxels that the
/// box is to hold besides, null for none.
PageSolid page_solid(const VoxelModel& start, std::size_t tissues, std::span<const Edit> edits,
                     std::size_t body, std::span<const std::size_t> ends, const VoxelSet* also);

/// The closed surface of some voxels of a grid; as PageSurface.
PageSurface page_surface(const VoxelSet& voxels);

/// Makes edits of one body, where all that were before them have been made.
void apply_edits(std::span<const Edit> edits, std::size_t body, VoxelModel& model);

}  // namespace sulcus
