#pragma once

#include <algorithm>
#include <array>
#include <span>

#include <Eigen/Core>

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

  /// Coarse normals, of the tool where the solid has none, and the maps along them; up to kSize
  /// queries.
  void trace(const Workpiece& workpiece, std::span<const VoxelQuery> queries, int neighbourhood,
             int trace) noexcept;

  /// Fits the innermost `rings_of(map)` rings of each map that has them, and takes the surfaces.
  template <class RingsOf>
  void fit(const RingsOf& rings_of) noexcept {
    for (std::size_t k = 0; k < kSize; ++k) {
      Quadric fitted{};
      const int rings = k < count_ ? rings_of(maps[k]) : 0;
      const QuadricFilter& filter = quadric_filter(std::max(rings, 1), lanes_of(maps[0].ns));
      if (rings >= 1) map_kernels().fit(maps[k], filter, fitted);
      surfaces.put(static_cast<int>(k), fitted, filter.answers);
    }
    map_kernels().surfaces(surfaces, maps[0].stride);
  }

 private:
  std::size_t count_ = 0;
};

/// What the tool has to say: nothing on the far side of a wall, which the coarse normal tells.
inline Eigen::Vector3f heard(const Eigen::Vector3f& outward, const Eigen::Vector3f& coarse) {
  return coarse.dot(outward) < 0.0f ? Eigen::Vector3f(Eigen::Vector3f::Zero()) : outward;
}
/// Whether a normal points away from neither the coarse one nor what the tool has to say.
inline bool stands(const Eigen::Vector3f& normal, const Eigen::Vector3f& coarse,
                   const Eigen::Vector3f& tool) {
  return normal.dot(coarse) > 0.0f && !(normal.dot(tool) < 0.0f);
}

/// Traces the map of a voxel along an axis; `map.ns` and `map.stride` are set.
inline void trace_along(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                        int trace, HeightMap& map) noexcept {
  const int a = axes.axis;
  map.sign = axes.sign;
  map_kernels().trace(
      workpiece.columns().around(a, voxel[(a + 1) % 3], voxel[(a + 2) % 3], voxel[a] - kLevel),
      trace, map);
}

}  // namespace sulcus
