#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

#include "engine/normals/leaf_tiles.hpp"
#include "engine/normals/map_kernels.hpp"
#include "engine/normals/map_space.hpp"
#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// The maps of some voxels, each along the dominant axis of its own coarse normal, taken together
/// stage by stage: one after the other a voxel's stages wait for one another, side by side they do
/// not.
struct MapGroup {
  static constexpr std::size_t kEights = 2, kSize = kEights * SurfaceGroup::kSize;

  std::array<Eigen::Vector3f, kSize> coarse;  // of any length; zero: no side, and no map
  std::array<MapAxes, kSize> axes;
  std::array<SurfaceGroup, kEights> surfaces;  // of whole maps, by eights

  /// Coarse normals, of the tool where the solid has none, and the maps along them, of `queries`
  /// from `first` on, up to kSize, and the surfaces of those that are whole. `tiles` are of the
  /// same queries. Returns how many; what is in the group is valid until the next.
  std::size_t take(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                   std::size_t first, int neighbourhood, int trace, LeafTiles& tiles) noexcept;

  SurfaceGroup& eight(std::size_t k) { return surfaces[k / SurfaceGroup::kSize]; }
  static int place(std::size_t k) { return static_cast<int>(k % SurfaceGroup::kSize); }
  std::size_t eights() const { return (count_ + SurfaceGroup::kSize - 1) / SurfaceGroup::kSize; }
  /// Which have a side, and so a map: a bit for each.
  std::uint32_t sided() const { return static_cast<std::uint32_t>(sided_); }
  bool is_whole(std::size_t k) const { return is_whole_[k]; }
  /// Of the whole maps of an eight.
  const MapRows* rows(std::size_t eight) const {
    return rows_.data() + eight * SurfaceGroup::kSize;
  }
  /// The map itself, cut out of its tile where it is still there alone. Of a voxel that has one.
  const HeightMap& map(std::size_t k) noexcept;

 private:
  /// Traces the first `filled_` maps, and puts the sums of those that are whole.
  void fit_traced(const QuadricFilter& whole) noexcept;

  std::size_t count_ = 0;
  int trace_ = 0;
  std::uint64_t sided_ = 0;                       // that have a coarse normal, a bit for each
  std::array<const HeightTile*, kSize> tiles_{};  // that have the whole map
  std::array<HeightTile::Column, kSize> tile_columns_;
  std::array<Eigen::Vector3i, kSize> at_;  // where
  std::array<bool, kSize> is_whole_{};
  std::array<MapRows, kSize> rows_;
  std::array<ColumnBits::Windows, kSize> columns_;  // of the coarse normals, then of what is traced
  std::array<HeightMap, kSize> maps_;               // what is traced or cut, in that order
  std::array<std::size_t, kSize> slots_{};
  std::size_t filled_ = 0;
};

/// What the tool has to say: nothing on the far side of a wall, where the coarse normal points away
/// from it by more than 120 degrees. What is less happens at concave edges.
inline Eigen::Vector3f heard(const Eigen::Vector3f& outward, const Eigen::Vector3f& coarse) {
  const float along = coarse.dot(outward);
  const bool far_side =
      along < 0.0f && along * along > 0.25f * coarse.squaredNorm() * outward.squaredNorm();
  return far_side ? Eigen::Vector3f(Eigen::Vector3f::Zero()) : outward;
}
/// Where no surface stands: the coarse normal, or the tool's direction where that is vetoed too.
inline SurfaceEstimate last_resort(const Eigen::Vector3f& coarse, const Eigen::Vector3f& tool,
                                   std::uint8_t windows) {
  return {(coarse.dot(tool) < 0.0f ? tool : coarse).normalized(), 0.5f, true, windows};
}
/// Whether a normal points away from neither the coarse one nor what the tool has to say.
inline bool stands(const Eigen::Vector3f& normal, const Eigen::Vector3f& coarse,
                   const Eigen::Vector3f& tool) {
  return normal.dot(coarse) > 0.0f && !(normal.dot(tool) < 0.0f);
}

/// The columns around a voxel, as maps along an axis are traced from them.
inline ColumnBits::Windows columns_about(const Workpiece& workpiece, const Cell& voxel,
                                         const MapAxes& axes) noexcept {
  return workpiece.columns().around(axes.axis, voxel[axes.first()], voxel[axes.second()],
                                    voxel[axes.axis] - kLevel);
}

/// Traces the map of a voxel along an axis; `map.ns` and `map.stride` are set.
inline void trace_along(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                        int trace, HeightMap& map) noexcept {
  map.sign = axes.sign;
  map_kernels().trace(columns_about(workpiece, voxel, axes), trace, map);
}

}  // namespace sulcus
