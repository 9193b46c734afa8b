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

/// The longest part of a step of the tool's middle, all of it at most, with which the springs'
/// force is no further than `most_N` from `before_N`; `stretch_m`: from tool to device before the
/// step.
double step_fraction_of_change(const CouplingSprings& springs, const Eigen::Vector3d& stretch_m,
                               const Eigen::Vector3d& step_m, const Eigen::Vector3d& before_N,
                               double most_N) noexcept;

/// What a step does to the contact: into it or out of it, turns too, as the way of a point at the
/// burr's surface; and along it.
struct StepWays {
  double through_m, along_m;
};
/// In contact with a surface across `normal` (unit, or zero: every way leads through it).
StepWays ways_of(const Vector6d& step, const Eigen::Vector3d& normal, double reach_m) noexcept;

/// The step with each of the two shortened to its limit.
Vector6d shortened(const Vector6d& step, const Eigen::Vector3d& normal, double reach_m,
                   const StepWays& longest) noexcept;

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

/// How far the springs' force may go in one tick: `most_N` from what it was, `before_N`, and in
/// its direction as `turn` says.
struct ForceLimits {
  Eigen::Vector3d before_N;
  double most_N;
  ForceTurn turn;

  /// The longest part of a step of the tool's middle, all of it at most, within both limits.
  double fraction_within(const CouplingSprings& springs, const Eigen::Vector3d& stretch_m,
                         const Eigen::Vector3d& step_m) const noexcept;
};

/// Takes the tool towards where springs and contact balance: a quasi-static virtual coupling [Wan
/// and McNeely 2003; Barbic and James 2008]. We iterate where they take one linear step, so that a
/// contact hundreds of times as stiff as the springs is met without crossing it:
///
///  - Newton steps with the contact's own stiffness; the springs regularise.
///  - In contact a step takes no point of the burr further than half a voxel into a surface or out
///    of it; along it, half the burr's radius: then the contact is looked at, and where it has
///    become deeper by more than half a voxel the step ends before what it met. In free space a
///    step is no longer than `free_distance`. So nothing is crossed without being felt, at any
///    speed.
///  - In a tick the springs' force changes by no more than the device's way makes of it, and
///    kLargestChange_N: when the tool slips off an edge the force falls over ticks, not in one.
///  - Nor does it turn the force further than `ForceTurn` has it: from one row of an edge's voxels
///    to the next the force goes steadily.
///  - Where these two shorten a step, its part through the surface still goes on, as far as they
///    allow. Else a tool that slides, a little in each tick, would hang above the surface
///    meanwhile, and the hand would feel a press on nothing.
///  - If the residual reverses and grows after a step, one secant iteration shortens that step.
///  - Where a long step along a surface has left it, though the springs pull towards it, and the
///    limits allow no step back, the step is halved until it ends in contact, or is no longer than
///    half a voxel.
///  - Ends within kClose_m of where it would go and kForceTolerance of its force, or when the
///    evaluations or the contacts of a tick are used up, counted and never timed. The next tick
///    goes on from there.
///
/// It has no state but the tool's pose. `evaluate(pose) -> ContactResult` with stiffness, wrench
/// about the torque reference; what its last call left is the contact where the tool ends.
/// `free_distance(pose, wanted_m) -> m`: how far any point of a burr without contact can go for
/// certain.
template <class Evaluate, class FreeDistance>
class Coupling {
 public:
  Coupling(const CouplingSprings& springs, const CouplingSettings& settings, double reference_m,
           double longest_step_m, const Evaluate& evaluate,
           const FreeDistance& free_distance) noexcept
      : springs_(springs),
        settings_(settings),
        reference_m_(reference_m),
        longest_{longest_step_m, std::max(longest_step_m, 0.5 * springs.radius_m)},
        evaluate_(evaluate),
        free_distance_(free_distance) {}

  /// Takes `tool` on by a tick.
  CoupledResult couple(const Pose& device_before, const Pose& device, Pose& tool) noexcept;

 private:
  static constexpr double kClose_m = 0.5e-6;
  static constexpr double kForceTolerance_N = 5e-3;
  static constexpr double kForceTolerance = 0.01;  // of what the springs pull with
  static constexpr int kFreeEvaluations = 16;      // without contact they cost little
  static constexpr double kLargestChange_N = 0.15;

  /// A pose of the tool, and what pulls it there.
  struct Look {
    Pose tool;
    SpringPull pull;
    Vector6d residual;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of the whole contact; zero without
    double deepest_m;
  };
  Look look(const Pose& device, const Pose& tool) noexcept;
  Vector6d newton_step(const Look& at) const noexcept;
  bool is_used_up() const noexcept;
  bool is_balanced(const Look& at, const Vector6d& step) const noexcept;
  /// What of a step the surfaces allow.
  Vector6d allowed(const Look& at, const Vector6d& step) noexcept;
  /// What of a step the limits of the springs' force allow.
  Vector6d limited(const Look& at, const Eigen::Vector3d& target, const Vector6d& step,
                   const ForceLimits& limits) const noexcept;
  /// The parts of the last step that it should have been: what it may go where it met what rises
  /// from the surface; and a secant, where the residual has reversed and grown. 1 where it was
  /// well.
  double part_to_what_it_met(const Look& before, const Look& at,
                             const Vector6d& step) const noexcept;
  static double secant(const Look& before, const Look& at, const Vector6d& step) noexcept;
  /// A step and where it began.
  struct Move {
    Look from;
    Vector6d step = Vector6d::Zero();
  };
  /// Whether the last step that began in contact left the surface that the springs pull towards.
  bool has_left(const Move& contact, const Look& at) const noexcept;

  const CouplingSprings& springs_;
  const CouplingSettings& settings_;
  double reference_m_;
  StepWays longest_;
  const Evaluate& evaluate_;
  const FreeDistance& free_distance_;
  CoupledResult result_;
  int free_ = 0;               // evaluations without contact
  std::uint64_t touched_ = 0;  // contacts of all evaluations
};

template <class Evaluate, class FreeDistance>
auto Coupling<Evaluate, FreeDistance>::look(const Pose& device, const Pose& tool) noexcept -> Look {
  ContactResult& contact = result_.contact = evaluate_(tool);
  ++result_.evaluations;
  touched_ += contact.contacts;
  free_ += contact.contacts > 0 ? 0 : 1;
  const Eigen::Vector3d middle = tool.point(springs_.middle_tool);
  const Wrench at_middle = about(contact.wrench, tool.point({0.0, reference_m_, 0.0}), middle);
  Look at{tool, pull(springs_, device, tool), {}, Eigen::Vector3d::Zero(), contact.deepest_m};
  at.residual << at.pull.wrench.force_N + at_middle.force_N,
      at.pull.wrench.torque_Nm + at_middle.torque_Nm;
  const Eigen::Vector3d normal_N = contact.wrench.force_N - contact.tangential.force_N;
  if (const double size_N = normal_N.norm(); size_N > 0.0) at.normal = normal_N / size_N;
  return at;
}

template <class Evaluate, class FreeDistance>
Vector6d Coupling<Evaluate, FreeDistance>::newton_step(const Look& at) const noexcept {
  const Matrix6d stiffness =
      about(result_.contact.stiffness, at.tool.point({0.0, reference_m_, 0.0}),
            at.tool.point(springs_.middle_tool));
  return coupled_step(at.pull, stiffness, at.residual, springs_.reach_m);
}

template <class Evaluate, class FreeDistance>
bool Coupling<Evaluate, FreeDistance>::is_used_up() const noexcept {
  // One step there always is: a tool that cannot move leaves the hand with the force it had.
  const bool many =
      touched_ + result_.contact.contacts > static_cast<std::uint64_t>(settings_.contacts_per_tick);
  return result_.evaluations - free_ >= settings_.evaluations || free_ >= kFreeEvaluations ||
         (many && result_.evaluations > 1);
}

template <class Evaluate, class FreeDistance>
bool Coupling<Evaluate, FreeDistance>::is_balanced(const Look& at,
                                                   const Vector6d& step) const noexcept {
  const double tolerance_N =
      std::max(kForceTolerance_N, kForceTolerance * at.pull.wrench.force_N.norm());
  return max_displacement(step, springs_.reach_m) <= kClose_m &&
         at.residual.template head<3>().norm() <= tolerance_N;
}

template <class Evaluate, class FreeDistance>
Vector6d Coupling<Evaluate, FreeDistance>::allowed(const Look& at, const Vector6d& step) noexcept {
  if (result_.contact.contacts > 0) {
    // What a long way along the surface meets has to be seen, and the tool to come back from it.
    const bool sees = result_.evaluations - free_ + 2 <= settings_.evaluations;
    return shortened(step, at.normal, springs_.reach_m,
                     {longest_.through_m, sees ? longest_.along_m : longest_.through_m});
  }
  const double way_m = max_displacement(step, springs_.reach_m);
  if (way_m <= longest_.through_m) return step;
  const double longest_m = std::max(longest_.through_m, free_distance_(at.tool, way_m));
  return way_m > longest_m ? Vector6d(longest_m / way_m * step) : step;
}

template <class Evaluate, class FreeDistance>
Vector6d Coupling<Evaluate, FreeDistance>::limited(const Look& at, const Eigen::Vector3d& target,
                                                   const Vector6d& step,
                                                   const ForceLimits& limits) const noexcept {
  const Eigen::Vector3d stretch_m = target - at.tool.point(springs_.middle_tool);
  const double whole = limits.fraction_within(springs_, stretch_m, step.template head<3>());
  if (whole == 1.0 || at.normal.isZero(0.0)) return whole * step;
  const Vector6d first = whole * step;
  Vector6d through = step - first;
  through.template head<3>() = at.normal.dot(through.template head<3>()) * at.normal;
  return first + limits.fraction_within(springs_, stretch_m - first.template head<3>(),
                                        through.template head<3>()) *
                     through;
}

template <class Evaluate, class FreeDistance>
double Coupling<Evaluate, FreeDistance>::part_to_what_it_met(const Look& before, const Look& at,
                                                             const Vector6d& step) const noexcept {
  const double along_m = ways_of(step, before.normal, springs_.reach_m).along_m;
  const double deeper_m = at.deepest_m - before.deepest_m;
  if (along_m <= longest_.through_m || deeper_m <= longest_.through_m) return 1.0;
  return std::max(longest_.through_m, along_m - deeper_m) / along_m;
}

template <class Evaluate, class FreeDistance>
double Coupling<Evaluate, FreeDistance>::secant(const Look& before, const Look& at,
                                                const Vector6d& step) noexcept {
  const double drove = before.residual.dot(step), drives = at.residual.dot(step);
  return drives < 0.0 && -drives > drove && drove > 0.0 ? drove / (drove - drives) : 1.0;
}

template <class Evaluate, class FreeDistance>
bool Coupling<Evaluate, FreeDistance>::has_left(const Move& contact,
                                                const Look& at) const noexcept {
  const Eigen::Vector3d& normal = contact.from.normal;
  return result_.contact.contacts == 0 && free_ < kFreeEvaluations &&
         at.residual.template head<3>().dot(normal) < 0.0 &&
         ways_of(contact.step, normal, springs_.reach_m).along_m > longest_.through_m;
}

template <class Evaluate, class FreeDistance>
CoupledResult Coupling<Evaluate, FreeDistance>::couple(const Pose& device_before,
                                                       const Pose& device, Pose& tool) noexcept {
  const Eigen::Vector3d target = device.point(springs_.middle_tool);
  const double device_way_m = (target - device_before.point(springs_.middle_tool)).norm();
  const ForceLimits limits{pull(springs_, device_before, tool).wrench.force_N,
                           kLargestChange_N + springs_.stiffness_N_per_m * device_way_m,
                           ForceTurn(springs_, device_before, device, tool)};
  Move last{}, contact{};  // contact: the last that began in contact
  bool corrected = false;  // the last, to what it met
  const auto move = [&](const Look& from, const Vector6d& step) {
    last = {from, step};
    if (!from.normal.isZero(0.0)) contact = last;
    tool = moved(from.tool, springs_.middle_tool, step);
  };
  for (;;) {
    const Look at = look(device, tool);
    if (!at.residual.allFinite()) break;  // the caller sees it in the contact
    const bool touching = result_.contact.contacts > 0;
    if (is_used_up()) {
      const int steps = result_.evaluations - free_ - 1;
      if (touching && device_way_m > steps * longest_.through_m) {
        const StepWays left = ways_of(newton_step(at), at.normal, springs_.reach_m);
        result_.lags = left.through_m > longest_.through_m || left.along_m > longest_.along_m;
      }
      break;
    }
    if (result_.evaluations > 1 && !corrected) {
      double part = part_to_what_it_met(last.from, at, last.step);
      corrected = part < 1.0;
      if (!corrected) part = secant(last.from, at, last.step);
      if (part < 1.0) {
        move(last.from, part * last.step);
        continue;
      }
    }
    corrected = false;
    const Vector6d wanted = newton_step(at);
    if (is_balanced(at, wanted)) {
      result_.balanced = true;
      break;
    }
    const Vector6d step = limited(at, target, allowed(at, wanted), limits);
    if (max_displacement(step, springs_.reach_m) > 0.0) {
      move(at, step);
    } else if (has_left(contact, at)) {
      move(contact.from, 0.5 * contact.step);
    } else {
      break;  // as far as it may go in this tick
    }
  }
  return result_;
}

/// Coupling::couple.
template <class Evaluate, class FreeDistance>
CoupledResult couple(const CouplingSprings& springs, const CouplingSettings& settings,
                     double reference_m, double longest_step_m, const Pose& device_before,
                     const Pose& device, Pose& tool, const Evaluate& evaluate,
                     const FreeDistance& free_distance) noexcept {
  return Coupling<Evaluate, FreeDistance>(springs, settings, reference_m, longest_step_m, evaluate,
                                          free_distance)
      .couple(device_before, device, tool);
}

}  // namespace sulcus
