// Fits of square windows of a tile of heights, eight whose centres lie side by side: a loop of
// map_kernels.hpp. Sums are whole numbers, so that no order of adding them matters.

#pragma once

#include "engine/normals/kernels/simd.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

/// Eight heights side by side.
inline IntLanes load_heights(const std::int16_t* p) {
  using Shorts = std::int16_t __attribute__((vector_size(16)));
  Shorts v;
  __builtin_memcpy(&v, p, sizeof v);
  return __builtin_convertvector(v, IntLanes);
}
inline IntLanes lower(const IntLanes& a, const IntLanes& b) { return a < b ? a : b; }
inline IntLanes higher(const IntLanes& a, const IntLanes& b) { return a > b ? a : b; }

using UnsignedLanes = std::uint32_t __attribute__((vector_size(32)));  // may wrap

/// Sums over windows, of heights less those at their centres.
struct WindowSums {
  IntLanes one{}, i{}, j{}, ii{}, ij{}, jj{};
  UnsignedLanes squares{};
  IntLanes lowest{}, highest{};
};

template <int kRings>
inline WindowSums sum_windows(const std::int16_t* centre, std::ptrdiff_t pitch,
                              const IntLanes& at_centre) {
  WindowSums s;
  const auto take = [&](const IntLanes& h) {
    s.lowest = lower(s.lowest, h);
    s.highest = higher(s.highest, h);
    const auto any_sign = reinterpret_cast<UnsignedLanes>(h);
    s.squares += any_sign * any_sign;
  };
  struct Row {
    IntLanes one, i, ii;
  };
  const auto row_of = [&](const std::int16_t* p) {
    const IntLanes middle = load_heights(p) - at_centre;
    take(middle);
    Row row{middle, IntLanes{}, IntLanes{}};
#pragma GCC unroll 7
    for (int n = 1; n <= kRings; ++n) {
      const IntLanes right = load_heights(p + n) - at_centre,
                     left = load_heights(p - n) - at_centre;
      take(right), take(left);
      const IntLanes both = right + left;
      row.one += both, row.i += n * (right - left), row.ii += n * n * both;
    }
    return row;
  };
  const Row middle = row_of(centre);
  s.one = middle.one, s.i = middle.i, s.ii = middle.ii;
  for (int n = 1; n <= kRings; ++n) {
    const Row above = row_of(centre + n * pitch), below = row_of(centre - n * pitch);
    const IntLanes both = above.one + below.one;
    s.one += both, s.i += above.i + below.i, s.ii += above.ii + below.ii;
    s.j += n * (above.one - below.one), s.jj += n * n * both;
    s.ij += n * (above.i - below.i);
  }
  return s;
}

inline WindowSums sum_windows(const std::int16_t* centre, std::ptrdiff_t pitch, int rings,
                              const IntLanes& at_centre) {
  switch (rings) {
    case 2:
      return sum_windows<2>(centre, pitch, at_centre);
    case 3:
      return sum_windows<3>(centre, pitch, at_centre);
    case 4:
      return sum_windows<4>(centre, pitch, at_centre);
    case 5:
      return sum_windows<5>(centre, pitch, at_centre);
    case 6:
      return sum_windows<6>(centre, pitch, at_centre);
    default:
      return sum_windows<7>(centre, pitch, at_centre);
  }
}

inline void fit_windows(const std::int16_t* centre, std::ptrdiff_t pitch,
                        const WindowFilter& filter, WindowFits& to) noexcept {
  const IntLanes at_centre = load_heights(centre);
  const WindowSums s = sum_windows(centre, pitch, filter.rings, at_centre);
  const Lanes one = to_float(s.one), i = to_float(s.i), j = to_float(s.j), ii = to_float(s.ii),
              ij = to_float(s.ij), jj = to_float(s.jj);
  const FilterSolution& f = filter.solution;
  const QuadricOf<Lanes> fitted = {
      f.value * one + f.value_curvature * (ii + jj),
      f.slope * i,
      f.slope * j,
      f.value_curvature * one + (f.curvature * ii + f.curvature_across * jj),
      f.twist * ij,
      f.value_curvature * one + (f.curvature_across * ii + f.curvature * jj)};
  const Lanes explained = fitted[0] * one + ((fitted[1] * i + fitted[2] * j) +
                                             ((fitted[3] * ii + fitted[5] * jj) + fitted[4] * ij));
  const Lanes left = larger(to_float(reinterpret_cast<IntLanes>(s.squares)) - explained, Lanes{});
  constexpr float kPerPart = 1.0f / kHeightParts;
  QuadricOf<Lanes> voxels;
  for (unsigned n = 0; n < kQuadric; ++n) voxels[n] = fitted[n] * kPerPart;
  const Lanes cosine2 = 1.0f / (1.0f + (voxels[1] * voxels[1] + voxels[2] * voxels[2]));
  const FilterAnswers& a = filter.answers;
  const FilterAnswersOf<Lanes> answers{Lanes{} + a.slope_x3,     Lanes{} + a.slope_xy2,
                                       Lanes{} + a.value_x4,     Lanes{} + a.value_x2y2,
                                       Lanes{} + a.curvature_x4, Lanes{} + a.curvature_x2y2,
                                       Lanes{} + a.curvature_y4, Lanes{} + a.twist_x3y};
  const ColumnQuadricOf<Lanes> q = column_quadric(voxels, answers, 1.0f);
  for (unsigned n = 0; n < kQuadric; ++n) store(q.c[n], to.c[n]);
  const IntLanes fits = (at_centre != kNoHeight) & (s.highest - s.lowest <= filter.steepest);
  const Lanes none = Lanes{} + __builtin_inff();
  store(fits ? left * (cosine2 * filter.spread) : none, to.mean_square);
  store(at_centre, to.centre);
  store(s.lowest + at_centre, to.lowest), store(s.highest + at_centre, to.highest);
}

}  // namespace

}  // namespace sulcus
