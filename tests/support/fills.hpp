#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "engine/volume/voxel_model.hpp"

namespace sulcus::test {

/// Share of a voxel that is filled.
inline double share(const VoxelModel& model, const Cell& c) {
  return model.level(c) / double{kFullLevel};
}

/// Voxels by what of them is filled.
inline double filled_voxels_of(const VoxelModel& model) {
  std::uint64_t levels = 0;
  for_each_cell(Cell::Zero(), model.grid.cells, [&](const Cell& c) { levels += model.level(c); });
  return static_cast<double>(levels) / kFullLevel;
}

inline double filled_m3(const VoxelModel& model) {
  return filled_voxels_of(model) * model.grid.voxel_volume_m3();
}

inline void expect_same_levels(const VoxelModel& a, const VoxelModel& b) {
  ASSERT_EQ(a.grid.cells, b.grid.cells);
  EXPECT_EQ(a.leaves, b.leaves);
  std::size_t wrong = 0;
  for_each_cell(Cell::Zero(), a.grid.cells,
                [&](const Cell& c) { wrong += a.level(c) != b.level(c) ? 1 : 0; });
  EXPECT_EQ(wrong, 0u);
}

}  // namespace sulcus::test
