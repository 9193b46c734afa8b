#include "engine/surface/piece_mesh.hpp"

#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace sulcus {
namespace {

// Voxels around the piece that its grid takes in: as far as a vertex looks for what was cut.
constexpr int kBorder = 8;

/// A piece in a grid of its own, which is made of whole leaves of the solid's grid: all lattices
/// fall together, and tissues are copied leaf by leaf.
struct Piece {
  Cell first;  // of the solid's voxels
  VoxelModel model;
  LeafMap removed;  // what was solid around it
};

/// Of the leaves of a piece that have a voxel which is not full.
std::vector<LeafLevels> levels_of(const DrawnSurface& solid, const Piece& piece) {
  std::vector<LeafLevels> pages;
  for (std::uint32_t leaf = 0; leaf < piece.model.grid.leaf_count(); ++leaf) {
    LeafLevels page{.leaf = leaf};
    bool all_full = true;
    for_each_voxel(piece.model.leaves[leaf], [&](int place) {
      const Cell c = piece.model.grid.leaf_origin(leaf) + cell_in_leaf(place) + piece.first;
      const FillLevel level = solid.last_level(c);
      page.levels[static_cast<std::size_t>(place)] = level;
      all_full = all_full && level == kFullLevel;
    });
    if (!all_full) pages.push_back(page);
  }
  return pages;
}

Piece take_out(const DrawnSurface& solid, std::span<const std::uint32_t> voxels) {
  const VoxelGrid& grid = solid.model().grid;
  Cell low = grid.cells;
  Cell high = Cell::Zero();
  for (const std::uint32_t voxel : voxels) {
    if (voxel >= grid.cell_count()) throw std::invalid_argument("a piece lies beyond the grid");
    const Cell c = grid.cell_of_linear(voxel);
    low = low.cwiseMin(c);
    high = high.cwiseMax(c);
  }
  if ((low.array() > high.array()).any()) throw std::invalid_argument("a piece needs a voxel");
  Piece piece;
  piece.first = (low - Cell::Constant(kBorder)).cwiseMax(0) / kLeafEdge * kLeafEdge;
  const Cell end =
      (high + Cell::Constant(kBorder + kLeafEdge)).cwiseMin(grid.cells) / kLeafEdge * kLeafEdge;
  VoxelModel& model = piece.model;
  model.grid = {end - piece.first, grid.voxel_m};
  model.leaves.resize(model.grid.leaf_count());
  for (const std::uint32_t voxel : voxels) {
    model.set(grid.cell_of_linear(voxel) - piece.first, true);
  }
  if (solid.model().fills) model.fills.emplace(model.grid.leaf_count(), levels_of(solid, piece));

  const TissueMap* const labels = solid.model().tissues.get();
  const auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    const std::uint32_t from = grid.leaf_of(model.grid.leaf_origin(leaf) + piece.first);
    LeafBits around = solid.solid_at_start(from);
    std::uint64_t any = 0;
    for (int k = 0; k < kLeafEdge; ++k) any |= around.words[k] &= ~model.leaves[leaf].words[k];
    if (any != 0) piece.removed.emplace(leaf, around);
    if (labels == nullptr) continue;
    if (const LabelBlock* const block = labels->block(from)) {
      tissues->set_block(leaf, *block, {{kAll, kAll, kAll, kAll, kAll, kAll, kAll, kAll}});
    } else {
      tissues->set_uniform(leaf, labels->uniform_label(from));
    }
  }
  if (labels != nullptr) model.tissues = tissues;
  return piece;
}

DrawnMesh whole_mesh(const DrawnSurface& surface) {
  std::vector<DrawnMesh> bricks(surface.brick_count());
  tbb::enumerable_thread_specific<DrawnSurface::Scratch> scratch;
  tbb::parallel_for(0, surface.brick_count(),
                    [&](int b) { surface.mesh(b, scratch.local(), bricks[b]); });
  DrawnMesh whole;
  for (const DrawnMesh& brick : bricks) {
    const auto before = static_cast<std::uint32_t>(whole.vertices.size());
    whole.vertices.insert(whole.vertices.end(), brick.vertices.begin(), brick.vertices.end());
    for (const std::uint32_t index : brick.indices) whole.indices.push_back(before + index);
  }
  return whole;
}

}  // namespace

DrawnMesh piece_mesh(const DrawnSurface& solid, std::span<const std::uint32_t> voxels) {
  const Piece piece = take_out(solid, voxels);
  DrawnMesh mesh;
  for (int cell = solid.cell_voxels(); cell > 0 && mesh.indices.empty(); cell /= 2) {
    mesh = whole_mesh(DrawnSurface(piece.model, solid.looks(), cell, piece.removed));
  }
  const Eigen::Vector3d shift_m =
      solid.model().grid.centre_world(piece.first) - piece.model.grid.centre_world(Cell::Zero());
  for (DrawnVertex& vertex : mesh.vertices) {
    for (int a = 0; a < 3; ++a) {
      vertex.position_m[a] = static_cast<float>(vertex.position_m[a] + shift_m[a]);
    }
  }
  return mesh;
}

}  // namespace sulcus
