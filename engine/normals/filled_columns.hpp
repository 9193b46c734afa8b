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
    if ((((x ^ x_) | (y ^ y_) | (z ^ z_)) & -kLeafEdge) != 0) enter(x, y, z);
    const int place = (x & 7) | (y & 7) << 3 | (z & 7) << 6;
    if (page_) return page_[place];
    return bits_->has(place) ? kFullLevel : FillLevel{0};
  }

 private:
  void enter(int x, int y, int z) noexcept;

  const VoxelModel& model_;
  Eigen::Vector3i dims_;
  const FillMap& fills_;
  // The last voxel where a leaf was entered; of none at first.
  int x_ = std::numeric_limits<int>::min(), y_ = 0, z_ = 0;
  const FillLevel* page_ = nullptr;
  const LeafBits* bits_ = nullptr;
};

/// A voxel of a column, and the way inward along it. Numbers of their own: an index by axis would
/// put them into memory, and a step be waited for there.
struct ColumnVoxel {
  int x = 0, y = 0, z = 0;
  int inward_x = 0, inward_y = 0, inward_z = 0;

  ColumnVoxel(const Cell& voxel, const MapAxes& axes) noexcept
      : x(voxel.x()),
        y(voxel.y()),
        z(voxel.z()),
        inward_x(axes.axis == 0 ? -axes.sign : 0),
        inward_y(axes.axis == 1 ? -axes.sign : 0),
        inward_z(axes.axis == 2 ? -axes.sign : 0) {}

  FillLevel level(LevelReader& levels) const noexcept { return levels.at(x, y, z); }
  /// So many voxels inward.
  ColumnVoxel inward(int voxels) const noexcept {
    ColumnVoxel to = *this;
    to.x += voxels * inward_x, to.y += voxels * inward_y, to.z += voxels * inward_z;
    return to;
  }
};

/// What a column lacks below the top of its outermost solid voxel `at`, in parts: the empty share
/// of the voxels from there inward to the first full one, `most` at most. Of a wall, no voxel of
/// which is full, its fullest counts for both sides. None where all are part-filled.
struct ColumnLack {
  int parts = 0;
  bool is_wall = false;
};
std::optional<ColumnLack> column_lack(LevelReader& levels, ColumnVoxel at, int most) noexcept;

/// The height of a voxel's own column along one axis, voxels above its centre, outward; none where
/// the column has no surface within three voxels of it.
struct OwnHeight {
  float voxels = 0.0f;
  bool is_wall = false;  // as of ColumnLack
};
std::optional<OwnHeight> own_height(const Workpiece& workpiece, LevelReader& levels,
                                    const Cell& voxel, const MapAxes& axes) noexcept;

/// How far the surface of a part-filled voxel is from its centre at most, voxels, by its own
/// columns each way along the axes; none where they say nothing, and of a full voxel. What
/// estimate_ldm_filled finds of the voxel is no farther. Where a column says `enough` or more, that
/// column's answer.
std::optional<float> farthest_surface(
    const Workpiece& workpiece, LevelReader& levels, const Cell& voxel,
    float enough = std::numeric_limits<float>::infinity()) noexcept;

}  // namespace sulcus
