#include "tools/sulcus_lab/truth/grey_spline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace sulcus::lab {

namespace {

/// Turns `count` values, `stride` apart, into the coefficients of the spline through them:
/// the inverse of (1, 4, 1) / 6, by one recursion forwards and one backwards [Unser 1999, box 2].
void to_coefficients(double* first, int count, std::ptrdiff_t stride) {
  if (count < 2) return;
  constexpr double kPole = std::numbers::sqrt3 - 2.0, kGain = 6.0;
  constexpr int kReach = 40;  // the pole's power is below a double's last bit there
  const auto at = [&](int i) -> double& { return first[i * stride]; };
  double sum = 0.0, power = 1.0;
  const int period = 2 * count - 2;
  for (int i = 0; i < kReach; ++i, power *= kPole) {
    const int place = i % period;
    sum += power * at(place < count ? place : period - place);
  }
  double before = kGain * sum;
  at(0) = before;
  for (int i = 1; i < count; ++i) before = at(i) = kGain * at(i) + kPole * before;
  double after = kPole / (kPole * kPole - 1.0) * (at(count - 1) + kPole * at(count - 2));
  at(count - 1) = after;
  for (int i = count - 2; i >= 0; --i) after = at(i) = kPole * (after - at(i));
}

/// The four points about a place along one axis, with the spline's weights and their derivatives.
struct Taps {
  std::array<std::size_t, 4> at;
  std::array<double, 4> weight, slope, bend;

  Taps(double p, int count) {
    const double floor = std::floor(p);
    const int first = static_cast<int>(floor) - 1, period = count > 1 ? 2 * count - 2 : 1;
    for (int i = 0; i < 4; ++i) {
      int place = first + i;
      if (place < 0 || place >= count) {
        place = (place % period + period) % period;
        place = std::min(place, period - place);
      }
      at[static_cast<std::size_t>(i)] = static_cast<std::size_t>(place);
    }
    const double t = p - floor, s = 1.0 - t;
    weight = {s * s * s / 6.0, 2.0 / 3.0 - 0.5 * t * t * (2.0 - t),
              2.0 / 3.0 - 0.5 * s * s * (2.0 - s), t * t * t / 6.0};
    slope = {-0.5 * s * s, t * (1.5 * t - 2.0), -s * (1.5 * s - 2.0), 0.5 * t * t};
    bend = {s, 3.0 * t - 2.0, 3.0 * s - 2.0, t};
  }
};

}  // namespace

GreySpline::GreySpline(const MedicalVolume& volume, GreyTruth truth)
    : sizes_(volume.sizes), coefficients_(volume.values.begin(), volume.values.end()) {
  if (truth == GreyTruth::kSmoothed) return;
  std::ptrdiff_t stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const std::array<std::ptrdiff_t, 3> strides{1, sizes_.x(),
                                                std::ptrdiff_t{sizes_.x()} * sizes_.y()};
    for (int j = 0; j < sizes_[b]; ++j) {
      for (int i = 0; i < sizes_[a]; ++i) {
        to_coefficients(
            &coefficients_[static_cast<std::size_t>(i * strides[static_cast<std::size_t>(a)] +
                                                    j * strides[static_cast<std::size_t>(b)])],
            sizes_[axis], stride);
      }
    }
    stride *= sizes_[axis];
  }
}

double GreySpline::value(const Eigen::Vector3d& p) const {
  const Taps x(p.x(), sizes_.x()), y(p.y(), sizes_.y()), z(p.z(), sizes_.z());
  const auto nx = static_cast<std::size_t>(sizes_.x()), ny = static_cast<std::size_t>(sizes_.y());
  double value = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const double* const row = &coefficients_[nx * (y.at[j] + ny * z.at[k])];
      double along = 0.0;
      for (std::size_t i = 0; i < 4; ++i) along += x.weight[i] * row[x.at[i]];
      value += z.weight[k] * y.weight[j] * along;
    }
  }
  return value;
}

GreySpline::Sample GreySpline::sample(const Eigen::Vector3d& p) const {
  const Taps x(p.x(), sizes_.x()), y(p.y(), sizes_.y()), z(p.z(), sizes_.z());
  const auto nx = static_cast<std::size_t>(sizes_.x()), ny = static_cast<std::size_t>(sizes_.y());
  Sample at{0.0, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const double* const row = &coefficients_[nx * (y.at[j] + ny * z.at[k])];
      double along = 0.0, slope = 0.0, bend = 0.0;
      for (std::size_t i = 0; i < 4; ++i) {
        const double c = row[x.at[i]];
        along += x.weight[i] * c;
        slope += x.slope[i] * c;
        bend += x.bend[i] * c;
      }
      at.value += z.weight[k] * y.weight[j] * along;
      at.gradient +=
          Eigen::Vector3d(z.weight[k] * y.weight[j] * slope, z.weight[k] * y.slope[j] * along,
                          z.slope[k] * y.weight[j] * along);
      at.hessian(0, 0) += z.weight[k] * y.weight[j] * bend;
      at.hessian(1, 1) += z.weight[k] * y.bend[j] * along;
      at.hessian(2, 2) += z.bend[k] * y.weight[j] * along;
      at.hessian(0, 1) += z.weight[k] * y.slope[j] * slope;
      at.hessian(0, 2) += z.slope[k] * y.weight[j] * slope;
      at.hessian(1, 2) += z.slope[k] * y.slope[j] * along;
    }
  }
  at.hessian(1, 0) = at.hessian(0, 1);
  at.hessian(2, 0) = at.hessian(0, 2);
  at.hessian(2, 1) = at.hessian(1, 2);
  return at;
}

}  // namespace sulcus::lab
