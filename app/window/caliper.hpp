#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

namespace sulcus {

/// Two points that are set one after the other, and how far they are apart; the next one begins
/// anew.
class Caliper {
 public:
  void set(const Eigen::Vector3d& point_world) {
    if (!first_ || second_) {
      first_ = point_world;
      second_.reset();
    } else {
      second_ = point_world;
    }
  }
  void clear() {
    first_.reset();
    second_.reset();
  }
  const std::optional<Eigen::Vector3d>& first() const { return first_; }
  const std::optional<Eigen::Vector3d>& second() const { return second_; }
  /// m; none until there are both.
  std::optional<double> distance_m() const {
    if (!second_) return {};
    return (*second_ - *first_).norm();
  }

 private:
  std::optional<Eigen::Vector3d> first_, second_;
};

/// "[-1.500, 0.250, 7.600]": a point as scenes have it, mm.
std::string place_text(const Eigen::Vector3d& point_world);

}  // namespace sulcus
