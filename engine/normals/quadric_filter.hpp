#pragma once

#include <array>
#include <cstdint>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"

namespace sulcus {

/// Weighted least-squares quadric of the innermost rings of a map: weights and inverse
/// normal matrix of the fit [eqs. 3 and 4, with window weights and the square lattice's own
/// moments]. Weights and powers are whole numbers, so that the sums are exact in any order.
struct QuadricFilter {
  int rings = 0, lanes = 0;
  /// Weight times 1, i, j, i^2, i j, j^2: row by row, 2 rings + 1 of them, zero beyond the window.
  alignas(32) std::array<std::array<std::int16_t, HeightMap::kMaxRows * HeightMap::kMaxLanes>,
                         kQuadric> coefficient{};
  FilterSolution solution{};
  FilterAnswers answers{};
};

/// Weights 1 - r^2 / (2.5 rings^2) as whole numbers, `centre` - `fall` r^2. (Of 11 rings they are
/// rounded, so that weight times i^2 fits 16 bits.)
struct WindowWeight {
  int centre, fall;
};
constexpr WindowWeight window_weight_of(int rings) {
  return rings % 2 == 1 && rings < 11 ? WindowWeight{5 * rings * rings, 2}
                                      : WindowWeight{5 * rings * rings / 2, 1};
}

/// Filter for the innermost `rings` of a map of so many lanes, weights as window_weight_of says;
/// with one ring a plane, since a quadric would interpolate the quantisation of the centre. 1 <=
/// rings <= kMaxNeighbourhood. All are made on first use, see prepare_normals.
const QuadricFilter& quadric_filter(int rings, int lanes) noexcept;

}  // namespace sulcus
