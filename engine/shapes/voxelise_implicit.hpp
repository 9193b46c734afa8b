#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "engine/shapes/cell_coverage.hpp"
#include "engine/shapes/implicit_shape.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

namespace voxelise_detail {

/// Throws InputError unless every axis has a multiple of 8 cells, 8 to 1024, of positive size.
inline void check_grid(const VoxelGrid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    const int n = grid.cells[axis];
    if (n < kLeafEdge || n > kMaxCellsPerAxis || n % kLeafEdge != 0) {
      throw InputError("", "workpiece.cells", std::to_string(n), "a multiple of 8 from 8 to 1024");
    }
  }
  if (!(grid.voxel_m > 0.0)) {
    throw InputError("", "workpiece.voxel_mm", std::to_string(grid.voxel_m / 1e-3),
                     "a positive size");
  }
}

// A shape changes its sign, or its part, only on surfaces, so whole blocks are decided by one
// evaluation at their centre: where |value| exceeds what the Lipschitz bound lets it change over
// the half diagonal, every voxel has the sign of the centre. Blocks that this leaves open are
// halved on each axis, down to single voxels:
//
//   chunk 64^3 (unit of parallel work) -> 32^3 -> 16^3 -> leaf 8^3 -> 4^3 -> 2^3 -> voxel
//
// A leaf belongs to one chunk, and a chunk to one task, so nothing is written twice and the result
// does not depend on the threads.
template <ImplicitShape S>
class Descent {
 public:
  Descent(const S& shape, const Pose& world_from_shape,
          const std::array<std::uint8_t, 4>* label_of_part, SurfaceKind surface, VoxelModel& model,
          TissueMap* tissues)
      : shape_(shape),
        fractions_(surface == SurfaceKind::kFractions),
        shape_from_world_(world_from_shape.orientation.conjugate().toRotationMatrix()),
        position_(world_from_shape.position),
        label_of_part_(label_of_part),
        model_(model),
        tissues_(tissues),
        // The centres are rounded; a margin of some ulps keeps the bound a bound.
        lipschitz_(shape.lipschitz() * (1.0 + 1e-9)) {}

  /// Fills the block of `edge`^3 voxels from `first`, 16 or more, cut to the grid. Returns the
  /// levels of its leaves with voxels that are not full; with fractions only.
  std::vector<LeafLevels> fill_blocks(const Cell& first, int edge) const {
    Known known;
    known.label = tissues_ == nullptr;  // nothing to find out
    std::vector<LeafLevels> pages;
    fill_blocks(first, edge, known, pages);
    return pages;
  }

 private:
  /// What an enclosing block has settled.
  struct Known {
    bool solid = false;
    PartSet parts = PartSet::all();
    bool label = false;  // all of them have one
    std::uint8_t value = 0;
  };
  struct Leaf {
    LeafBits bits;
    LabelBlock labels{};
    LevelBlock levels{};
  };

  Eigen::Vector3d to_shape(const Eigen::Vector3d& p_index) const {
    return shape_from_world_ * (model_.grid.world_from_index(p_index) - position_);
  }
  std::uint8_t label_of(Part part) const {
    return (*label_of_part_)[static_cast<std::size_t>(part)];
  }
  std::uint8_t label_at(const Eigen::Vector3d& p, const Known& known) const {
    return known.label ? known.value : label_of(shape_.parts_within(p, 0.0, known.parts).first());
  }
  /// Leaves the parts that are within `reach` of p.
  void narrow(const Eigen::Vector3d& p, double reach, Known& known) const {
    known.parts = shape_.parts_within(p, reach, known.parts);
    known.value = label_of(known.parts.first());
    known.label = true;
    for (int n = 0; n < kPartCount; ++n) {
      const auto part = static_cast<Part>(n);
      if (known.parts.has(part) && label_of(part) != known.value) known.label = false;
    }
  }

  /// Settles what one evaluation at the block's centre can. False: every voxel is empty.
  bool settle(const Cell& first, int edge, Known& known) const {
    const double half = 0.5 * (edge - 1);
    const Eigen::Vector3d p = to_shape(first.cast<double>() + Eigen::Vector3d::Constant(half));
    // Up to the centres of its voxels, or with fractions up to their corners.
    const double reach = (fractions_ ? half + 0.5 : half) * std::sqrt(3.0) * model_.grid.voxel_m;
    bool centre_inside = known.solid;
    if (!known.solid) {
      const double value = shape_.value(p);
      if (value > lipschitz_ * reach) return false;
      known.solid = value < -lipschitz_ * reach;
      centre_inside = value <= 0.0;
    }
    if (!known.label && centre_inside) narrow(p, reach * (1.0 + 1e-9), known);
    return true;
  }

  void fill_blocks(const Cell& first, int edge, Known known, std::vector<LeafLevels>& pages) const {
    if ((first.array() >= model_.grid.cells.array()).any()) return;
    if (!(known.solid && known.label) && !settle(first, edge, known)) return;
    if (edge == kLeafEdge) return fill_leaf(first, known, pages);
    const int half = edge / 2;
    for (int child = 0; child < 8; ++child) {
      fill_blocks(child_of(first, half, child), half, known, pages);
    }
  }

  void fill_leaf(const Cell& first, const Known& known, std::vector<LeafLevels>& pages) const {
    const std::uint32_t index = model_.grid.leaf_of(first);
    if (known.solid && known.label) {
      model_.leaves[index].words.fill(~std::uint64_t{0});
      if (tissues_) tissues_->set_uniform(index, known.value);
      return;
    }
    Leaf leaf;
    for (int child = 0; child < 8; ++child) {
      fill_in_leaf(child_of(first, kLeafEdge / 2, child), kLeafEdge / 2, known, leaf);
    }
    model_.leaves[index] = leaf.bits;
    if (tissues_) tissues_->set_block(index, leaf.labels, leaf.bits);
    if (fractions_ &&
        std::ranges::any_of(leaf.levels, [](FillLevel level) { return level % kFullLevel != 0; })) {
      pages.push_back({index, leaf.levels});
    }
  }

  void fill_in_leaf(const Cell& first, int edge, Known known, Leaf& leaf) const {
    if (edge == 1) return fill_voxel(first, known, leaf);
    if (!(known.solid && known.label) && !settle(first, edge, known)) return;
    const int half = edge / 2;
    for (int child = 0; child < 8; ++child) {
      fill_in_leaf(child_of(first, half, child), half, known, leaf);
    }
  }

  void fill_voxel(const Cell& c, const Known& known, Leaf& leaf) const {
    const bool needs_point = !(known.solid && known.label);
    Eigen::Vector3d p =
        needs_point ? to_shape(c.cast<double>()) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    const FillLevel level = known.solid ? kFullLevel : level_at(p);
    if (level == 0) return;
    leaf.bits.set(leaf_place(c));
    leaf.levels[leaf_place(c)] = level;
    if (!known.label && !known.solid && shape_.value(p) > 0.0) {
      p -= shape_.gradient(p) * (shape_.value(p) / shape_.gradient(p).squaredNorm());
    }
    leaf.labels[leaf_place(c)] = label_at(p, known);
  }
  /// Of the voxel about a point.
  FillLevel level_at(const Eigen::Vector3d& p) const {
    if (!fractions_) return shape_.value(p) <= 0.0 ? kFullLevel : FillLevel{0};
    const double share = solid_share(shape_, p, shape_from_world_, model_.grid.voxel_m);
    return static_cast<FillLevel>(std::lround(kFullLevel * share));
  }

  static Cell child_of(const Cell& first, int half, int child) {
    return first + half * Cell(child & 1, child >> 1 & 1, child >> 2);
  }

  const S& shape_;
  bool fractions_;
  Eigen::Matrix3d shape_from_world_;
  Eigen::Vector3d position_;
  const std::array<std::uint8_t, 4>* label_of_part_;
  VoxelModel& model_;
  TissueMap* tissues_;
  double lipschitz_;
};

/// True where the shape's bounds pass a face of the grid that has solid voxels on it.
inline bool reaches_beyond(const VoxelModel& model, const Eigen::AlignedBox3d& bounds_world) {
  const VoxelGrid& grid = model.grid;
  const Eigen::Vector3d half = 0.5 * grid.voxel_m * grid.cells.cast<double>();
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const bool passes = side == 0 ? bounds_world.min()[axis] < -half[axis]
                                    : bounds_world.max()[axis] > half[axis];
      if (!passes) continue;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      Cell c;
      c[axis] = side == 0 ? 0 : grid.cells[axis] - 1;
      for (c[u] = 0; c[u] < grid.cells[u]; ++c[u]) {
        for (c[v] = 0; c[v] < grid.cells[v]; ++c[v]) {
          if (model.solid(c)) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace voxelise_detail

/// Voxels of an implicit shape that lies in the grid at `world_from_shape`: a voxel is solid where
/// the value at its centre is zero or less; with fractions it is filled as solid_share says, and of
/// the tissue at its centre, or where that is outside, at the surface beneath. `label_of_part` maps
/// the shape's parts to tissue labels; null: no tissue map. `clipped` is set where the bounds of
/// the shape pass a face of the grid with solid voxels on it. An empty intersection gives an empty
/// model. Throws InputError on a grid that is not multiples of 8 up to 1024. Runs on oneTBB; the
/// result does not depend on the number of threads. Callable from any thread.
template <ImplicitShape S>
VoxelModel voxelise_implicit(const S& shape, const VoxelGrid& grid,
                             const std::array<std::uint8_t, 4>* label_of_part,
                             const Pose& world_from_shape = {},
                             SurfaceKind surface = SurfaceKind::kBinary) {
  voxelise_detail::check_grid(grid);
  VoxelModel model;
  model.grid = grid;
  model.leaves.resize(grid.leaf_count());
  std::shared_ptr<TissueMap> tissues;
  if (label_of_part) tissues = std::make_shared<TissueMap>(grid.leaf_count());

  constexpr std::array<std::uint8_t, 4> kNoLabels{};
  const voxelise_detail::Descent<S> descent(shape, world_from_shape,
                                            label_of_part ? label_of_part : &kNoLabels, surface,
                                            model, tissues.get());
  constexpr int kChunk = 64;
  const Eigen::Vector3i chunks = (grid.cells.array() + (kChunk - 1)) / kChunk;
  std::vector<std::vector<LeafLevels>> pages(static_cast<std::size_t>(chunks.prod()));
  parallel_for(0, chunks.prod(), [&](int n) {
    const Cell chunk(n % chunks.x(), n / chunks.x() % chunks.y(), n / (chunks.x() * chunks.y()));
    pages[static_cast<std::size_t>(n)] = descent.fill_blocks(chunk * kChunk, kChunk);
  });
  if (surface == SurfaceKind::kFractions) model.fills.emplace(grid.leaf_count(), joined(pages));

  Eigen::AlignedBox3d bounds_world;
  const Eigen::AlignedBox3d bounds = shape.bounds();
  for (int corner = 0; corner < 8; ++corner) {
    bounds_world.extend(world_from_shape.point(
        bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
  }
  model.clipped = voxelise_detail::reaches_beyond(model, bounds_world);
  model.tissues = std::move(tissues);
  return model;
}

}  // namespace sulcus
