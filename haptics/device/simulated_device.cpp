#include "haptics/device/simulated_device.hpp"

#include <algorithm>
#include <cmath>

#include "haptics/tool_motion.hpp"

namespace sulcus {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

/// Of the handle's translation or of its turning: what its speed depends on. SI.
struct Dynamics {
  double inertia = 0.0;   // of device and hand
  double damping = 0.0;   // of device and hand
  double friction = 0.0;  // of the device
  double hand_damping = 0.0;
  double hand_stiffness = 0.0;
};

/// The far end of the hand's spring, seen from the handle at the start of a substep.
struct HandEnd {
  Vector3d gap;       // from the handle to it
  Vector3d velocity;  // world
};

/// Velocity after a substep h by the implicit midpoint rule: with the mean v of the velocities
/// before and after it, the gap in the middle is gap + h/2 (v_hand - v), and
///
///   inertia (v1 - v0) / h = force - damping v + k_h (gap + h/2 (v_hand - v)) + b_h v_hand
///
/// is solved for v1. Friction then takes its impulse off v1, whatever the direction, and no more
/// than there is.
Vector3d next_velocity(const Dynamics& d, const Vector3d& velocity, const HandEnd& hand,
                       const Vector3d& force, double h) noexcept {
  const double per_mean = 0.5 * d.damping + 0.25 * h * d.hand_stiffness;
  const double resisting = d.inertia / h + per_mean;
  const Vector3d driving = force + d.hand_stiffness * (hand.gap + 0.5 * h * hand.velocity) +
                           d.hand_damping * hand.velocity;
  const Vector3d next = ((d.inertia / h - per_mean) * velocity + driving) / resisting;
  const double speed = next.norm();
  const double taken = d.friction / resisting;
  if (speed <= taken) return Vector3d::Zero();
  return (1.0 - taken / speed) * next;
}

/// The inverse: what `small_turn` makes of it and of `from` is `turn`, which is 2 long at most.
Quaterniond turned(const Quaterniond& from, const Vector3d& turn) noexcept {
  Quaterniond q;
  q.vec() = 0.5 * turn;
  q.w() = std::sqrt(std::max(0.0, 1.0 - q.vec().squaredNorm()));
  return (q * from).normalized();
}

/// After a time in which it turns steadily.
Quaterniond turned_by(const Quaterniond& from, const Vector3d& angular_rad_per_s,
                      double dt_s) noexcept {
  Quaterniond rate;
  rate.w() = 0.0;
  rate.vec() = 0.5 * dt_s * angular_rad_per_s;
  Quaterniond q = from;
  q.coeffs() += (rate * from).coeffs();
  return q.normalized();
}

/// To whole multiples; 0: as it is.
Vector3d rounded(const Vector3d& value, double resolution) noexcept {
  if (resolution <= 0.0) return value;
  Vector3d multiple;
  for (int axis = 0; axis < 3; ++axis) {
    multiple[axis] = std::floor(value[axis] / resolution + 0.5) * resolution;
  }
  return multiple;
}

}  // namespace

SimulatedDevice::SimulatedDevice(const DeviceSettings& settings, const Trajectory& hand,
                                 double rate_hz, double reference_m)
    : settings_(settings),
      hand_(hand),
      dt_s_(1.0 / rate_hz),
      reference_m_(reference_m),
      start_orientation_(hand.pose_at(0.0).orientation) {
  std::stable_sort(settings_.late.begin(), settings_.late.end(),
                   [](const LateTick& a, const LateTick& b) { return a.tick < b.tick; });
  state_.position = handle_of(hand_at(0));
  state_.orientation = start_orientation_;
}

std::optional<Pose> SimulatedDevice::pose(std::uint64_t tick) noexcept {
  if (tick > 0) advance(tick);
  state_.tick = tick;
  if (settings_.delay_ticks > 0) hold(state_.next);
  for (const DeviceSilence& silence : settings_.silences) {
    if (silence.first <= tick && tick <= silence.last) return std::nullopt;
  }
  return measured(tick);
}

void SimulatedDevice::apply(const Wrench& wrench) noexcept {
  if (settings_.delay_ticks > 0) {
    state_.next = wrench;
  } else {
    hold(wrench);
  }
}

void SimulatedDevice::hold(const Wrench& wrench) noexcept {
  state_.held = wrench;
  if (state_.pushing) return;
  const double force_N = wrench.force_N.norm();
  state_.felt_ticks = force_N > kFaint_N ? state_.felt_ticks + 1 : 0;
  if (force_N > kFelt_N || static_cast<double>(state_.felt_ticks) * dt_s_ > kLasting_s) {
    state_.pushing = true;
    state_.pushing_since = state_.tick;
  }
}

Pose SimulatedDevice::hand_at(std::uint64_t tick) const noexcept {
  return hand_.pose_at(static_cast<double>(tick) * dt_s_);
}

Vector3d SimulatedDevice::handle_of(const Pose& world_from_tool) const noexcept {
  return world_from_tool.point(Vector3d(0.0, reference_m_, 0.0));
}

double SimulatedDevice::interval_before(std::uint64_t tick) const noexcept {
  double interval_s = dt_s_;
  auto late = std::lower_bound(settings_.late.begin(), settings_.late.end(), tick,
                               [](const LateTick& l, std::uint64_t t) { return l.tick < t; });
  for (; late != settings_.late.end() && late->tick == tick; ++late) interval_s += late->by_s;
  return interval_s;
}

/// Within the interval before `tick`, `part` of it gone. Like the trajectory it depends on the
/// number of ticks, not on how late they were.
double SimulatedDevice::push_N(std::uint64_t tick, double part) const noexcept {
  if (!state_.pushing) return 0.0;
  const double ticks = static_cast<double>(tick - 1 - state_.pushing_since) + part;
  const double pushing_s = ticks * dt_s_;
  const HandSettings& hand = settings_.hand;
  return pushing_s < hand.push_ramp_s ? hand.push_N * pushing_s / hand.push_ramp_s : hand.push_N;
}

/// The handle's way from the tick before to this one.
void SimulatedDevice::advance(std::uint64_t tick) noexcept {
  const HandSettings& hand = settings_.hand;
  const Dynamics translation{settings_.mass_kg + hand.mass_kg,
                             settings_.damping_N_s_per_m + hand.damping_N_s_per_m,
                             settings_.friction_N, hand.damping_N_s_per_m, hand.stiffness_N_per_m};
  const Dynamics turning{settings_.inertia_kg_m2,
                         settings_.turning_damping_Nm_s_per_rad + hand.turning_damping_Nm_s_per_rad,
                         settings_.turning_friction_Nm, hand.turning_damping_Nm_s_per_rad,
                         hand.turning_stiffness_Nm_per_rad};
  const bool turns = settings_.inertia_kg_m2 > 0.0;

  const Pose from = hand_at(tick - 1), to = hand_at(tick);
  const Vector3d from_handle = handle_of(from);
  const Vector3d way = handle_of(to) - from_handle;
  const Vector3d turn = small_turn(from.orientation, to.orientation);
  const double interval_s = interval_before(tick);
  // A tick of whole substeps is not to be cut once more for a bit of rounding.
  const int substeps = std::max(1, 1 + static_cast<int>(interval_s / kSubstep_s - 1e-6));
  const double h = interval_s / substeps;
  for (int i = 0; i < substeps; ++i) {
    const double part = static_cast<double>(i) / substeps;
    const Vector3d force =
        state_.held.force_N + push_N(tick, (i + 0.5) / substeps) * hand.push_direction;
    const HandEnd end{from_handle + part * way - state_.position, way / interval_s};
    const Vector3d velocity = next_velocity(translation, state_.velocity_m_per_s, end, force, h);
    state_.position += 0.5 * h * (state_.velocity_m_per_s + velocity);
    state_.velocity_m_per_s = velocity;
    if (!turns) continue;
    const Quaterniond hand_orientation = turned(from.orientation, part * turn);
    const HandEnd hand_turn{small_turn(state_.orientation, hand_orientation), turn / interval_s};
    const Vector3d angular =
        next_velocity(turning, state_.angular_rad_per_s, hand_turn, state_.held.torque_Nm, h);
    state_.orientation =
        turned_by(state_.orientation, 0.5 * (state_.angular_rad_per_s + angular), h);
    state_.angular_rad_per_s = angular;
  }
  if (!turns) {
    state_.orientation = to.orientation;
    state_.angular_rad_per_s = turn / interval_s;
  }
}

Pose SimulatedDevice::measured(std::uint64_t tick) const noexcept {
  Vector3d handle = rounded(state_.position, settings_.resolution_m);
  for (const DeviceJump& jump : settings_.jumps) {
    if (jump.tick <= tick) handle += jump.by_m;
  }
  Pose pose;
  pose.orientation = state_.orientation;
  if (settings_.inertia_kg_m2 > 0.0 && settings_.angle_resolution > 0.0) {
    pose.orientation = turned(
        start_orientation_,
        rounded(small_turn(start_orientation_, state_.orientation), settings_.angle_resolution));
  }
  pose.position = handle - pose.direction(Vector3d(0.0, reference_m_, 0.0));
  return pose;
}

}  // namespace sulcus
