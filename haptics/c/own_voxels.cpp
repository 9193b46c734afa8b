#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "engine/core/error.hpp"
#include "haptics/c/scene_parts.hpp"

namespace sulcus {

namespace {

[[noreturn]] void refuse(const Scene& scene, const std::string& found, const std::string& wanted) {
  throw InputError(scene.file, "voxels", found, wanted);
}

/// One leaf's voxels and labels out of the array; whether a value is too large.
bool read_leaf(std::span<const std::uint8_t> voxels, const VoxelGrid& grid, std::uint32_t leaf,
               std::size_t tissues, LeafBits& bits, LabelBlock& labels) {
  const Cell first = grid.leaf_origin(leaf);
  bool is_known = true;
  for (int place = 0; place < 512; ++place) {
    const std::uint8_t value = voxels[grid.linear(first + cell_in_leaf(place))];
    if (value == 0) continue;
    bits.set(place);
    labels[static_cast<std::size_t>(place)] = static_cast<std::uint8_t>(value - 1);
    is_known &= value <= tissues;
  }
  return is_known;
}

}  // namespace

VoxelModel own_voxels(const Scene& scene, std::span<const std::uint8_t> voxels) {
  VoxelModel model;
  model.grid = {scene.workpiece.cells, scene.workpiece.voxel_m};
  const std::uint64_t cells = model.grid.cell_count();
  if (voxels.size() != cells) {
    refuse(scene, std::to_string(voxels.size()) + " voxels",
           std::to_string(cells) + ", as [workpiece] cells says");
  }
  if (scene.workpiece.surface == SurfaceKind::kFractions) {
    refuse(scene, "[workpiece] surface = \"fractions\"", "\"binary\", as voxels given are");
  }
  model.leaves.resize(model.grid.leaf_count());
  std::shared_ptr<TissueMap> tissues;
  if (scene.tissues.size() > 1) tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  bool is_empty = true;
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LeafBits& bits = model.leaves[leaf];
    LabelBlock labels{};
    if (!read_leaf(voxels, model.grid, leaf, scene.tissues.size(), bits, labels)) {
      refuse(scene, "a tissue beyond the last",
             "0 to " + std::to_string(scene.tissues.size()) + ", 0 for an empty one");
    }
    is_empty &= !any(bits);
    if (tissues && any(bits)) tissues->set_block(leaf, labels, bits);
  }
  if (is_empty) refuse(scene, "no solid voxel", "a solid");
  model.tissues = std::move(tissues);
  return model;
}

}  // namespace sulcus
