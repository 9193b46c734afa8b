#include "engine/normals/quadric_filter.hpp"

#include <array>
#include <cmath>
#include <memory>

#include <Eigen/Dense>

namespace sulcus {

namespace {

using Vector6d = Eigen::Matrix<double, kQuadric, 1>;
using Matrix6d = Eigen::Matrix<double, kQuadric, kQuadric>;

Vector6d basis(double i, double j) {
  return (Vector6d() << 1, i, j, i * i, i * j, j * j).finished();
}

QuadricFilter make_filter(int rings, int lanes) {
  const int terms = rings >= 2 ? kQuadric : 3;
  QuadricFilter filter;
  filter.rings = rings;
  filter.lanes = lanes;
  const WindowWeight window_weight = window_weight_of(rings);
  const auto for_pixels = [&](const auto& each) {
    for (int j = -rings; j <= rings; ++j) {
      for (int i = -rings; i <= rings; ++i) {
        each(i, j, static_cast<double>(window_weight.centre - window_weight.fall * (i * i + j * j)),
             static_cast<std::size_t>((rings + j) * lanes + lanes / 2 + i));
      }
    }
  };
  Matrix6d normal = Matrix6d::Zero();
  for_pixels([&](int i, int j, double weight, std::size_t place) {
    const Vector6d weighted = weight * basis(i, j);
    normal += weighted * basis(i, j).transpose();
    for (std::size_t f = 0; f < kQuadric; ++f) {
      filter.coefficient[f][place] = static_cast<std::int16_t>(weighted[static_cast<int>(f)]);
    }
  });
  Matrix6d inverse = Matrix6d::Zero();
  inverse.topLeftCorner(terms, terms) = normal.topLeftCorner(terms, terms).inverse();
  const auto number = [&](int f, int g) { return static_cast<float>(inverse(f, g)); };
  filter.solution = {static_cast<std::int32_t>(normal(0, 0)),
                     static_cast<std::int32_t>(normal(0, 3)),
                     number(0, 0),
                     number(0, 3),
                     number(3, 3),
                     number(3, 5),
                     number(1, 1),
                     number(4, 4)};
  if (rings < 2) return filter;
  const auto answer = [&](int f, int power_x, int power_y) {
    double sum = 0.0;
    for_pixels([&](int i, int j, double weight, std::size_t) {
      sum += weight * inverse.row(f).dot(basis(i, j)) * std::pow(i, power_x) * std::pow(j, power_y);
    });
    return static_cast<float>(sum);
  };
  filter.answers = {answer(1, 3, 0), answer(1, 1, 2), answer(0, 4, 0), answer(0, 2, 2),
                    answer(3, 4, 0), answer(3, 2, 2), answer(3, 0, 4), answer(4, 3, 1)};
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

}  // namespace sulcus
