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

/// Sums over a row of columns to either side of eight centres. `windows` in order of their rings.
inline void sum_row(const std::int16_t* centre, const RowOfWindows* windows, int count) noexcept {
  const IntLanes middle = load_heights(centre);
  const auto square = [](const IntLanes& h) {
    const auto any_sign = reinterpret_cast<UnsignedLanes>(h);
    return any_sign * any_sign;
  };
  IntLanes one = middle, i{}, ii{}, lowest = middle, highest = middle;
  UnsignedLanes squares = square(middle);
  for (int n = 1; count > 0; ++n) {
    const IntLanes right = load_heights(centre + n), left = load_heights(centre - n);
    lowest = lower(lowest, lower(left, right));
    highest = higher(highest, higher(left, right));
    squares += square(left) + square(right);
    const IntLanes both = right + left;
    one += both, i += n * (right - left), ii += n * n * both;
    if (windows->rings != n) continue;
    RowSums& to = *windows->sums;
    store(one, to.one), store(i, to.i), store(ii, to.ii);
    store(reinterpret_cast<IntLanes>(squares), to.squares);
    store(lowest, to.lowest), store(highest, to.highest);
    ++windows, --count;
  }
}

/// Sums over windows, of heights less those at their centres.
struct WindowSums {
  IntLanes one{}, i{}, j{}, ii{}, ij{}, jj{};
  UnsignedLanes squares{};
  IntLanes lowest{}, highest{};
};

/// From the sums of its rows. Heights are taken less those at the centres in the end: squares
/// modulo 2^32 are right where what is left is below that.
inline WindowSums sum_windows(const RowSums* middle, int rings, const IntLanes& at_centre) {
  WindowSums s;
  s.one = load(middle->one), s.i = load(middle->i), s.ii = load(middle->ii);
  s.squares = reinterpret_cast<UnsignedLanes>(load(middle->squares));
  s.lowest = load(middle->lowest), s.highest = load(middle->highest);
  int sum_of_squares = 0;  // 1 + 4 + ...
  for (int n = 1; n <= rings; ++n) {
    const RowSums &above = middle[n], &below = middle[-n];
    const IntLanes one_above = load(above.one), one_below = load(below.one),
                   i_above = load(above.i), i_below = load(below.i);
    const IntLanes both = one_above + one_below;
    s.one += both, s.i += i_above + i_below;
    s.ii += load(above.ii) + load(below.ii);
    s.j += n * (one_above - one_below), s.jj += n * n * both;
    s.ij += n * (i_above - i_below);
    s.squares += reinterpret_cast<UnsignedLanes>(load(above.squares)) +
                 reinterpret_cast<UnsignedLanes>(load(below.squares));
    s.lowest = lower(s.lowest, lower(load(above.lowest), load(below.lowest)));
    s.highest = higher(s.highest, higher(load(above.highest), load(below.highest)));
    sum_of_squares += n * n;
  }
  const int side = 2 * rings + 1, columns = side * side, second = 2 * sum_of_squares * side;
  const auto centre = reinterpret_cast<UnsignedLanes>(at_centre),
             sum = reinterpret_cast<UnsignedLanes>(s.one);
  s.squares += centre * (static_cast<unsigned>(columns) * centre - 2u * sum);
  s.one -= columns * at_centre;
  s.ii -= second * at_centre, s.jj -= second * at_centre;
  s.lowest -= at_centre, s.highest -= at_centre;
  return s;
}

inline void fit_windows(const std::int16_t* centre, const RowSums* middle,
                        const WindowFilter& filter, WindowFits& to) noexcept {
  const IntLanes at_centre = load_heights(centre);
  const WindowSums s = sum_windows(middle, filter.rings, at_centre);
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
