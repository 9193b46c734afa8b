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
  std::uint32_t base = 0;        // index of the first own vertex in the mesh
  std::uint64_t first_quad = 0;  // the same of quads
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
  Eigen::Vector3i cell_of(std::uint64_t key) const {
    const std::uint64_t cell = key / 4;
    const auto nx = static_cast<std::uint64_t>(grid.cells.x()) + 1;
    const auto ny = static_cast<std::uint64_t>(grid.cells.y()) + 1;
    return {static_cast<int>(cell % nx) - 1, static_cast<int>(cell / nx % ny) - 1,
            static_cast<int>(cell / nx / ny) - 1};
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
    const LeafBits& bits = model.leaves[leaf];
    if (!any(bits)) return;
    const FillLevel* const page = model.fills ? model.fills->page(leaf) : nullptr;
    const Cell from = low.cwiseMax(origin) - origin;
    const Cell end = high.cwiseMin(origin + Cell::Constant(kLeafEdge)) - origin;
    for (int z = from.z(); z < end.z(); ++z) {
      for (int y = from.y(); y < end.y(); ++y) {
        const Cell p = origin + Cell(from.x(), y, z) - block.first;
        float* value = block.values.data() + p.x() +
                       block.dims.x() * (p.y() + std::ptrdiff_t{block.dims.y()} * p.z());
        for (int x = from.x(); x < end.x(); ++x, ++value) {
          const int place = leaf_place({x, y, z});
          if (!bits.has(place) || (tissue && model.tissue(origin + Cell(x, y, z)) != *tissue)) {
            continue;
          }
          *value = page ? static_cast<float>(page[place]) / kFullLevel : 1.0f;
          count += *value > kHalfFull ? 1 : 0;
        }
      }
    }
  });
  return count != 0 && count != block.values.size();
}

/// Whether a cell of the brick can be crossed at all: a quick look at whole leaves.
bool may_cross(const VoxelModel& model, std::optional<std::uint8_t> tissue, const Cell& begin,
               const Cell& end) {
  const Cell low = (begin - Cell::Constant(2)).cwiseMax(0);
  const Cell high = (end + Cell::Constant(2)).cwiseMin(model.grid.cells);
  // Tissue borders count as surface when one tissue is asked for, so full leaves may cross too.
  bool empty = tissue || low != begin - Cell::Constant(2) || high != end + Cell::Constant(2);
  bool solid = false;
  return any_cell(low / kLeafEdge, leaves_up_to(high), [&](const Cell& at) {
    const std::uint32_t leaf = model.grid.leaf_of(at * kLeafEdge);
    if (model.fills && model.fills->page(leaf)) return true;
    for (const std::uint64_t word : model.leaves[leaf].words) {
      empty = empty || word != ~std::uint64_t{0};
      solid = solid || word != 0;
    }
    return empty && solid;
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
  if (!may_cross(model, tissue, block.begin, block.end)) return;
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

/// Index in the mesh of a vertex that another brick owns.
std::uint32_t vertex_elsewhere(const Layout& layout, const std::vector<BrickSurface>& bricks,
                               std::uint64_t key) {
  const BrickSurface& owner = bricks[layout.brick_of(layout.cell_of(key))];
  const auto found = std::lower_bound(owner.keys.begin(), owner.keys.end(), key);
  return owner.base + static_cast<std::uint32_t>(found - owner.keys.begin());
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
    brick.first_quad = quads;
    vertices += brick.keys.size();
    quads += brick.quads.size();
    if (vertices >= kElsewhere) {
      throw std::length_error("the surface has more vertices than 32-bit indices can name");
    }
  }
  VoxelNet net;
  net.cells.resize(vertices);
  net.offsets.resize(vertices);
  net.at_surface.resize(model.fills ? vertices : 0);
  net.quads.resize(quads);
  tbb::parallel_for(0, count, [&](int index) {
    const BrickSurface& brick = bricks[index];
    std::ranges::copy(brick.cells, net.cells.begin() + brick.base);
    std::ranges::copy(brick.offsets, net.offsets.begin() + brick.base);
    std::ranges::copy(brick.at_surface,
                      net.at_surface.begin() + (model.fills ? brick.base : std::uint32_t{0}));
    auto quad = net.quads.begin() + static_cast<std::ptrdiff_t>(brick.first_quad);
    for (const auto& corners : brick.quads) {
      for (int i = 0; i < 4; ++i) {
        (*quad)[i] = corners[i].own != kElsewhere
                         ? brick.base + corners[i].own
                         : vertex_elsewhere(layout, bricks, corners[i].key);
      }
      ++quad;
    }
  });
  return net;
}

}  // namespace sulcus
