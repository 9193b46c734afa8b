#pragma once

#include <cstddef>
#include <optional>

#include "engine/cache/load_cache.hpp"
#include "engine/volume/input_geometry.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

// A voxel model in the load cache (CacheKind::kModel), little-endian:
//
//   cells u32[3], flags u32 (1 clipped, 2 labelled, 4 filled),
//   voxel_m f64, n u64, p u64, m u64, g u64, w u64
//   input        f64[g]       InputGeometry::numbers(), or g = 0
//   warnings     u8[w]        each ended by a line feed
//   leaves       u32[n]       those with a solid voxel, rising; bit 31 where all 512 are
//   mixed        u32[m]       places in `leaves` of those of several tissues, rising
//   leaf_labels  u8[n]        where labelled
//   words        u64[p][8]    voxels of the leaves that are not full
//   blocks       u8[m][512]   labels of the mixed ones
//   pages        u64 q, (leaf u32, levels u8[512])[q]   where filled: fill levels of the leaves
//                             with a voxel that is not full, rising

/// Empty where there is no such entry, or one that does not fit the grid, names a tissue from
/// `tissues` on or fills what is not solid. `notes`: null where nobody asks for them.
std::optional<VoxelModel> read_cached_model(LoadCache& cache, const Hash128& key,
                                            const VoxelGrid& grid, std::size_t tissues,
                                            ImportNotes* notes = nullptr);
void write_cached_model(LoadCache& cache, const Hash128& key, const VoxelModel& model,
                        const ImportNotes& notes = {});

}  // namespace sulcus
