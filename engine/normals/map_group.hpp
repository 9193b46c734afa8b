#pragma once

#include <algorithm>
#include <array>
#include <span>

#include <Eigen/Core>

#include "engine/normals/leaf_tiles.hpp"
#include "engine/normals/map_kernels.hpp"
#include "engine/normals/map_space.hpp"
#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// The maps of eight voxels, each along the dominant axis of its own coarse normal, taken together
/// stage by stage: one after the other a voxel's stages wait for one another, side by side they do
/// not.
struct MapGroup {
  static constexpr std::size_t kSize = SurfaceGroup::kSize;

  std::array<Eigen::Vector3f, kSize> coarse;  // of any length; zero: no side, and no map
  std::array<MapAxes, kSize> axes;
  std::array<HeightMap, kSize> maps;
  SurfaceGroup surfaces;

  /// Coarse normals, of the tool where the solid has none, and the maps along them, of `queries`
  /// from `first` on, up to kSize. `tiles` are of the same queries. Returns how many.
  std::size_t trace(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                    std::size_t first, int neighbourhood, int trace, LeafTiles& tiles) noexcept;

  /// Fits the innermost `rings_of(map)` rings of each map that has them, and takes the surfaces.
  template <class RingsOf>
  void fit(const RingsOf& rings_of) noexcept {
    for (std::size_t k = 0; k < count_; ++k) {
      const HeightMap& map = maps[k];
      const int rings = rings_of(map);
      if (rings < 1 || (rings == map.ns && summed_[k])) continue;
      const QuadricFilter& filter = quadric_filter(rings, map.lanes);
      QuadricSums sums;
      map_kernels().fit(map.middle_row(), map.lanes, filter, sums);
      surfaces.put(static_cast<int>(k), sums, map.at(0, 0), map.at(0, 0), map.sign, filter);
    }
    map_kernels().surfaces(surfaces, maps[0].stride);
  }

 private:
  std::size_t count_ = 0;
  std::array<bool, kSize> summed_{};  // whole: the sums are there, from a tile
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

/// The coarse normal of a query's voxel, of the tool where the solid has none.
Eigen::Vector3f coarse_of(const Workpiece& workpiece, const VoxelQuery& query) noexcept;

/// Puts the sums of a whole map that a tile can tell, of the voxel `at`, as one of a group;
/// `filter` is that of all its rings.
inline void put_tile_sums(const HeightTile& tile, const Eigen::Vector3i& at,
                          const QuadricFilter& filter, SurfaceGroup& group, int place) noexcept {
  const int u = at.x(), v = at.y(), height = tile.at(u, v);
  QuadricSums sums;
  for (std::size_t f = 0; f < kQuadric; ++f) sums[f] = tile.sums[v][f][u];
  group.put(place, sums, height, height - at.z(), tile.sign, filter);
}

/// The map of a voxel along an axis, cut out of a tile where there is one and it can tell; `map.ns`
/// is set, and the stride 1. Whether it was cut.
bool trace_or_cut(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes, int trace,
                  const HeightTile* tile, HeightMap& map) noexcept;

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
