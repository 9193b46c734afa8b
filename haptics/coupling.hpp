#pragma once

#include <algorithm>
#include <cstdint>

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"
#include "haptics/contact/contact.hpp"

namespace sulcus {

/// The springs between the device and the tool, attached in the middle of the burr's head, where
/// what it touches has the shortest arms.
struct CouplingSprings {
  CouplingSprings(const CouplingSettings& settings, const Burr& burr);

  double stiffness_N_per_m, turning_stiffness_Nm_per_rad;
  double force_limit_N, torque_limit_Nm;
  Eigen::Vector3d middle_tool;  // where they are attached
  double reach_m;               // of the burr's surface from there, at most
  double radius_m;              // from there to its nearest point
};

/// What the springs do to the tool: force and torque about its middle, world axes; no more than
/// the limits, whatever the stretch. Their stiffnesses are then force over stretch.
struct SpringPull {
  Wrench wrench;
  double stiffness_N_per_m, turning_stiffness_Nm_per_rad;
};
SpringPull pull(const CouplingSprings& springs, const Pose& device, const Pose& tool) noexcept;

/// What they do to the device: the opposite, the torque about its torque reference, `reference_m`
/// from the tip.
Wrench pull_on_device(const CouplingSprings& springs, const Pose& device, const Pose& tool,
                      double reference_m) noexcept;

/// A wrench, and a stiffness, about the point `to` (world) instead of `from`.
Wrench about(const Wrench& wrench, const Eigen::Vector3d& from, const Eigen::Vector3d& to) noexcept;
Matrix6d about(const Matrix6d& stiffness, const Eigen::Vector3d& from,
               const Eigen::Vector3d& to) noexcept;

/// One Newton step for a tool between springs and contact: (springs + contact) step = residual,
/// translation of the middle and turn about it. The springs regularise what the contact leaves
/// free; a contact that gives way the further it is pushed counts as none there (its stiffness'
/// negative eigenvalues, turns measured at `reach_m`, are taken as zero).
Vector6d coupled_step(const SpringPull& springs, const Matrix6d& contact, const Vector6d& residual,
                      double reach_m) noexcept;

/// The tool moved: its middle by step.head, turned about it by step.tail (rad, small).
Pose moved(const Pose& tool, const Eigen::Vector3d& middle_tool, const Vector6d& step) noexcept;

/// How far a point of the burr moves at most.
inline double max_displacement(const Vector6d& step, double reach_m) noexcept {
  return step.head<3>().norm() + reach_m * step.tail<3>().norm();
}

/// The longest part of a step, all of it at most, with which a tool whose middle has gone `gone_m`
/// in this tick does not go beyond `longest_m`.
double step_fraction_within(const Eigen::Vector3d& gone_m, const Eigen::Vector3d& step_m,
                            double longest_m) noexcept;

struct CoupledResult {
  ContactResult contact;  // where the tool is
  int evaluations = 0;    // of the contact
  bool balanced = false;  // else it goes on in the next tick
  bool lags = false;      // in contact, and the device went further than its steps can
};

/// Limit of how far the force may turn in one tick: by the turn of the contact normal when the
/// burr rolls over a sharp edge, which is the fastest on a convex solid, and 0.3 degrees more. A
/// force below 0.05 N has no limit.
struct ForceTurn {
  ForceTurn(const CouplingSprings& springs, const Pose& device_before, const Pose& device,
            const Pose& tool_before) noexcept;

  Eigen::Vector3d felt = Eigen::Vector3d::Zero();  // unit: from tool to device in the last tick
  double cosine = -1.0;                            // of the angle to it, at least
};

/// The longest part of a step, all of it at most, that leaves the stretch, device from tool, within
/// an angle of `axis` (unit), whose cosine is given. Outside of that: none of a step that leads
/// away from there, all of one that leads there or never comes near.
double step_fraction_in_cone(const Eigen::Vector3d& stretch_m, const Eigen::Vector3d& step_m,
                             const Eigen::Vector3d& axis, double cosine) noexcept;

/// Takes the tool towards where springs and contact balance: a quasi-static virtual coupling [Wan
/// and McNeely 2003; Barbic and James 2008]. We iterate where they take one linear step, so that a
/// contact hundreds of times as stiff as the springs is met without crossing it:
///
///  - Newton steps with the contact's own stiffness; the springs regularise.
///  - In contact a step takes no point of the burr further than half a voxel; in free space no
///    further than `free_distance`, so that nothing is crossed without being felt, at any speed.
///  - In a tick the tool goes no further than the device has gone since `device_before`, and what
///    changes the springs' force by kLargestChange_N, and what changes it by nothing while they are
///    at their limit: when the tool slips off an edge the force falls over ticks, not in one.
///  - Nor does it turn the force further than `ForceTurn` has it: from one row of an edge's voxels
///    to the next the force goes steadily.
///  - If the residual reverses and grows after a step, one secant iteration shortens that step.
///  - Ends within kClose_m of where it would go and kForceTolerance of its force, or when the
///  evaluations
///    or the contacts of a tick are used up, counted and never timed; the next tick goes on from
///    there.
///
/// It has no state but the tool's pose. `evaluate(pose) -> ContactResult` with stiffness, wrench
/// about the torque reference; what its last call left is the contact where the tool ends.
/// `free_distance(pose, wanted_m) -> m`: how far any point of a burr without contact can go for
/// certain.
template <class Evaluate, class FreeDistance>
CoupledResult couple(const CouplingSprings& springs, const CouplingSettings& settings,
                     double reference_m, double longest_step_m, const Pose& device_before,
                     const Pose& device, Pose& tool, const Evaluate& evaluate,
                     const FreeDistance& free_distance) noexcept {
  constexpr double kClose_m = 0.5e-6;
  constexpr double kForceTolerance_N = 5e-3,
                   kForceTolerance = 0.01;  // of what the springs pull with
  constexpr int kFreeEvaluations = 16;      // without contact they cost little
  constexpr double kLargestChange_N = 0.15;
  const ForceTurn turn(springs, device_before, device, tool);
  const Eigen::Vector3d begin = tool.point(springs.middle_tool);
  const double device_way_m = (device.position - device_before.position).norm();
  const double beyond_limit_m = (device.point(springs.middle_tool) - begin).norm() -
                                springs.force_limit_N / springs.stiffness_N_per_m;
  const double longest_way_m =
      device_way_m + std::max(0.0, beyond_limit_m) + kLargestChange_N / springs.stiffness_N_per_m;
  CoupledResult result;
  Pose from = tool;                            // where the last step began
  Vector6d residual_there = Vector6d::Zero();  // and what drove it
  Vector6d step = Vector6d::Zero();
  std::uint64_t touched = 0;
  for (int free = 0;;) {
    result.contact = evaluate(tool);
    ++result.evaluations;
    const bool touching = result.contact.contacts > 0;
    touched += result.contact.contacts;
    free += touching ? 0 : 1;

    const Eigen::Vector3d middle = tool.point(springs.middle_tool);
    const Eigen::Vector3d reference = tool.point({0.0, reference_m, 0.0});
    const SpringPull springs_now = pull(springs, device, tool);
    const Wrench contact = about(result.contact.wrench, reference, middle);
    Vector6d residual;
    residual << springs_now.wrench.force_N + contact.force_N,
        springs_now.wrench.torque_Nm + contact.torque_Nm;

    if (!residual.allFinite()) break;  // the caller sees it in the contact
    // One step there always is: a tool that cannot move leaves the hand with the force it had.
    const bool used_up =
        touched + result.contact.contacts > static_cast<std::uint64_t>(settings.contacts_per_tick);
    if (result.evaluations - free >= settings.evaluations || free >= kFreeEvaluations ||
        (used_up && result.evaluations > 1)) {
      const int steps = result.evaluations - free - 1;
      if (touching && device_way_m > steps * longest_step_m) {
        const Matrix6d stiffness = about(result.contact.stiffness, reference, middle);
        step = coupled_step(springs_now, stiffness, residual, springs.reach_m);
        result.lags = max_displacement(step, springs.reach_m) > longest_step_m;
      }
      break;
    }
    if (result.evaluations > 1) {
      const double before = residual_there.dot(step), after = residual.dot(step);
      if (after < 0.0 && -after > before && before > 0.0) {
        step *= before / (before - after);
        tool = moved(from, springs.middle_tool, step);
        continue;
      }
    }
    const Matrix6d stiffness = about(result.contact.stiffness, reference, middle);
    step = coupled_step(springs_now, stiffness, residual, springs.reach_m);
    const double way_m = max_displacement(step, springs.reach_m);
    const double tolerance_N =
        std::max(kForceTolerance_N, kForceTolerance * springs_now.wrench.force_N.norm());
    if (way_m <= kClose_m && residual.head<3>().norm() <= tolerance_N) {
      result.balanced = true;
      break;
    }
    const double longest_m = touching || way_m <= longest_step_m
                                 ? longest_step_m
                                 : std::max(longest_step_m, free_distance(tool, way_m));
    if (way_m > longest_m) step *= longest_m / way_m;
    step *= step_fraction_within(middle - begin, step.head<3>(), longest_way_m);
    step *= step_fraction_in_cone(device.point(springs.middle_tool) - middle, step.head<3>(),
                                  turn.felt, turn.cosine);
    if (max_displacement(step, springs.reach_m) == 0.0) break;  // as far as it may go in this tick
    from = tool;
    residual_there = residual;
    tool = moved(from, springs.middle_tool, step);
  }
  return result;
}

}  // namespace sulcus
