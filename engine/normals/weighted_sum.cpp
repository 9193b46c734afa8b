#include "engine/normals/weighted_sum.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace sulcus {

namespace {

constexpr int kMaxCube = 12;

/// Factor of an offset, by its squared length, in units of 2^-32. Doubles that hold integers: at
/// most 25^3 terms of 12 units each stay under 2^50, so sums are exact; what is symmetric cancels
/// to zero and mirrored solids have mirrored normals.
using Factors = std::array<double, 3 * kMaxCube * kMaxCube + 1>;

Factors factors_of(WeightedSum kind) {
  Factors factors{};  // 0 at distance 0: the voxel itself says nothing
  for (std::size_t squared = 1; squared < factors.size(); ++squared) {
    const auto d2 = static_cast<double>(squared);
    const double d = std::sqrt(d2);
    factors[squared] =
        std::floor(4294967296.0 / (kind == WeightedSum::kAsStated ? d : d2 * d) + 0.5);
  }
  return factors;
}

const Factors kAsStatedFactors = factors_of(WeightedSum::kAsStated);
const Factors kAsPlottedFactors = factors_of(WeightedSum::kAsPlotted);

}  // namespace

SurfaceEstimate estimate_weighted_sum(const Workpiece& workpiece, const Cell& voxel,
                                      int neighbourhood, WeightedSum kind) noexcept {
  const int ns = neighbourhood;
  const Factors& factors = kind == WeightedSum::kAsStated ? kAsStatedFactors : kAsPlottedFactors;
  const ColumnBits::Windows columns =
      workpiece.columns().around(2, voxel.x(), voxel.y(), voxel.z() - ns);
  const std::uint64_t in_cube = (std::uint64_t{1} << (2 * ns + 1)) - 1;

  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int j = -ns; j <= ns; ++j) {
    for (int i = -ns; i <= ns; ++i) {
      const double* const of_column = factors.data() + i * i + j * j;
      double weight = 0.0, height = 0.0;  // sums over the column, all of it at (i, j)
      for (std::uint64_t rest = columns.window(i, j) & in_cube; rest != 0; rest &= rest - 1) {
        const int k = std::countr_zero(rest) - ns;
        const double factor = of_column[k * k];
        weight += factor;
        height += factor * k;
      }
      sum += Eigen::Vector3d(weight * i, weight * j, height);
    }
  }
  const double squared = sum.squaredNorm();
  if (squared == 0.0) return {};
  return {(-sum / std::sqrt(squared)).cast<float>(), 0.0f, true};
}

}  // namespace sulcus
