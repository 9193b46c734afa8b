#include "haptics/contact/edge_gain.hpp"

#include <Eigen/LU>

namespace sulcus {

namespace {

constexpr double kNoEdge = 0.05;  // s

}  // namespace

Eigen::Matrix3d edge_gain(const NormalSpread& spread) noexcept {
  if (spread.weight <= 0.0) return Eigen::Matrix3d::Zero();
  const Eigen::Vector3d mean =
      Eigen::Vector3d(spread.normal[0], spread.normal[1], spread.normal[2]) / spread.weight;
  Eigen::Matrix3d covariance;
  for (int a = 0, entry = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b, ++entry) {
      covariance(a, b) = covariance(b, a) =
          spread.products[entry] / spread.weight - mean[a] * mean[b];
    }
  }
  const Eigen::Matrix3d squared = covariance * covariance;
  const Eigen::Matrix3d gain =
      squared * (squared + kNoEdge * kNoEdge * Eigen::Matrix3d::Identity()).inverse();
  return 0.5 * (gain + gain.transpose());
}

}  // namespace sulcus
