#pragma once

#include <cstdint>

#include "engine/normals/column_quadric.hpp"

namespace sulcus {

/// Parts of a voxel that heights count: those of fill levels. Rounded to 64 they gave the same
/// errors, but in a straight cut all columns along it change at once, and the force with them.
inline constexpr int kHeightParts = 255;
/// Of a column without a surface.
inline constexpr std::int16_t kNoHeight = -32768;

/// Least-squares quadric of all heights of a square window of columns, each counting alike: sums
/// over rows, then over columns, are all that it needs. Of heights that are exact to a hundredth of
/// a voxel none says more than another.
struct WindowFilter {
  int rings = 0;     // of (2 rings + 1)^2 columns
  int steepest = 0;  // heights farther apart are not fitted: their squares would not fit 32 bits
  float spread = 0;  // from the sum of squared residuals, parts, to their mean, voxels
  FilterSolution solution{};
  FilterAnswers answers{};
};

/// 2 <= rings <= kMostWindowRings. All are made on first use, see prepare_normals.
inline constexpr int kMostWindowRings = 7;
const WindowFilter& window_filter(int rings) noexcept;

/// What a row of heights gives to eight windows whose centres lie side by side: sums over the
/// columns of each, i across from its centre. Windows one above the other share them.
struct alignas(32) RowSums {
  static constexpr int kSize = 8;
  std::int32_t one[kSize], i[kSize], ii[kSize];  // of height times 1, i, i^2
  std::int32_t squares[kSize];                   // of heights, modulo 2^32
  std::int32_t lowest[kSize], highest[kSize];    // heights
};
/// Windows of so many rings, and where their sums go.
struct RowOfWindows {
  int rings = 0;
  RowSums* sums = nullptr;
};

/// The fits of eight windows whose centres lie side by side.
struct alignas(32) WindowFits {
  static constexpr int kSize = 8;
  float c[kQuadric][kSize];    // of ColumnQuadric, voxels; c[0] above the height at the centre
  float mean_square[kSize];    // of the residuals across the surface, voxels^2; infinite: no fit
  std::int32_t centre[kSize];  // height there, parts
  std::int32_t lowest[kSize], highest[kSize];  // of the window, parts
};

}  // namespace sulcus
