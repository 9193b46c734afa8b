#pragma once

#include <string_view>
#include <vector>

#include "engine/scene/scene.hpp"

namespace sulcus::lab {

// The harness of the closed-loop measurements, checked where theory knows the answer: a device held
// by a hand against a plain wall, F = -K x - B v for x > 0, v the backward difference of the
// sampled x, force held over the tick, no friction, no quantisation.

/// One loop. Of the device its mass and damping count, its hand's, and its delay.
struct WallLoop {
  DeviceSettings device;
  double wall_damping_N_s_per_m = 0.0;  // B
  double rate_hz = 1000.0;
};

/// Largest magnitude of the eigenvalues of the loop from tick to tick, about its equilibrium: the
/// mass, damper and spring carried over the tick exactly by the matrix exponential, the state with
/// the last x, for the difference, and with a delay with the force that is on its way.
double spectral_radius(const WallLoop& loop, double stiffness_N_per_m);

/// The largest K up to which that radius stays within 1; 0 where a wall of 10 N/m is unstable (much
/// damping with a delay is), HUGE_VAL where all up to 1e7 N/m are stable.
double spectral_limit(const WallLoop& loop);

/// The largest K at which SimulatedDevice itself, pushed against that wall, comes to rest there; 0
/// and HUGE_VAL as above. It starts a thousandth off the depth at which the wall holds the push, so
/// that contact is not lost before the motion has grown a hundredfold. Found within
/// kMeasuredWithin. About half a second of processor time.
double measured_limit(const WallLoop& loop);
inline constexpr double kMeasuredWithin = 1e-3;  // of K

/// The rule of thumb K < (b + B) / (T/2 + t_d), b of device and hand, t_d the delay. It leaves
/// their mass and the hand's spring out.
double delay_rule(const WallLoop& loop);

/// The three limits, N/m, of one loop.
struct WallLimits {
  std::string_view hand;
  int delay_ticks = 0;
  double wall_damping_N_s_per_m = 0.0;
  double spectral = 0.0, measured = 0.0, rule = 0.0;
};

/// At 1 kHz with that device's mass and damping: hands light, firm and arm, delay 0 and 1, B = 0,
/// 8, 20 and 40 N s/m, in this order, the last running fastest.
std::vector<WallLimits> measure_wall_limits(const DeviceSettings& device);

}  // namespace sulcus::lab
