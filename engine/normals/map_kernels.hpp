#pragma once

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/normals/quadric_filter.hpp"

namespace sulcus {

/// Columns farther out than this from the column before are not followed, voxels.
inline constexpr int kMaxStep = 2;
/// |z(p) + z(-p) - 2 z(0)| of an even map, voxels: a test blind to tilt.
inline constexpr int kMaxUneven = 3;
/// Where a voxel stands in the windows of its columns: bit kLevel of column (0, 0) is its own.
inline constexpr int kLevel = 16;

/// A frame aslant over a map, axes in map space (i, j, outward), and a ball about the voxel.
struct TiltedFrame {
  std::array<float, 3> u{}, w{}, n{};
  float radius = 0.0f;
};

/// The points of a map in a ball, eight to a group, coordinates in the tilted frame in units of the
/// radius; weights 1 - r^2 / (1.05 R^2), zero for what is not in the ball.
struct TiltedPoints {
  static constexpr int kMaxGroups = HeightMap::kMaxRows * HeightMap::kMaxLanes / 8;
  struct alignas(32) Group {
    float weight[8], u[8], w[8], n[8];
  };
  int groups = 0;
  int count = 0;
  std::array<Group, kMaxGroups> group;
};

/// Sums over points: m[a][b] of weight u^a w^b, z[a][b] of weight u^a w^b n.
struct TiltedMoments {
  float m[5][5], z[3][3];
};

/// Residuals of a surface over points, in units of the radius.
struct TiltedResiduals {
  float largest = 0.0f, sum_squares = 0.0f;
};

/// The inner loops over a local distance map, in one instruction set. All give the same bits: sums
/// of heights are whole numbers, sums in single precision run in 8 lanes that are added up in one
/// order. Pure, no allocation.
struct MapKernels {
  const char* name;

  /// Traces a map from the columns around a voxel (ColumnBits::around, the voxel at kLevel). The
  /// middle row is traced outward from the voxel's own column, the others outward from it row by
  /// row: a column starts at its inner neighbour's height and takes the surface nearest to it, the
  /// outer one of two, at most kMaxStep away, so that the map follows the surface down slopes and
  /// does not jump to the far side of a thin wall.
  void (*trace)(const ColumnBits::Windows& columns, int trace, HeightMap& map) noexcept;

  /// Coefficients of the filter's quadric, in columns, z outward and half a voxel beyond the centre
  /// of the outermost solid voxel. `filter.lanes` is the map's.
  void (*fit)(const HeightMap& map, const QuadricFilter& filter, Quadric& quadric) noexcept;

  /// Largest |height - surface| over a whole map, voxels, the surface without its quartic part.
  float (*largest_residual)(const HeightMap& map, const ColumnQuadric& surface) noexcept;

  void (*gather)(const HeightMap& map, const TiltedFrame& frame, TiltedPoints& points) noexcept;
  void (*moments)(const TiltedPoints& points, TiltedMoments& moments) noexcept;
  void (*residuals)(const TiltedPoints& points, const Quadric& quadric,
                    TiltedResiduals& residuals) noexcept;
};

const MapKernels& plain_map_kernels() noexcept;
/// Null where the processor or the build has none.
const MapKernels* avx2_map_kernels() noexcept;
/// The fastest that this processor runs, found once.
const MapKernels& map_kernels() noexcept;

}  // namespace sulcus
