#include "engine/normals/quadric_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <Eigen/Dense>

namespace sulcus {

namespace {

using Vector6d = Eigen::Matrix<double, kQuadric, 1>;

Vector6d basis(double i, double j) {
  return (Vector6d() << 1, i, j, i * i, i * j, j * j).finished();
}

QuadricFilter make_filter(int rings, int lanes) {
  const int terms = rings >= 2 ? kQuadric : 3;
  const auto weight = [&](int i, int j) {
    return std::max(0.02, 1.0 - (i * i + j * j) / (2.5 * rings * rings));
  };
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
  for (int j = -rings; j <= rings; ++j) {
    for (int i = -rings; i <= rings; ++i) {
      const Eigen::VectorXd b = basis(i, j).head(terms);
      normal += weight(i, j) * b * b.transpose();
    }
  }
  const Eigen::MatrixXd inverse = normal.inverse();

  QuadricFilter filter;
  filter.rings = rings;
  filter.lanes = lanes;
  for (int f = 0; f < terms; ++f) {
    const auto exact = [&](int i, int j) {
      return weight(i, j) * inverse.row(f).dot(basis(i, j).head(terms));
    };
    double largest = 0.0;
    for (int j = -rings; j <= rings; ++j) {
      for (int i = -rings; i <= rings; ++i) largest = std::max(largest, std::abs(exact(i, j)));
    }
    // A power of two, so that nothing but the rounding of the coefficients is lost; one bit is left
    // for the centre, which is set so that a level map gives exactly its level and nothing else.
    const double unit = std::exp2(std::floor(std::log2(16383.0 / largest)));
    int sum = 0;
    auto& coefficient = filter.coefficient[static_cast<std::size_t>(f)];
    const auto place = [&](int i, int j) {
      return static_cast<std::size_t>((rings + j) * lanes + lanes / 2 + i);
    };
    for (int j = -rings; j <= rings; ++j) {
      for (int i = -rings; i <= rings; ++i) {
        const auto rounded = static_cast<std::int16_t>(std::lround(unit * exact(i, j)));
        coefficient[place(i, j)] = rounded;
        sum += rounded;
      }
    }
    const int wanted = f == 0 ? static_cast<int>(unit) : 0;
    coefficient[place(0, 0)] = static_cast<std::int16_t>(coefficient[place(0, 0)] + wanted - sum);
    filter.scale[static_cast<std::size_t>(f)] = static_cast<float>(1.0 / unit);
  }
  if (rings < 2) return filter;
  const auto answer = [&](int f, int power_x, int power_y) {
    double sum = 0.0;
    for (int j = -rings; j <= rings; ++j) {
      for (int i = -rings; i <= rings; ++i) {
        const auto place = static_cast<std::size_t>((rings + j) * lanes + lanes / 2 + i);
        sum += filter.coefficient[static_cast<std::size_t>(f)][place] * std::pow(i, power_x) *
               std::pow(j, power_y);
      }
    }
    return static_cast<float>(sum) * filter.scale[static_cast<std::size_t>(f)];
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
