#pragma once

#include <array>
#include <cstdint>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/volume/column_bits.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

/// The columns of all maps of one leaf along one axis, and the sums of their fits: what
/// neighbouring maps share is read and added up once. Coordinates in the leaf: (u, v) across the
/// axis in cyclic order, heights from the leaf's lowest layer, in the direction of the axis.
///
/// A column counts where it has one surface near the leaf, so that no tracing can lead elsewhere.
/// The map about a column is `sound` where all of its columns count and tracing would follow them
/// from the centre out; then the map is a cut-out of the tile.
struct HeightTile {
  static constexpr int kEdge = kLeafEdge;
  static constexpr int kMargin = 8, kMaxNs = 7;  // columns about the leaf, and those that maps use
  static constexpr int kRows = kEdge + 2 * kMaxNs, kLanes = 32;
  /// Bit 0 of the windows is this far below the leaf. Heights are kept where all surfaces that a
  /// step could reach instead are in the windows; relative to a voxel, within kReach.
  static constexpr int kBelow = 12, kLowest = -9, kHighest = 16, kReach = 12;

  /// A column's height, and the highest and lowest of the map about it, and its even rings where
  /// they are wanted; out of reach of every voxel where the map is not sound.
  struct Column {
    signed char height, highest, lowest;
    std::uint8_t even_rings;
  };
  static constexpr Column kUnsound{0, 127, 0, 0};

  // Set by the caller.
  int ns = 0;
  int sign = 1;
  bool wants_even_rings = true;
  // Column (u, v) lies in lane kMargin + u of row ns + v.
  alignas(32) signed char height[kRows][kLanes];
  // Of the map about each column; sums of no meaning where it is not sound.
  std::uint8_t sound[kEdge];                              // bit u of row v
  alignas(64) Column columns[kEdge * kEdge];              // v kEdge + u
  alignas(32) std::int32_t sums[kEdge][kQuadric][kEdge];  // [v][f][u], of the whole maps

  /// Of the map about a column: as HeightMap's, of 16 lanes, kLanes to the next.
  const signed char* middle_row(int u, int v) const { return height[ns + v] + u; }
  int at(int u, int v) const { return height[ns + v][kMargin + u]; }
  /// Sums of the whole map about a column.
  QuadricSums sums_of(unsigned column) const {
    const auto& row = sums[column / kEdge];
    QuadricSums of;
    for (std::size_t f = 0; f < kQuadric; ++f) of[f] = row[f][column % kEdge];
    return of;
  }
  bool is_sound(int u, int v) const { return (sound[v] >> u & 1) != 0; }
};

}  // namespace sulcus
