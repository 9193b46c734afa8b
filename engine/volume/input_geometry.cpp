#include "engine/volume/input_geometry.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace sulcus {
namespace {

using Rows3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Rows4 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

constexpr double kMostVoxels = 1 << 24;  // along an axis

bool is_size(double value) {
  return value >= 1.0 && value <= kMostVoxels && value == std::floor(value);
}

}  // namespace

Eigen::Affine3d InputGeometry::file_from_lattice() const {
  Eigen::Affine3d file_from_lattice = Eigen::Affine3d::Identity();
  file_from_lattice.linear() = direction * spacing_m.asDiagonal();
  file_from_lattice.translation() = origin_m;
  return file_from_lattice;
}

std::array<double, InputGeometry::kNumbers> InputGeometry::numbers() const {
  std::array<double, kNumbers> all{};
  Eigen::Map<Rows4>(all.data()) = file_from_world.affine();
  Eigen::Map<Eigen::Vector3d>(all.data() + 12) = sizes.cast<double>();
  Eigen::Map<Eigen::Vector3d>(all.data() + 15) = spacing_m;
  Eigen::Map<Eigen::Vector3d>(all.data() + 18) = origin_m;
  Eigen::Map<Rows3>(all.data() + 21) = direction;
  return all;
}

std::optional<InputGeometry> InputGeometry::of(std::span<const double, kNumbers> numbers) {
  if (!std::ranges::all_of(numbers, [](double v) { return std::isfinite(v); })) return {};
  InputGeometry g;
  g.file_from_world.affine() = Eigen::Map<const Rows4>(numbers.data());
  const Eigen::Vector3d sizes = Eigen::Map<const Eigen::Vector3d>(numbers.data() + 12);
  g.spacing_m = Eigen::Map<const Eigen::Vector3d>(numbers.data() + 15);
  g.origin_m = Eigen::Map<const Eigen::Vector3d>(numbers.data() + 18);
  g.direction = Eigen::Map<const Rows3>(numbers.data() + 21);
  const Eigen::Matrix3d turned = g.file_from_world.linear();
  constexpr double kRigid = 1e-3;
  const bool rigid = (turned * turned.transpose() - Eigen::Matrix3d::Identity()).norm() < kRigid &&
                     turned.determinant() > 0.0;
  const bool lattice = is_size(sizes.x()) && is_size(sizes.y()) && is_size(sizes.z());
  if (!rigid || (!lattice && !sizes.isZero()) || (g.spacing_m.array() <= 0.0).any() ||
      std::abs(g.direction.determinant()) < 1e-3) {
    return {};
  }
  g.sizes = sizes.cast<int>();
  return g;
}

}  // namespace sulcus
