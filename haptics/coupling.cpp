#include "haptics/coupling.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "haptics/tool_motion.hpp"

namespace sulcus {

namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// A spring's pull, no stronger than its limit, and that over the stretch.
double saturated_spring(double stiffness, double limit, const Eigen::Vector3d& stretch,
                        Eigen::Vector3d& force) {
  const double length = stretch.norm();
  const double now = stiffness * length > limit ? limit / length : stiffness;
  force = now * stretch;
  return now;
}

}  // namespace

CouplingSprings::CouplingSprings(const CouplingSettings& settings, const Burr& burr)
    : stiffness_N_per_m(settings.stiffness_N_per_m),
      turning_stiffness_Nm_per_rad(settings.turning_stiffness_Nm_per_rad),
      force_limit_N(settings.force_limit_N),
      torque_limit_Nm(settings.torque_limit_Nm),
      middle_tool(0.0, 0.5 * burr.head_length_m, 0.0) {
  const Capsule& capsule = burr.capsule;
  const double to_ends_m =
      std::max((capsule.a_tool - middle_tool).norm(), (capsule.b_tool - middle_tool).norm());
  reach_m = to_ends_m + capsule.radius_m;
  const float inside_m = -burr.field.sample(burr.field.field_from_tool(middle_tool).cast<float>());
  radius_m = std::max<double>(inside_m, burr.field.spacing_m());
}

SpringPull pull(const CouplingSprings& springs, const Pose& device, const Pose& tool) noexcept {
  const Eigen::Vector3d stretch_m =
      device.point(springs.middle_tool) - tool.point(springs.middle_tool);
  const Eigen::Vector3d turn = small_turn(tool.orientation, device.orientation);
  SpringPull now;
  now.stiffness_N_per_m = saturated_spring(springs.stiffness_N_per_m, springs.force_limit_N,
                                           stretch_m, now.wrench.force_N);
  now.turning_stiffness_Nm_per_rad = saturated_spring(
      springs.turning_stiffness_Nm_per_rad, springs.torque_limit_Nm, turn, now.wrench.torque_Nm);
  return now;
}

Wrench pull_on_device(const CouplingSprings& springs, const Pose& device, const Pose& tool,
                      double reference_m) noexcept {
  const Wrench on_tool = pull(springs, device, tool).wrench;
  return about(Wrench{-on_tool.force_N, -on_tool.torque_Nm}, device.point(springs.middle_tool),
               device.point({0.0, reference_m, 0.0}));
}

Wrench about(const Wrench& wrench, const Eigen::Vector3d& from,
             const Eigen::Vector3d& to) noexcept {
  return {wrench.force_N, wrench.torque_Nm + (from - to).cross(wrench.force_N)};
}

Matrix6d about(const Matrix6d& stiffness, const Eigen::Vector3d& from,
               const Eigen::Vector3d& to) noexcept {
  // A turn r about `to` takes `from` along by r x (from - to); torques answer by the transpose.
  Matrix6d motion = Matrix6d::Identity();
  motion.topRightCorner<3, 3>() = -cross_matrix(from - to);
  return motion.transpose() * stiffness * motion;
}

Vector6d coupled_step(const SpringPull& springs, const Matrix6d& contact, const Vector6d& residual,
                      double reach_m) noexcept {
  // Turns as the way of a point at the burr's surface: all entries are then of one unit.
  Vector6d scale;
  scale << 1.0, 1.0, 1.0, 1.0 / reach_m, 1.0 / reach_m, 1.0 / reach_m;
  Matrix6d stiffness = scale.asDiagonal() * contact * scale.asDiagonal();
  Vector6d spring;
  spring.head<3>().setConstant(springs.stiffness_N_per_m);
  spring.tail<3>().setConstant(springs.turning_stiffness_Nm_per_rad / (reach_m * reach_m));
  // Nothing that is near zero or positive is touched: half the springs' own stiffness is the slack.
  Matrix6d lifted = stiffness;
  lifted.diagonal() += 0.5 * spring;
  if (Eigen::LLT<Matrix6d>(lifted).info() != Eigen::Success) {
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(stiffness);
    stiffness = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).asDiagonal() *
                solver.eigenvectors().transpose();
  }
  stiffness.diagonal() += spring;
  return scale.cwiseProduct(stiffness.llt().solve(scale.cwiseProduct(residual)));
}

StepWays ways_of(const Vector6d& step, const Eigen::Vector3d& normal, double reach_m) noexcept {
  const Eigen::Vector3d head = step.head<3>();
  const double turn_m = reach_m * step.tail<3>().norm();
  if (normal.isZero(0.0)) return {head.norm() + turn_m, 0.0};
  const double through_m = normal.dot(head);
  return {std::abs(through_m) + turn_m, (head - through_m * normal).norm()};
}

Vector6d shortened(const Vector6d& step, const Eigen::Vector3d& normal, double reach_m,
                   const StepWays& longest) noexcept {
  const StepWays ways = ways_of(step, normal, reach_m);
  const double through = std::min(1.0, longest.through_m / std::max(ways.through_m, 1e-30));
  const double along = std::min(1.0, longest.along_m / std::max(ways.along_m, 1e-30));
  Vector6d shorter = through * step;
  const Eigen::Vector3d head = step.head<3>();
  if (!normal.isZero(0.0)) {
    const Eigen::Vector3d across = normal.dot(head) * normal;
    shorter.head<3>() = through * across + along * (head - across);
  }
  return shorter;
}

double step_fraction_of_change(const CouplingSprings& springs, const Eigen::Vector3d& stretch_m,
                               const Eigen::Vector3d& step_m, const Eigen::Vector3d& before_N,
                               double most_N) noexcept {
  const auto is_within = [&](double part) {
    Eigen::Vector3d force_N;
    saturated_spring(springs.stiffness_N_per_m, springs.force_limit_N, stretch_m - part * step_m,
                     force_N);
    return (force_N - before_N).norm() <= most_N;
  };
  if (is_within(1.0)) return 1.0;
  double within = 0.0, beyond = 1.0;
  for (int halvings = 0; halvings < 30; ++halvings) {
    const double part = 0.5 * (within + beyond);
    (is_within(part) ? within : beyond) = part;
  }
  return within;
}

ForceTurn::ForceTurn(const CouplingSprings& springs, const Pose& device_before, const Pose& device,
                     const Pose& tool_before) noexcept {
  constexpr double kLeast_N = 0.05, kLargestTurn = 0.005;
  constexpr double kLeastArc = 0.25;  // of the burr's radius
  const Eigen::Vector3d from_m = device_before.point(springs.middle_tool);
  const Eigen::Vector3d stretch_m = from_m - tool_before.point(springs.middle_tool);
  const double length_m = stretch_m.norm();
  if (springs.stiffness_N_per_m * length_m < kLeast_N) return;
  felt = stretch_m / length_m;
  // Of the device's middle about the edge.
  const double arc_m = std::max(kLeastArc * springs.radius_m, springs.radius_m - length_m);
  const double tangent = kLargestTurn +
                         (device.point(springs.middle_tool) - from_m).norm() / arc_m +
                         small_turn(device_before.orientation, device.orientation).norm();
  cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
}

double step_fraction_in_cone(const Eigen::Vector3d& stretch_m, const Eigen::Vector3d& step_m,
                             const Eigen::Vector3d& axis, double cosine) noexcept {
  constexpr double kRounding = 1e-9;  // by which a stretch on the border may be outside
  const auto is_in = [&](double part) {
    const Eigen::Vector3d rest_m = stretch_m - part * step_m;
    return rest_m.dot(axis) >= (cosine - kRounding) * rest_m.norm();
  };
  if (is_in(1.0)) return 1.0;
  // (rest . axis)^2 = cosine^2 rest . rest, for part: the parts within are one interval.
  const double c2 = cosine * cosine;
  const double along = stretch_m.dot(axis), step_along = step_m.dot(axis);
  const double a = step_along * step_along - c2 * step_m.squaredNorm();
  const double b = along * step_along - c2 * stretch_m.dot(step_m);
  const double c = along * along - c2 * stretch_m.squaredNorm();
  const double root2 = b * b - a * c;
  if (a == 0.0 || root2 < 0.0) return 1.0;
  // Of the cone's two borders the one behind which the step ends, if it has passed any.
  const double root = std::sqrt(root2);
  double last = 2.0;
  for (const double part : {(b - root) / a, (b + root) / a}) {
    const bool here = along - part * step_along > 0.0;  // and not on the opposite cone
    if (here && part < 1.0 && (last > 1.0 || part > last)) last = part;
  }
  return last > 1.0 ? 1.0 : std::max(0.0, last);
}

double ForceLimits::fraction_within(const CouplingSprings& springs,
                                    const Eigen::Vector3d& stretch_m,
                                    const Eigen::Vector3d& step_m) const noexcept {
  const double change = step_fraction_of_change(springs, stretch_m, step_m, before_N, most_N);
  return change * step_fraction_in_cone(stretch_m, change * step_m, turn.felt, turn.cosine);
}

Pose moved(const Pose& tool, const Eigen::Vector3d& middle_tool, const Vector6d& step) noexcept {
  const Eigen::Vector3d half = 0.5 * step.tail<3>();
  Pose to;
  to.orientation =
      (Eigen::Quaterniond(1.0, half.x(), half.y(), half.z()) * tool.orientation).normalized();
  const Eigen::Vector3d middle = tool.point(middle_tool) + step.head<3>();
  to.position = middle - to.orientation * middle_tool;
  return to;
}

}  // namespace sulcus
