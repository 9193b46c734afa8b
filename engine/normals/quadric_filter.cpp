#include "engine/normals/quadric_filter.hpp"

#include <array>
#include <cmath>
#include <memory>

#include <Eigen/Dense>

#include "engine/normals/window_filter.hpp"

namespace sulcus {

namespace {

using Vector6d = Eigen::Matrix<double, kQuadric, 1>;
using Matrix6d = Eigen::Matrix<double, kQuadric, kQuadric>;

Vector6d basis(double i, double j) {
  return (Vector6d() << 1, i, j, i * i, i * j, j * j).finished();
}

/// Calls `each(i, j, weight)` for the columns of a window.
template <class Weight, class Each>
void for_columns(int rings, const Weight& weight_of, const Each& each) {
  for (int j = -rings; j <= rings; ++j) {
    for (int i = -rings; i <= rings; ++i) each(i, j, static_cast<double>(weight_of(i, j)));
  }
}

/// What solves the normal equations of a window's quadric; with one ring a plane's.
template <class Weight>
void solve_window(int rings, const Weight& weight_of, FilterSolution& solution,
                  FilterAnswers& answers) {
  const int terms = rings >= 2 ? kQuadric : 3;
  Matrix6d normal = Matrix6d::Zero();
  for_columns(rings, weight_of, [&](int i, int j, double weight) {
    normal += weight * basis(i, j) * basis(i, j).transpose();
  });
  Matrix6d inverse = Matrix6d::Zero();
  inverse.topLeftCorner(terms, terms) = normal.topLeftCorner(terms, terms).inverse();
  const auto number = [&](int f, int g) { return static_cast<float>(inverse(f, g)); };
  solution = {static_cast<std::int32_t>(normal(0, 0)),
              static_cast<std::int32_t>(normal(0, 3)),
              number(0, 0),
              number(0, 3),
              number(3, 3),
              number(3, 5),
              number(1, 1),
              number(4, 4)};
  if (rings < 2) return;
  const auto answer = [&](int f, int power_x, int power_y) {
    double sum = 0.0;
    for_columns(rings, weight_of, [&](int i, int j, double weight) {
      sum += weight * inverse.row(f).dot(basis(i, j)) * std::pow(i, power_x) * std::pow(j, power_y);
    });
    return static_cast<float>(sum);
  };
  answers = {answer(1, 3, 0), answer(1, 1, 2), answer(0, 4, 0), answer(0, 2, 2),
             answer(3, 4, 0), answer(3, 2, 2), answer(3, 0, 4), answer(4, 3, 1)};
}

QuadricFilter make_filter(int rings, int lanes) {
  QuadricFilter filter;
  filter.rings = rings;
  filter.lanes = lanes;
  const auto weight_of = [by = window_weight_of(rings)](int i, int j) {
    return by.centre - by.fall * (i * i + j * j);
  };
  for_columns(rings, weight_of, [&](int i, int j, double weight) {
    const auto place = static_cast<std::size_t>((rings + j) * lanes + lanes / 2 + i);
    const Vector6d weighted = weight * basis(i, j);
    for (std::size_t f = 0; f < kQuadric; ++f) {
      filter.coefficient[f][place] = static_cast<std::int16_t>(weighted[static_cast<int>(f)]);
    }
  });
  solve_window(rings, weight_of, filter.solution, filter.answers);
  return filter;
}

WindowFilter make_window_filter(int rings) {
  const int columns = (2 * rings + 1) * (2 * rings + 1);
  WindowFilter filter;
  filter.rings = rings;
  filter.steepest = static_cast<int>(std::sqrt(std::ldexp(1.0, 31) / columns));
  filter.spread = static_cast<float>(
      1.0 / (kHeightParts * kHeightParts * static_cast<double>(columns - kQuadric)));
  solve_window(
      rings, [](int, int) { return 1; }, filter.solution, filter.answers);
  return filter;
}

}  // namespace

const QuadricFilter& quadric_filter(int rings, int lanes) noexcept {
  // Over-aligned and large: on the heap, by rings, narrow maps first.
  static const auto filters = [] {
    auto all = std::make_unique<std::array<std::array<QuadricFilter, kMaxNeighbourhood + 1>, 2>>();
    for (int n = 1; n <= kMaxNeighbourhood; ++n) {
      if (n < 8) (*all)[0][n] = make_filter(n, 16);
      (*all)[1][n] = make_filter(n, 32);
    }
    return all;
  }();
  return (*filters)[lanes == 32][rings];
}

const WindowFilter& window_filter(int rings) noexcept {
  static const auto filters = [] {
    std::array<WindowFilter, kMostWindowRings + 1> all;
    for (int n = 2; n <= kMostWindowRings; ++n) {
      all[static_cast<std::size_t>(n)] = make_window_filter(n);
    }
    return all;
  }();
  return filters[static_cast<std::size_t>(rings)];
}

}  // namespace sulcus
