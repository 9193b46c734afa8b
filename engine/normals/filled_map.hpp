#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/normals/height_map.hpp"

namespace sulcus {

/// Parts of a voxel that heights count: those of fill levels. Rounded to 64 they gave the same
/// errors, but in a straight cut all columns along it change at once, and the force with them.
inline constexpr int kHeightParts = 255;

/// A local distance map of a solid with fractions: mean heights of the surface over the columns, in
/// parts of a voxel above the voxel's centre, outward. A column's is the sum of its fills from the
/// outermost solid voxel down to the first full one [height functions: Cummins, Francois and Kothe
/// 2005]. Rows as HeightMap's.
struct FilledMap {
  static constexpr std::int16_t kNone = -32768;  // no surface was found in the column

  int ns = 0, lanes = 0;
  // A bit for each row: a height was not found; a column has a voxel that is not full.
  std::uint32_t holes = 0, parts = 0;
  alignas(64) std::array<std::int16_t, HeightMap::kMaxRows * HeightMap::kMaxLanes> height;

  bool whole() const { return holes == 0; }
  /// Else it is as binary.
  bool has_parts() const { return parts != 0; }
  std::int16_t at(int i, int j) const {
    return height[static_cast<std::size_t>((ns + j) * lanes + lanes / 2 + i)];
  }
};

/// What columns about a leaf, along an axis one way, are below the top of their outermost solid
/// voxel: of neighbouring maps most columns are the same. Row v, lane u.
struct ColumnLacks {
  static constexpr int kMargin = 16, kRows = 2 * kMaxNeighbourhood + 8, kLanes = 8 + 2 * kMargin;
  static constexpr std::int16_t kUnknown = -32768;

  /// Along the axis, of the outermost solid voxel, and what the column lacks below its top, in
  /// parts; kUnknown where it has no surface.
  alignas(64) std::int16_t top[kRows][kLanes];
  alignas(64) std::int16_t lack[kRows][kLanes];
};

}  // namespace sulcus
