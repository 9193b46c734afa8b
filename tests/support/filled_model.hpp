#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/voxel_model.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus::test {

/// A model with fractions: of each leaf that has a surface voxel those have any level, the same for
/// the same seed.
inline VoxelModel filled_anyhow(VoxelModel model, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<LeafLevels> pages;
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    const LeafBits surface = surface_of_leaf(model, leaf);
    if (!any(surface)) continue;
    LeafLevels& page = pages.emplace_back();
    page.leaf = leaf;
    for_each_voxel(model.leaves[leaf], [&](int place) {
      page.levels[static_cast<std::size_t>(place)] =
          surface.has(place) ? static_cast<FillLevel>(1 + random() % 255) : kFullLevel;
    });
  }
  model.fills.emplace(model.grid.leaf_count(), std::move(pages));
  return model;
}

inline void expect_equal_levels(const VoxelModel& a, const VoxelModel& b) {
  ASSERT_EQ(a.fills.has_value(), b.fills.has_value());
  for (std::uint32_t voxel = 0; voxel < a.grid.cell_count(); ++voxel) {
    const Cell c = a.grid.cell_of_linear(voxel);
    ASSERT_EQ(a.level(c), b.level(c)) << voxel;
  }
}

}  // namespace sulcus::test
