#pragma once

#include <optional>

#include <Eigen/Core>

#include "tools/sulcus_lab/truth/grey_spline.hpp"

namespace sulcus::lab {

/// The point of the surface of a level that is closest to another one; all in lattice steps.
struct GreySurfacePoint {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  // out of the solid, unit: minus the normalised gradient there
  double offset = 0.0;     // from the other point along the normal, as SurfaceEstimate has it
  double slope = 0.0;      // of the grey value along the normal, per step
  double curvature = 0.0;  // the larger of the principal ones in size, 1 / step
};

/// The surface at which grey values reach a level; solid is from there on.
class GreySurface {
 public:
  /// `spline` must outlive this.
  GreySurface(const GreySpline& spline, double level) : spline_(spline), level_(level) {}

  bool solid(const Eigen::Vector3d& p) const { return spline_.value(p) >= level_; }

  /// To a billionth of a step, or none within kReach of `p`. The surface is first found along 26
  /// directions; the nearest of those places lead to it by Newton's steps along the gradient and
  /// steps along the surface, in turn.
  std::optional<GreySurfacePoint> closest_point(const Eigen::Vector3d& p) const;
  static constexpr double kReach = 2.5;

  /// Whether the surface goes through the line from a point of it along its normal, within
  /// `reach` to either side: the other face of a thin wall, or of a narrow gap.
  bool is_thin(const GreySurfacePoint& at, double reach) const;

 private:
  /// How far along `way` (unit) from p, which is solid or not, the surface comes within `reach`.
  std::optional<double> crossing(const Eigen::Vector3d& p, bool in, const Eigen::Vector3d& way,
                                 double reach) const;
  std::optional<GreySurfacePoint> refined(const Eigen::Vector3d& p, Eigen::Vector3d x) const;

  const GreySpline& spline_;
  double level_;
};

}  // namespace sulcus::lab
