#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/shapes.hpp"

namespace sulcus::test {

/// Blobs whose surface is part-filled at random: nothing explains it.
inline Workpiece rough_blobs() {
  VoxelModel model = random_blobs({48, 40, 48}, 5);
  model.fills.emplace(model.grid.leaf_count(), std::vector<LeafLevels>{});
  model.fills->reserve(model.grid.leaf_count());
  std::mt19937 random(2);
  const Workpiece whole{VoxelModel(model)};
  for (const Cell& c : surface_cells(whole)) {
    model.set_level(c, static_cast<FillLevel>(1 + random() % 255));
  }
  return Workpiece(std::move(model));
}

}  // namespace sulcus::test
