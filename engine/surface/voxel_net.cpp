#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/surface/column_surface.hpp"
#include "engine/surface/surface_nets.hpp"

namespace sulcus {
namespace {

constexpr int kBrick = 64;  // voxels along a brick's edge
constexpr float kHalfFull = 0.5f;
constexpr std::uint32_t kElsewhere = std::numeric_limits<std::uint32_t>::max();

/// What one brick found: its own vertices, and quads that may also name vertices of the cells
/// just below it, which other bricks own.
struct BrickSurface {
  std::vector<std::uint64_t> keys;  // of own vertices, rising
  std::vector<Eigen::Vector3f> offsets;
  std::vector<Eigen::Vector3i> cells;
  std::vector<std::uint8_t> at_surface;  // as VoxelNet
  struct Corner {
    std::uint32_t own;  // index among own vertices, or kElsewhere
    std::uint64_t key;
  };
  std::vector<std::array<Corner, 4>> quads;
  std::uint32_t base = 0;  // index of the first own vertex in the mesh
};

struct Layout {
  VoxelGrid grid;
  Eigen::Vector3i bricks;

  explicit Layout(const VoxelGrid& g)
      : grid(g), bricks((g.cells + Eigen::Vector3i::Constant(kBrick - 1)) / kBrick) {}

  Eigen::Vector3i brick_at(int index) const {
    return {index % bricks.x(), index / bricks.x() % bricks.y(), index / bricks.x() / bricks.y()};
  }
  /// Cells -1 to n - 1 along each axis; the first brick takes the border.
  int brick_of(const Eigen::Vector3i& cell) const {
    const Eigen::Vector3i b = cell.cwiseMax(0) / kBrick;
    return b.x() + bricks.x() * (b.y() + bricks.y() * b.z());
  }
  std::uint64_t key(const Eigen::Vector3i& cell, int part) const {
    const auto nx = static_cast<std::uint64_t>(grid.cells.x()) + 1;
    const auto ny = static_cast<std::uint64_t>(grid.cells.y()) + 1;
    return (static_cast<std::uint64_t>(cell.x() + 1) +
            nx * (static_cast<std::uint64_t>(cell.y() + 1) +
                  ny * static_cast<std::uint64_t>(cell.z() + 1))) *
               4 +
           static_cast<std::uint64_t>(part);
  }
};

struct Scratch {
  NetsBlock block;
  NetsBlock solid;  // the same of all tissues
  NetsScratch nets;
  NetsMesh mesh;
  std::vector<std::uint8_t> at_surface;
};

/// The end of the leaves that hold the voxels before `high`.
Cell leaves_up_to(const Eigen::Vector3i& high) {
  return (high + Cell::Constant(kLeafEdge - 1)) / kLeafEdge;
}

/// Occupancy of the block, 0 or 1, or with fractions what of each voxel is filled. Says whether
/// voxels inside and outside occur.
bool fill_occupancy(const VoxelModel& model, std::optional<std::uint8_t> tissue, NetsBlock& block) {
  std::fill(block.values.begin(), block.values.end(), 0.0f);
  const Eigen::Vector3i low = block.first.cwiseMax(0);
  const Eigen::Vector3i high = (block.first + block.dims).cwiseMin(model.grid.cells);
  std::uint64_t count = 0;
  for_each_cell(low / kLeafEdge, leaves_up_to(high), [&](const Cell& at) {
    const Cell origin = at * kLeafEdge;
    const std::uint32_t leaf = model.grid.leaf_of(origin);
    const FillLevel* const page = model.fills ? model.fills->page(leaf) : nullptr;
    for_each_voxel(model.leaves[leaf], [&](int place) {
      const Cell c = origin + cell_in_leaf(place);
      if ((c.array() < low.array()).any() || (c.array() >= high.array()).any()) return;
      if (tissue && model.tissue(c) != *tissue) return;
      const Eigen::Vector3i p = c - block.first;
      const float filled = page ? static_cast<float>(page[place]) / kFullLevel : 1.0f;
      block.values[p.x() + static_cast<std::size_t>(block.dims.x()) *
                               (p.y() + static_cast<std::size_t>(block.dims.y()) * p.z())] = filled;
      count += filled > kHalfFull ? 1 : 0;
    });
  });
  return count != 0 && count != block.values.size();
}

/// Whether a cell of the brick can be crossed at all: a quick look at whole leaves.
bool may_cross(const VoxelModel& model, const Eigen::Vector3i& begin, const Eigen::Vector3i& end) {
  const Eigen::Vector3i low = (begin - Eigen::Vector3i::Constant(1)).cwiseMax(0);
  const Eigen::Vector3i high = (end + Eigen::Vector3i::Constant(1)).cwiseMin(model.grid.cells);
  // Tissue borders count as surface when one tissue is asked for, so full leaves may cross too.
  return any_cell(low / kLeafEdge, leaves_up_to(high), [&](const Cell& at) {
    return any(model.leaves[model.grid.leaf_of(at * kLeafEdge)]);
  });
}

void move_to_surface(const VoxelModel& model, std::optional<std::uint8_t> tissue,
                     Scratch& scratch) {
  if (tissue) {
    scratch.solid = scratch.block;
    fill_occupancy(model, {}, scratch.solid);
  }
  move_to_columns(model, 0, tissue ? scratch.solid : scratch.block, scratch.mesh,
                  &scratch.at_surface);
}

void mesh_brick(const VoxelModel& model, std::optional<std::uint8_t> tissue, const Layout& layout,
                int index, Scratch& scratch, BrickSurface& out) {
  const Eigen::Vector3i brick = layout.brick_at(index);
  NetsBlock& block = scratch.block;
  for (int a = 0; a < 3; ++a) {
    block.begin[a] = brick[a] == 0 ? -1 : brick[a] * kBrick;
    block.end[a] = std::min((brick[a] + 1) * kBrick, model.grid.cells[a]);
  }
  if (!may_cross(model, block.begin, block.end)) return;
  block.first = block.begin - Eigen::Vector3i::Constant(2);
  block.dims = block.end - block.begin + Eigen::Vector3i::Constant(4);
  block.values.resize(static_cast<std::size_t>(block.dims.x()) * block.dims.y() * block.dims.z());
  if (!fill_occupancy(model, tissue, block)) return;
  surface_nets(block, kHalfFull, scratch.nets, scratch.mesh);
  if (model.fills) move_to_surface(model, tissue, scratch);

  std::vector<std::uint32_t> own(scratch.mesh.vertices.size(), kElsewhere);
  for (std::size_t v = 0; v < own.size(); ++v) {
    const NetsVertex& vertex = scratch.mesh.vertices[v];
    if ((vertex.cell.array() < block.begin.array()).any()) continue;
    own[v] = static_cast<std::uint32_t>(out.keys.size());
    out.keys.push_back(layout.key(vertex.cell, vertex.part));
    out.cells.push_back(vertex.cell);
    out.offsets.push_back(vertex.offset);
    if (model.fills) out.at_surface.push_back(scratch.at_surface[v]);
  }
  out.quads.reserve(scratch.mesh.quads.size());
  for (const auto& quad : scratch.mesh.quads) {
    std::array<BrickSurface::Corner, 4> corners;
    for (int i = 0; i < 4; ++i) {
      const NetsVertex& vertex = scratch.mesh.vertices[quad[i]];
      corners[i] = {own[quad[i]], layout.key(vertex.cell, vertex.part)};
    }
    out.quads.push_back(corners);
  }
}

}  // namespace

VoxelNet voxel_net(const VoxelModel& model, std::optional<std::uint8_t> tissue) {
  const Layout layout(model.grid);
  const int count = layout.bricks.prod();
  std::vector<BrickSurface> bricks(count);
  tbb::enumerable_thread_specific<Scratch> scratch;
  tbb::parallel_for(0, count, [&](int index) {
    mesh_brick(model, tissue, layout, index, scratch.local(), bricks[index]);
  });

  std::uint64_t vertices = 0;
  std::uint64_t quads = 0;
  for (BrickSurface& brick : bricks) {
    brick.base = static_cast<std::uint32_t>(vertices);
    vertices += brick.keys.size();
    quads += brick.quads.size();
    if (vertices >= kElsewhere) {
      throw std::length_error("the surface has more vertices than 32-bit indices can name");
    }
  }
  VoxelNet net;
  net.cells.reserve(vertices);
  net.offsets.reserve(vertices);
  net.quads.reserve(quads);
  for (const BrickSurface& brick : bricks) {
    net.cells.insert(net.cells.end(), brick.cells.begin(), brick.cells.end());
    net.offsets.insert(net.offsets.end(), brick.offsets.begin(), brick.offsets.end());
    net.at_surface.insert(net.at_surface.end(), brick.at_surface.begin(), brick.at_surface.end());
    for (const auto& corners : brick.quads) {
      std::array<std::uint32_t, 4> quad{};
      for (int i = 0; i < 4; ++i) {
        if (corners[i].own != kElsewhere) {
          quad[i] = brick.base + corners[i].own;
          continue;
        }
        const std::uint64_t cell = corners[i].key / 4;
        const auto nx = static_cast<std::uint64_t>(model.grid.cells.x()) + 1;
        const auto ny = static_cast<std::uint64_t>(model.grid.cells.y()) + 1;
        const Eigen::Vector3i c(static_cast<int>(cell % nx) - 1,
                                static_cast<int>(cell / nx % ny) - 1,
                                static_cast<int>(cell / nx / ny) - 1);
        const BrickSurface& owner = bricks[layout.brick_of(c)];
        const auto found = std::lower_bound(owner.keys.begin(), owner.keys.end(), corners[i].key);
        quad[i] = owner.base + static_cast<std::uint32_t>(found - owner.keys.begin());
      }
      net.quads.push_back(quad);
    }
  }
  return net;
}

}  // namespace sulcus
