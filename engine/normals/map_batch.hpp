#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "engine/normals/leaf_tiles.hpp"
#include "engine/normals/map_kernels.hpp"
#include "engine/normals/map_space.hpp"
#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Voxels of a batch, a bit for each.
using VoxelBits = std::uint64_t;
constexpr VoxelBits bit_of(std::size_t k) { return VoxelBits{1} << k; }
constexpr bool has_bit(VoxelBits bits, std::size_t k) { return (bits >> k & 1) != 0; }
template <class Each>
void for_each(VoxelBits bits, const Each& each) {
  for (; bits != 0; bits &= bits - 1) each(static_cast<std::size_t>(std::countr_zero(bits)));
}

/// When a voxel's query takes the tool into account: always, or only where the solid has no side.
enum class UseOfTool : std::uint8_t { kAlways, kWhereAlone };

/// Voxels whose maps are traced, each along the dominant axis of its own coarse normal, and fitted
/// together stage by stage: one after the other a voxel's stages wait for one another, side by side
/// they do not.
class MapBatch {
 public:
  static constexpr std::size_t kSize = 64;  // voxels
  static constexpr std::size_t kMaps = 16;  // that are traced, or cut out of their tiles

  /// Of voxels of one neighbourhood and trace; all that is referred to must outlive it.
  MapBatch(const Workpiece& workpiece, std::span<const VoxelQuery> queries, int neighbourhood,
           int trace, FitWindow window)
      : workpiece_(workpiece),
        neighbourhood_(neighbourhood),
        trace_(trace),
        queries_(queries),
        window_(window),
        tiles_(workpiece, queries, neighbourhood, window) {}

  /// Advances to the queries from `first` on, up to `most` of them: their coarse normals, of the
  /// tool where the solid has none, the axes of their maps, and fits of the maps that are in tiles.
  /// Returns how many; what is in the batch is valid until the next.
  std::size_t take(std::size_t first, std::size_t most) noexcept;
  /// Takes some of the voxels that the batch was taken with again, alone in it and in their order,
  /// along another of several axes that dominate their coarse normals.
  void retake(VoxelBits which, EqualAxes equal, UseOfTool use) noexcept;
  /// Traces the maps of the first kMaps of `rest`, and takes them off it. Returns their voxels; the
  /// maps are there until the next.
  std::span<const std::size_t> trace_some(VoxelBits& rest) noexcept;
  /// Fits the window of a map that was traced, where it has one.
  void fit_traced(std::size_t k) noexcept;
  /// Surfaces of all fits, the quadrics too with kAll. Returns those whose normals are consistent
  /// (is_consistent).
  VoxelBits find_surfaces(SurfaceParts parts) noexcept {
    return map_kernels().surfaces(groups.data(), group_count(), parts);
  }

  const Workpiece& workpiece() const { return workpiece_; }
  int neighbourhood() const { return neighbourhood_; }
  int trace() const { return trace_; }
  std::size_t count() const { return count_; }
  std::size_t group_count() const { return (count_ + kLanes - 1) / kLanes; }
  const SurfaceGroup& group(std::size_t k) const { return groups[k / kLanes]; }
  static int lane(std::size_t k) { return static_cast<int>(k % kLanes); }
  const VoxelQuery& query(std::size_t k) const { return queries_[first_ + of_taken_[k]]; }
  MapAxes axes(std::size_t k) const {
    return {group(k).axis[lane(k)], group(k).sign[lane(k)] > 0.0f ? 1 : -1};
  }
  /// Of any length; zero: no direction, and no map.
  Eigen::Vector3f coarse(std::size_t k) const {
    const SurfaceGroup& g = group(k);
    return {g.coarse[0][lane(k)], g.coarse[1][lane(k)], g.coarse[2][lane(k)]};
  }
  /// What the tool says, as far as it is used.
  Eigen::Vector3f tool(std::size_t k) const {
    const SurfaceGroup& g = group(k);
    return {g.tool[0][lane(k)], g.tool[1][lane(k)], g.tool[2][lane(k)]};
  }
  /// All rows of a map that is whole, and the map itself, which is cut out of its tile where it is
  /// there alone. `map` of no more than kMaps voxels.
  MapRows rows(std::size_t k) const noexcept;
  const HeightMap& map(std::size_t k) noexcept;

  VoxelBits has_direction = 0;               // a coarse normal, and so a map
  VoxelBits two_equal = 0, three_equal = 0;  // axes that dominate it (VoxelAxes)
  VoxelBits whole = 0, partly = 0;           // fitted: the whole map, or some rings of it
  VoxelBits in_tile = 0;                     // whose maps are in their tiles alone
  std::array<SurfaceGroup, 8> groups;

 private:
  static constexpr std::size_t kLanes = SurfaceGroup::kSize;
  static_assert(8 * kLanes == kSize);

  SurfaceGroup& group_of(std::size_t k) { return groups[k / kLanes]; }
  /// Its column in its tile.
  unsigned column(std::size_t k) const { return static_cast<unsigned>(group(k).column[lane(k)]); }
  void choose_axes(EqualAxes equal) noexcept;
  /// Where the coarse normal of a voxel has equal components, makes the one larger that more of the
  /// solid lies along, if there is one.
  void tell_apart(std::size_t k) noexcept;
  enum class Tiles : std::uint8_t { kAny, kMade };
  void fit_in_tiles(Tiles tiles) noexcept;

  const Workpiece& workpiece_;
  int neighbourhood_, trace_;
  std::span<const VoxelQuery> queries_;
  FitWindow window_;
  LeafTiles tiles_;
  std::size_t first_ = 0, count_ = 0;        // of the queries
  std::array<std::size_t, kSize> of_taken_;  // the place of each among those that were taken
  std::array<std::array<std::int32_t, 3>, kSize> sums_;  // about those, of solid voxels
  std::array<const HeightTile*, kSize> tile_of_{};
  std::array<HeightTile::Column, kSize> columns_;   // of the tiles
  std::array<ColumnBits::Windows, kSize> windows_;  // of coarse normals, then of what is traced
  std::array<HeightMap, kMaps> maps_;
  std::size_t map_count_ = 0;
  std::array<std::size_t, kMaps> traced_;  // their voxels
  std::array<std::size_t, kSize> slots_;   // where the maps of voxels are
};

/// The tool's direction as far as it is a hint: zero on the far side of a wall, where the coarse
/// normal points away from it by more than 120 degrees. What is less happens at concave edges.
inline Eigen::Vector3f tool_hint(const Eigen::Vector3f& outward, const Eigen::Vector3f& coarse) {
  const float along = coarse.dot(outward);
  const bool far_side =
      along < 0.0f && along * along > 0.25f * coarse.squaredNorm() * outward.squaredNorm();
  return far_side ? Eigen::Vector3f(Eigen::Vector3f::Zero()) : outward;
}
/// Where no surface is consistent: the coarse normal, or the tool hint where that vetoes it.
inline SurfaceEstimate last_resort(const Eigen::Vector3f& coarse, const Eigen::Vector3f& hint,
                                   std::uint8_t windows) {
  return {(coarse.dot(hint) < 0.0f ? hint : coarse).normalized(), 0.5f, true, windows};
}
/// Whether a normal points away from neither the coarse one nor the tool hint.
inline bool is_consistent(const Eigen::Vector3f& normal, const Eigen::Vector3f& coarse,
                          const Eigen::Vector3f& hint) {
  return normal.dot(coarse) > 0.0f && !(normal.dot(hint) < 0.0f);
}

/// The columns around a voxel, as maps along an axis are traced from them.
inline ColumnBits::Windows columns_about(const Workpiece& workpiece, const Cell& voxel,
                                         const MapAxes& axes) noexcept {
  return workpiece.columns().around(axes.axis, voxel[axes.first()], voxel[axes.second()],
                                    voxel[axes.axis] - kLevel);
}

/// Traces the map of a voxel with this coarse normal along an axis; `map.ns` and `map.stride` are
/// set.
inline void trace_along(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                        const Eigen::Vector3f& coarse, int trace, HeightMap& map) noexcept {
  map.sign = axes.sign;
  map.order = trace_order(coarse, axes);
  const ColumnBits::Windows columns = columns_about(workpiece, voxel, axes);
  map_kernels().trace(&columns, 1, trace, &map);
}

}  // namespace sulcus
