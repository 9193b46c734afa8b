#include "haptics/device/passivity.hpp"

#include <algorithm>
#include <cmath>

namespace sulcus {

namespace {

/// How many times the leak is reckoned. The pose comes in quanta of 55 um, so that where in a step
/// the device stands is not known; found by taps at 25 to 200 mm/s on 300 to 1600 N/m.
constexpr double kMargin = 1.1;
constexpr double kMarginDelayed = 2.0;

/// Work of a wrench on the device over a motion.
double work_J(const Wrench& wrench, const Twist& moved) {
  return wrench.force_N.dot(moved.linear_m_per_s) + wrench.torque_Nm.dot(moved.angular_rad_per_s);
}

bool is_zero(const PassivityState::Held& held) {
  return held.wrench.force_N.isZero(0.0) && held.wrench.torque_Nm.isZero(0.0) &&
         held.damping_N.isZero(0.0);
}

/// Energy that the simulation will have given out beyond a lossless contact when what is sent now
/// has been held, if the coming ticks move as the last one did: force and displacement go on in a
/// straight line, so the leak of each tick is that of the last.
double given_ahead_J(const Wrench& contact, const PassivitySettings& settings,
                     PassivityState& state) {
  const double now_J = work_J(contact, state.moved);
  const double before_J = work_J(state.contact, state.moved);
  const double leak_J = 0.5 * (before_J - now_J);
  const double margin = settings.delayed ? kMarginDelayed : kMargin;
  const double leak_with_margin_J = leak_J > 0.0 ? margin * leak_J : leak_J;
  // What the limits took of a force is not the contact's to give or to take.
  if (state.held.limited) {
    state.lossless_J = state.energy_J + leak_with_margin_J;
  } else {
    state.lossless_J += -0.5 * (now_J + before_J) + (leak_with_margin_J - leak_J);
  }
  const double given_J = state.lossless_J - state.energy_J;
  if (!settings.delayed) return given_J + leak_with_margin_J;
  // The coming tick holds what was sent in the last one; the one after it this force, which is one
  // and a half ticks late by then.
  const double coming_J =
      state.sent.limited ? 0.0 : work_J(state.sent.wrench, state.moved) - now_J + leak_J;
  return given_J + coming_J + 3.0 * leak_with_margin_J;
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
  if (along < 0.0) part = std::min(part, force_square / -along);
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
  state.commanded = {.wrench = wanted};
  Wrench contact = wanted;
  if (!settings.renders_torque) contact.torque_Nm.setZero();
  const double given_J = given_ahead_J(contact, settings, state);
  state.contact = contact;
  const Eigen::Vector3d& moved_m = state.moved.linear_m_per_s;
  const double square_m2 = moved_m.squaredNorm();
  const bool in_air = wanted.force_N.isZero(0.0);
  if (in_air || given_J <= 0.0 || square_m2 == 0.0) return wanted;
  // damping dx . dx over the coming tick is what was given out.
  const double damping_N_per_m =
      std::min(given_J / square_m2, settings.damping_N_s_per_m / settings.dt_s);
  state.commanded.damping_N = within(-damping_N_per_m * moved_m, wanted.force_N, settings.limit_N);
  if (state.commanded.damping_N.isZero(0.0)) return wanted;
  state.commanded.wrench.force_N += state.commanded.damping_N;
  ++state.damped_ticks;
  return state.commanded.wrench;
}

void hold_wrench(const Wrench& sent, const PassivitySettings& settings,
                 PassivityState& state) noexcept {
  const bool had_wrench = !is_zero(state.sent);
  const PassivityState::Held before = state.sent;
  state.sent = {.wrench = sent};
  state.sent.limited = sent.force_N != state.commanded.wrench.force_N;
  if (!state.sent.limited) state.sent.damping_N = state.commanded.damping_N;
  if (is_zero(state.sent)) state.lossless_J = state.energy_J;
  state.held = settings.delayed ? before : state.sent;
  if (had_wrench || is_zero(state.sent)) return;
  state.given_before_J += std::max(0.0, -state.energy_J);
  state.energy_J = 0.0;
  state.lossless_J = 0.0;
}

double PassivityState::given_out_J() const { return given_before_J + std::max(0.0, -energy_J); }

}  // namespace sulcus
