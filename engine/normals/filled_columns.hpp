#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "engine/normals/map_space.hpp"
#include "engine/normals/window_filter.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Voxels of a column that may be part-filled, one after another.
inline constexpr int kMostPartFilled = 5;

/// Reads fill levels voxel by voxel, mostly of one leaf; 0 beyond the grid. Needs fractions; the
/// model must outlive it, and its leaves stay as they are.
class LevelReader {
 public:
  explicit LevelReader(const VoxelModel& model)
      : model_(model), dims_(model.grid.leaf_dims()), fills_(*model.fills) {}

  FillLevel at(int x, int y, int z) noexcept {
    const int lx = x >> 3, ly = y >> 3, lz = z >> 3;
    const int leaf = lx + dims_.x() * (ly + dims_.y() * lz);
    if (leaf != leaf_) enter(lx, ly, lz, leaf);
    const int place = (x & 7) | (y & 7) << 3 | (z & 7) << 6;
    if (page_) return page_[place];
    return bits_->has(place) ? kFullLevel : FillLevel{0};
  }

 private:
  void enter(int lx, int ly, int lz, int leaf) noexcept;
  // Entered anew each time; no leaf's number, nor what is reckoned for one beyond the grid.
  static constexpr int kOutside = std::numeric_limits<int>::min();

  const VoxelModel& model_;
  Eigen::Vector3i dims_;
  const FillMap& fills_;
  int leaf_ = kOutside;
  const FillLevel* page_ = nullptr;
  const LeafBits* bits_ = nullptr;
};

/// What a column lacks below the top of its outermost solid voxel `at`, in parts: the empty share
/// of the voxels from there inward to the first full one, `most` at most. Of a wall that no voxel
/// of is full its fullest counts for both sides. None where all are part-filled.
std::optional<int> column_lack(LevelReader& levels, Cell at, const MapAxes& axes,
                               int most) noexcept;

/// The height of a voxel's own column along one axis, voxels above its centre, outward; none where
/// the column has no surface within three voxels of it. Needs fractions.
std::optional<float> own_height(const VoxelModel& model, const Cell& voxel,
                                const MapAxes& axes) noexcept;

/// How far the surface of a part-filled voxel is from its centre at most, voxels, by its own
/// columns each way along the axes; none where they say nothing, and of a full voxel. What
/// estimate_ldm_filled finds of the voxel is no farther.
std::optional<float> farthest_surface(const VoxelModel& model, const Cell& voxel) noexcept;

}  // namespace sulcus
