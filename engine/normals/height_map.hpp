#pragma once

#include <array>
#include <cstdint>

#include "engine/normals/ldm_tuning.hpp"
#include "engine/volume/column_bits.hpp"

namespace sulcus {

/// Largest neighbourhood NS of a local distance map; its columns stay within the border of
/// ColumnBits.
inline constexpr int kMaxNeighbourhood = 12;
/// Largest trace: heights that a 32-bit window around the voxel holds, with the steps around them.
inline constexpr int kMaxTrace = 13;

/// |z(p) + z(-p) - 2 z(0)| within an even window of so many rings, at most, voxels.
constexpr int most_uneven(int rings) {
  return rings < kManyRings ? kMostUneven : kMostUnevenOfMany;
}

/// What a trace follows first: where the surface is steep or has several layers, heights depend on
/// it.
enum class TraceOrder : std::uint8_t {
  kRowFirst,     // the middle row outward, then the other columns outward from it
  kColumnFirst,  // the middle column, then the others from it
  kBoth,         // what both find alike
};

/// A local distance map [Kim and Park 2019, V]: heights of the surface above the plane through a
/// voxel across a grid axis, in the direction of that axis (not outward), in whole voxels; the
/// height of a column is that of its outermost solid voxel. Row by row: (i, j) lies in lane
/// lanes / 2 + i of row ns + j. Rows are whole vectors; lanes beyond the map hold kNone.
struct HeightMap {
  static constexpr signed char kNone = -128;  // no surface was found in the column
  static constexpr int kMaxRows = 2 * kMaxNeighbourhood + 1;
  static constexpr int kMaxLanes = 32;

  // Set by the caller of a trace.
  int ns = 0;      // neighbourhood, columns
  int stride = 1;  // voxels from one column to the next: 1 or 2; 2 needs ns < 8
  int sign = 1;    // of the outward direction along the axis
  TraceOrder order = TraceOrder::kRowFirst;
  // Set by the trace.
  int lanes = 0;        // of a row: 16 or 32
  int whole_rings = 0;  // all heights in these rings are found and within the trace; -1: none
  int even_rings = 0;   // and opposite heights are in line with the centre's (most_uneven)
  /// And one row more, of no meaning: a row may be read from its second lane on.
  alignas(32) std::array<signed char, (kMaxRows + 1) * kMaxLanes> height;

  const signed char* middle_row() const { return height.data() + ns * lanes; }
  int place(int i, int j) const { return (ns + j) * lanes + lanes / 2 + i; }
  // In place even where little is optimised: a kernel's copy is compiled for its instruction set.
  [[gnu::always_inline]] int at(int i, int j) const {
    return height[static_cast<std::size_t>(place(i, j))];
  }
};

/// Which columns of a map its quadric is fitted to.
enum class FitWindow : std::uint8_t {
  kEvenRings,  // those in which opposite heights are in line (even_rings)
  kWholeMap,   // all, where all were found
  kNone,       // none: the caller fits them
};

/// Lanes of a map's rows: as few as hold its columns and the one before them.
constexpr int lanes_of(int ns) { return ns < 8 ? 16 : 32; }
/// Whether there are maps of stride 2 of this neighbourhood.
constexpr bool has_wide_maps(int ns) { return ns < 8; }

}  // namespace sulcus
