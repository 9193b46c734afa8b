#include "haptics/device/passivity.hpp"

#include <algorithm>
#include <cmath>

namespace sulcus {

namespace {

/// How many times the leak is reckoned, and at most: the pose comes in quanta of 55 um, so that
/// where in a step the device stands is not known. Found by taps at 25 to 200 mm/s on 400 to 1200
/// N/m.
constexpr double kLeakMargin = 2.0, kMostLeakMargin = 4.0;
/// Of what the damping has taken this part is not counted: poses in quanta show it so well.
constexpr double kUncounted = 0.1;
// Way of the means along it: four quanta; and over which what is overdrawn is paid.
constexpr double kWay_m = 200e-6, kRepaid_m = 300e-6;
// Of the means over ticks. That of steps also takes in a way, so that it goes on from one quantum
// to the next.
constexpr double kStepTicks = 2.0, kStepWay_m = 40e-6, kLengthTicks = 10.0;
constexpr double kLongest_m = 0.5e-3;  // of a step that is a motion, which goes on
constexpr double kStep_N = 0.015;      // of the damping, in a tick
constexpr double kLeakTicks = 2.0;     // in which what is more for a leak may come
constexpr double kFaint_N = 1e-3, kFaint_Nm = 4e-5;

/// Work of a wrench on the device over a motion.
double work_J(const Wrench& wrench, const Twist& moved) {
  return wrench.force_N.dot(moved.linear_m_per_s) + wrench.torque_Nm.dot(moved.angular_rad_per_s);
}

bool is_faint(const PassivityState::Held& held) {
  return held.wrench.force_N.norm() < kFaint_N && held.wrench.torque_Nm.norm() < kFaint_Nm;
}

/// Of the springs that a force comes through; 0: not known.
double spring_stiffness(const PassivitySettings& settings, const PassivityState& state) {
  return settings.stiffness_N_per_m > 0.0 ? settings.stiffness_N_per_m
                                          : state.trend.stiffest_N_per_m;
}

double spring_energy_J(const Eigen::Vector3d& force_N, double stiffness_N_per_m) {
  return stiffness_N_per_m > 0.0 ? 0.5 * force_N.squaredNorm() / stiffness_N_per_m : 0.0;
}

/// Takes the last step into the means.
void update_trend(const Wrench& contact, const PassivitySettings& settings, PassivityState& state) {
  PassivityState::Trend& trend = state.trend;
  const Eigen::Vector3d& step_m = state.moved.linear_m_per_s;
  const double length_m = step_m.norm();
  if (length_m > kLongest_m) return;
  trend.length_m += (length_m - trend.length_m) / kLengthTicks;
  const double ticks = kStepWay_m < kLengthTicks * trend.length_m
                           ? std::max(kStepTicks, kStepWay_m / trend.length_m)
                           : kLengthTicks;
  trend.step_m += (step_m - trend.step_m) / ticks;
  const bool in_air = contact.force_N.norm() < kFaint_N;
  if (in_air) trend.drive_N = trend.stiffest_N_per_m = trend.stiffness_N_per_m = 0.0;
  if (in_air) trend.has_stiffness = false;
  if (length_m == 0.0) return;
  const double weight = length_m / (length_m + kWay_m);
  trend.direction += weight * (step_m / length_m - trend.direction);
  if (in_air) return;
  const Eigen::Vector3d& before_N = state.contact.force_N;
  const double now_J = work_J(contact, state.moved), before_J = work_J(state.contact, state.moved);
  const double stiffness = (before_J - now_J) / (length_m * length_m);  // of a turn its part, too
  if (trend.has_stiffness) {
    trend.stiffness_N_per_m += weight * (stiffness - trend.stiffness_N_per_m);
    trend.stiffest_N_per_m = std::max(trend.stiffest_N_per_m, trend.stiffness_N_per_m);
  } else {
    trend.stiffness_N_per_m = stiffness;
    trend.has_stiffness = true;
  }
  // The trapezoid: what a sampled force leaks is not in it.
  const double given_J = 0.5 * (now_J + before_J);
  const double k = spring_stiffness(settings, state);
  const double from_springs_J = spring_energy_J(before_N, k) - spring_energy_J(contact.force_N, k);
  trend.drive_N += weight * ((given_J - from_springs_J) / length_m - trend.drive_N);
}

/// What the port has taken in beyond what is stored, once what is under way has acted, too.
double reserve_J(const Wrench& contact, const PassivitySettings& settings, PassivityState& state) {
  state.credit_J += kUncounted * state.held.damping_N.dot(state.moved.linear_m_per_s);
  const double stored = spring_energy_J(contact.force_N, spring_stiffness(settings, state));
  double reserve = state.energy_J + state.credit_J - stored;
  if (state.sent.limited && reserve < 0.0) {
    state.credit_J -= reserve;
    reserve = 0.0;
  }
  if (settings.delayed) reserve -= state.sent.wrench.force_N.dot(state.trend.step_m);
  return reserve;
}

/// What is to be damped with, before its step is limited; and that limit.
struct Damping {
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  double step_N = kStep_N;
};

Damping damping_of(double reserve, const PassivitySettings& settings, const PassivityState& state) {
  constexpr double kLeastStraight = 0.2, kStraight = 0.5;
  constexpr double kLeast_m = 1e-9;
  const PassivityState::Trend& trend = state.trend;
  const double late_ticks = settings.delayed ? 1.5 : 0.5;
  const double length_m = std::max(trend.length_m, kLeast_m);
  const double most_N_per_m = settings.damping_N_s_per_m / settings.dt_s;
  const double late_N_per_m = std::clamp(late_ticks * trend.stiffness_N_per_m, 0.0, most_N_per_m);
  const double leak_N = late_N_per_m * length_m;  // what the force is behind by

  Damping damping;
  damping.step_N = std::max(kStep_N, (kLeakMargin * leak_N - kStep_N) / kLeakTicks);
  double margin = kLeakMargin;
  if (reserve < 0.0 && leak_N > 0.0) {
    margin = std::min(kMostLeakMargin, margin - reserve / (kRepaid_m * leak_N));
  }
  damping.force_N = -std::min(most_N_per_m, margin * late_N_per_m) * trend.step_m;

  const double straight = trend.direction.norm();
  if (straight <= kLeastStraight) return damping;  // it goes to and fro
  // f^2 / (2 fall) + late length f = reserve, for the drive f that may be left.
  const double fall = damping.step_N / length_m, ahead_m = late_ticks * length_m;
  const double left_N =
      reserve > 0.0 ? fall * (std::sqrt(ahead_m * ahead_m + 2.0 * reserve / fall) - ahead_m) : 0.0;
  const double excess_N = std::max(0.0, trend.drive_N / straight - left_N);
  const double part = std::min(1.0, (straight - kLeastStraight) / (kStraight - kLeastStraight));
  damping.force_N -= part * excess_N / straight * trend.direction;
  return damping;
}

/// The largest part of `damping`, at most all, that takes the force neither beyond the limit (or
/// beyond what it is, where that is more) nor to the other side.
Eigen::Vector3d within(const Eigen::Vector3d& damping_N, const Eigen::Vector3d& force_N,
                       double limit_N) {
  const double square = damping_N.squaredNorm();
  if (square == 0.0) return Eigen::Vector3d::Zero();
  const double along = damping_N.dot(force_N);
  const double force_square = force_N.squaredNorm();
  // |force + part damping| = limit, for part.
  const double room = std::max(0.0, limit_N * limit_N - force_square);
  double part = std::min(1.0, (-along + std::sqrt(along * along + square * room)) / square);
  constexpr double kRounding = 1e-12;
  if (along < 0.0) part = std::min(part, (1.0 - kRounding) * force_square / -along);
  return std::max(0.0, part) * damping_N;
}

}  // namespace

void observe_passivity(const Pose& reference, PassivityState& state) noexcept {
  if (state.has_reference) state.moved = motion_between(state.reference, reference, 1.0, 0.0);
  state.has_reference = true;
  state.reference = reference;
  state.energy_J -= work_J(state.held.wrench, state.moved);
  state.dissipated_J -= state.held.damping_N.dot(state.moved.linear_m_per_s);
  state.least_J = std::min(state.least_J, state.energy_J);
}

Wrench control_passivity(const Wrench& wanted, const PassivitySettings& settings,
                         PassivityState& state) noexcept {
  Wrench contact = wanted;
  if (!settings.renders_torque) contact.torque_Nm.setZero();
  update_trend(contact, settings, state);
  state.contact = contact;
  const Eigen::Vector3d before_N = state.commanded.damping_N;
  state.commanded = {.wrench = wanted};
  const double reserve = reserve_J(contact, settings, state);
  if (wanted.force_N.norm() < kFaint_N) return wanted;
  const Damping damping = damping_of(reserve, settings, state);
  const Eigen::Vector3d step_N = damping.force_N - before_N;
  const double length_N = step_N.norm();
  const double part = length_N > damping.step_N ? damping.step_N / length_N : 1.0;
  state.commanded.damping_N = within(before_N + part * step_N, wanted.force_N, settings.limit_N);
  if (state.commanded.damping_N.isZero(0.0)) return wanted;
  state.commanded.wrench.force_N += state.commanded.damping_N;
  ++state.damped_ticks;
  return state.commanded.wrench;
}

void hold_wrench(const Wrench& sent, const PassivitySettings& settings,
                 PassivityState& state) noexcept {
  const bool had_wrench = !is_faint(state.sent);
  const PassivityState::Held before = state.sent;
  state.sent = {.wrench = sent};
  state.sent.limited = sent.force_N != state.commanded.wrench.force_N;
  if (!state.sent.limited) state.sent.damping_N = state.commanded.damping_N;
  state.held = settings.delayed ? before : state.sent;
  if (had_wrench || is_faint(state.sent)) return;
  state.given_before_J += std::max(0.0, -state.energy_J);
  state.energy_J = 0.0;
  state.credit_J = 0.0;
}

double PassivityState::given_out_J() const { return given_before_J + std::max(0.0, -energy_J); }

}  // namespace sulcus
