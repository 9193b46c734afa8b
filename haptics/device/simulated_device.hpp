#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/scene/scene.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/device/device.hpp"

namespace sulcus {

/// All that a simulated device carries from tick to tick: the handle as it is, not as it is read.
struct SimulatedDeviceState {
  std::uint64_t tick = 0;                                           // of the last pose
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m, of the handle, world
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();       // world
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // world from tool
  Eigen::Vector3d angular_rad_per_s = Eigen::Vector3d::Zero();      // world
  Wrench held;                      // acts on the handle until the next pose
  Wrench next;                      // with a delay: is held from the next pose on
  std::uint64_t felt_ticks = 0;     // on end that a faint force has been held, up to now
  bool pushing = false;             // the hand has felt a force
  std::uint64_t pushing_since = 0;  // tick from which that force was held
};

/// A haptic device and the hand on it, in a closed loop with the force that is rendered:
///
///   (m + m_h) x'' + (b + b_h) x' + k_h (x - x_hand) - b_h x_hand' + friction = push + force
///
/// x is the handle, the point `reference_m` from the tip along the tool's +y; m, b and friction are
/// the device's, m_h, b_h and k_h the hand's, whose far end x_hand goes along the trajectory in a
/// straight line from tick to tick. The force is held over the tick. Where the device has an
/// inertia, the same equation turns the handle; else its orientation is the trajectory's.
///
/// Integrated at `kSubstep_s` by the implicit midpoint rule, which is stable for every mass,
/// damping and stiffness and exact for a mass under the force held. Friction is a clamp: it takes
/// speed away until the handle rests, and holds it there against less than itself.
///
/// Ticks are asked for in their order, from 0. The trajectory's time is tick / rate, however late a
/// tick was; what was held before a late tick acts for so much longer. Bits repeat exactly.
class SimulatedDevice final : public Device {
 public:
  static constexpr double kSubstep_s = 25e-6;  // at most; a tick is cut into equal ones
  // A force sets the hand pushing from here on at once, a fainter one when it has lasted: a hand
  // that comes to rest on a surface feels that. Below that there is the rest of a coupling's in
  // air.
  static constexpr double kFelt_N = 0.01, kFaint_N = 1e-3, kLasting_s = 0.1;

  /// `hand`: where the hand wants the burr's tip. It must outlive this. The handle starts at rest
  /// where the trajectory starts.
  SimulatedDevice(const DeviceSettings& settings, const Trajectory& hand, double rate_hz,
                  double reference_m);

  /// Moves the handle on by one tick, then reads it: its position at the encoders' resolution in
  /// each world axis, and of its orientation the turn since the trajectory's start, as twice the
  /// vector part of its quaternion. None within a silence, in which the handle moves on under what
  /// was applied last.
  std::optional<Pose> pose(std::uint64_t tick) noexcept override;
  /// Torque is about the handle. Limits are not looked after here.
  void apply(const Wrench& wrench) noexcept override;

  const SimulatedDeviceState& state() const noexcept { return state_; }
  /// Goes on from a state that a device of the same settings had.
  void set_state(const SimulatedDeviceState& state) noexcept { state_ = state; }

 private:
  Pose hand_at(std::uint64_t tick) const noexcept;
  Eigen::Vector3d handle_of(const Pose& world_from_tool) const noexcept;
  void hold(const Wrench& wrench) noexcept;
  void advance(std::uint64_t tick) noexcept;
  double interval_before(std::uint64_t tick) const noexcept;
  double push_N(std::uint64_t tick, double part) const noexcept;
  Pose measured(std::uint64_t tick) const noexcept;

  DeviceSettings settings_;  // late ticks in their order
  const Trajectory& hand_;
  double dt_s_;
  double reference_m_;
  Eigen::Quaterniond start_orientation_;
  SimulatedDeviceState state_;
};

}  // namespace sulcus
