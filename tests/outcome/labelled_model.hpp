#pragma once

#include <memory>

#include "engine/scene/scene.hpp"
#include "engine/volume/edit.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::test {

/// Gives the solid voxels of a model their tissues: `label(c)`.
template <class Label>
VoxelModel labelled(VoxelModel model, const Label& label) {
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    const Cell first = model.grid.leaf_origin(leaf);
    LabelBlock labels{};
    for (int v = 0; v < 512; ++v) labels[v] = label(first + Cell(v % 8, v / 8 % 8, v / 64));
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = std::move(tissues);
  return model;
}

/// Tissues of these names.
inline std::vector<TissueSettings> tissues_named(std::initializer_list<const char*> names) {
  std::vector<TissueSettings> tissues;
  for (const char* name : names) tissues.emplace_back().name = name;
  return tissues;
}

/// An edit of a voxel.
inline Edit edit_of(const VoxelModel& model, const Cell& c, std::uint64_t tick = 0,
                    EditCause cause = EditCause::kCut) {
  return {tick, model.grid.linear(c), 0, cause};
}

}  // namespace sulcus::test
