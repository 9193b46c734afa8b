#pragma once

#include <array>
#include <cstdint>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"

namespace sulcus {

/// Weighted least-squares quadric of the innermost rings of a map, as plain sums over its heights
/// [eqs. 3 and 4, with a taper and the square lattice's own moments]. The coefficients are whole
/// numbers, so that the sums are exact in any order: c[f] = scale[f] * sum coefficient[f] * height.
struct QuadricFilter {
  int rings = 0, lanes = 0;
  std::array<float, kQuadric> scale{};
  /// Row by row, 2 rings + 1 of them, zero beyond the window.
  alignas(32) std::array<std::array<std::int16_t, HeightMap::kMaxRows * HeightMap::kMaxLanes>,
                         kQuadric> coefficient{};
  FilterAnswers answers{};
};

/// Filter for the innermost `rings` of a map of so many lanes, weights
/// max(0.02, 1 - r^2 / (2.5 rings^2)); with one ring a plane, since a quadric would interpolate the
/// quantisation of the centre. 1 <= rings <= kMaxNeighbourhood. All are made on first use, see
/// prepare_normals.
const QuadricFilter& quadric_filter(int rings, int lanes) noexcept;

}  // namespace sulcus
