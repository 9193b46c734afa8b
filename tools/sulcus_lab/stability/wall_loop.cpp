#include "tools/sulcus_lab/stability/wall_loop.hpp"

#include <cmath>
#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <unsupported/Eigen/MatrixFunctions>

#include "engine/scene/device_presets.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/device/simulated_device.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr double kLeast = 10.0, kMost = 1e7;  // N/m, of the walls that are tried
constexpr double kRatio = 1.5;  // from one to the next, upward, until one is not stable

/// The largest K up to which `stable(K)` holds, within `within` of it.
template <class Stable>
double largest_stable(double within, const Stable& stable) {
  if (!stable(kLeast)) return 0.0;
  double low = kLeast, high = kRatio * kLeast;
  for (; stable(high); high *= kRatio) {
    if (high > kMost) return HUGE_VAL;
    low = high;
  }
  while (high - low > within * low) {
    const double middle = 0.5 * (low + high);
    (stable(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The wall as a force upward on a tip that has gone `depth_m` below its face.
double wall_force_N(const WallLoop& loop, double stiffness_N_per_m, double depth_m,
                    double last_depth_m) {
  if (depth_m <= 0.0) return 0.0;
  const double speed_m_per_s = (depth_m - last_depth_m) * loop.rate_hz;
  return stiffness_N_per_m * depth_m + loop.wall_damping_N_s_per_m * speed_m_per_s;
}

/// Whether SimulatedDevice comes to rest on the wall: by quarters of the run, the deviation from
/// the equilibrium (root mean square) has all but vanished, or is smaller in the last quarter than
/// in the one before. So late a slow mode that dies away does not hide a fast one that grows.
bool comes_to_rest(const WallLoop& loop, double stiffness_N_per_m) {
  constexpr double kPush_N = 1.0;
  constexpr double kReference_m = 40e-3;
  constexpr double kStartOff = 1e-3;  // of the depth that holds the push
  constexpr double kGrown = 100.0;    // times what it was at the start
  constexpr double kVanished = 1e-4;  // the same; well above the bits of the positions
  constexpr double kRun_s = 20.0;

  DeviceSettings device;  // without faults
  device.mass_kg = loop.device.mass_kg;
  device.damping_N_s_per_m = loop.device.damping_N_s_per_m;
  device.delay_ticks = loop.device.delay_ticks;
  device.hand = loop.device.hand;
  device.friction_N = 0.0;
  device.resolution_m = 0.0;
  device.hand.push_N = kPush_N;
  device.hand.push_direction = -Vector3d::UnitZ();
  device.hand.push_ramp_s = 0.0;  // all of it with the first force of the wall
  Pose start;
  start.orientation = orientation_along(Vector3d::UnitZ());
  const Trajectory trajectory({{0.0, start}});
  SimulatedDevice simulated(device, trajectory, loop.rate_hz, kReference_m);

  // The wall's face lies so high over the start, where the hand's spring rests.
  const double start_m = (1.0 + kStartOff) * kPush_N / stiffness_N_per_m;
  const double hand_stiffness = device.hand.stiffness_N_per_m;
  const double rest_m = (kPush_N + hand_stiffness * start_m) / (stiffness_N_per_m + hand_stiffness);
  const double start_off_m = start_m - rest_m;

  const auto quarter = static_cast<std::uint64_t>(kRun_s / 4.0 * loop.rate_hz);
  std::uint64_t tick = 0;
  double last_depth_m = start_m;
  double before_m = 0.0, off_m = 0.0;  // root mean square deviations, last quarter but one and last
  for (std::uint64_t end = quarter; end <= 4 * quarter; end += quarter) {
    double squares = 0.0;
    for (; tick < end; ++tick) {
      const double depth_m = start_m - simulated.pose(tick)->position.z();
      const double force_N = wall_force_N(loop, stiffness_N_per_m, depth_m, last_depth_m);
      simulated.apply({force_N * Vector3d::UnitZ(), Vector3d::Zero()});
      last_depth_m = depth_m;
      const double deviation_m = depth_m - rest_m;
      if (std::abs(deviation_m) > kGrown * start_off_m) return false;
      squares += deviation_m * deviation_m;
    }
    before_m = off_m;
    off_m = std::sqrt(squares / static_cast<double>(quarter));
    if (off_m < kVanished * start_off_m) return true;
  }
  return off_m < before_m;
}

}  // namespace

double spectral_radius(const WallLoop& loop, double stiffness_N_per_m) {
  const DeviceSettings& device = loop.device;
  const double mass_kg = device.mass_kg + device.hand.mass_kg;
  const double damping = device.damping_N_s_per_m + device.hand.damping_N_s_per_m;
  const double dt_s = 1.0 / loop.rate_hz;

  // d/dt (x, v, u) with the force u held; its exponential carries all three over the tick.
  Eigen::Matrix3d rate = Eigen::Matrix3d::Zero();
  rate(0, 1) = 1.0;
  rate.row(1) << -device.hand.stiffness_N_per_m / mass_kg, -damping / mass_kg, 1.0 / mass_kg;
  const Eigen::Matrix3d carry = (rate * dt_s).exp();

  // u = law . (x, last x).
  const double per_difference = loop.wall_damping_N_s_per_m / dt_s;
  const Eigen::RowVector2d law(-stiffness_N_per_m - per_difference, per_difference);
  Eigen::Matrix4d step = Eigen::Matrix4d::Zero();  // of (x, v, last x, force on its way)
  step.topLeftCorner<2, 2>() = carry.topLeftCorner<2, 2>();
  step(2, 0) = 1.0;
  step(3, 0) = law[0];
  step(3, 2) = law[1];
  const Eigen::Vector2d by_force = carry.topRightCorner<2, 1>();
  if (device.delay_ticks > 0) {
    step.topRightCorner<2, 1>() = by_force;
  } else {
    step.block<2, 1>(0, 0) += by_force * law[0];
    step.block<2, 1>(0, 2) += by_force * law[1];
  }
  return Eigen::EigenSolver<Eigen::Matrix4d>(step, false).eigenvalues().cwiseAbs().maxCoeff();
}

double spectral_limit(const WallLoop& loop) {
  return largest_stable(1e-9, [&](double k) { return spectral_radius(loop, k) <= 1.0; });
}

double measured_limit(const WallLoop& loop) {
  return largest_stable(kMeasuredWithin, [&](double k) { return comes_to_rest(loop, k); });
}

double delay_rule(const WallLoop& loop) {
  const DeviceSettings& device = loop.device;
  const double damping = device.damping_N_s_per_m + device.hand.damping_N_s_per_m;
  const double wait_s = (0.5 + device.delay_ticks) / loop.rate_hz;  // T/2 + t_d
  return (damping + loop.wall_damping_N_s_per_m) / wait_s;
}

std::vector<WallLimits> measure_wall_limits(const DeviceSettings& device) {
  std::vector<WallLimits> rows;
  WallLoop loop;
  loop.device = device;
  for (const HandPreset& hand : hand_presets()) {
    for (const int delay_ticks : {0, 1}) {
      for (const double wall_damping : {0.0, 8.0, 20.0, 40.0}) {
        loop.device.hand = hand.settings;
        loop.device.delay_ticks = delay_ticks;
        loop.wall_damping_N_s_per_m = wall_damping;
        rows.push_back({hand.name, delay_ticks, wall_damping, spectral_limit(loop),
                        measured_limit(loop), delay_rule(loop)});
      }
    }
  }
  return rows;
}

/// Three limits of the same loops: theory's, the simulated device's, and the rule of thumb.
void harness(CaseTrial& trial) {
  for (const WallLimits& limits : measure_wall_limits(device_preset("omni"))) {
    const std::string wall = with_number("wall with B = %g: ", limits.wall_damping_N_s_per_m);
    const auto add = [&](const char* quantity, double value, const RowLimit& limit = {}) {
      StabilityRow& row = trial.add(wall + quantity, "", value, limit);
      row.device = "omni";
      row.hand = limits.hand;
      row.delay = limits.delay_ticks;
    };
    const auto off_percent = [](double value, double from) {
      return value == from ? 0.0 : 100.0 * std::abs(value / from - 1.0);
    };
    add("spectral_N_per_m", limits.spectral);
    add("measured_N_per_m", limits.measured);
    add("rule_N_per_m", limits.rule);
    add("measured against spectral_percent", off_percent(limits.measured, limits.spectral),
        at_most(2.0));
    // The rule leaves mass and the wall's damping's own delay out; with B it is told only.
    add("measured against rule_percent", off_percent(limits.measured, limits.rule),
        limits.wall_damping_N_s_per_m == 0.0 ? at_most(10.0) : RowLimit());
  }
}

}  // namespace sulcus::lab
