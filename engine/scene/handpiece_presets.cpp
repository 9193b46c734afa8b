#include "engine/scene/handpiece_presets.hpp"

#include "engine/core/units.hpp"

namespace sulcus {

namespace {

/// - Free speed: 322,200 rpm, measured; a cut 50 um deep at 60 mm/min lowered it to 288,400 rpm.
/// - Stall torque: 2.33 mN m, the largest of 41 turbines [Brockhurst and Shams 1994].
/// - Torque against speed: a straight line [Dyson and Darvell 1999]. With these two it gives
///   19.7 W at half of the free speed; others were measured to give 10 to 29.6 W.
/// - Inertia: ours, of a rotor of about a gram: it runs up with a time constant of 72 ms.
constexpr HandpiecePreset turbine() {
  SpindleSettings spindle;
  spindle.stall_torque_Nm = 2.33e-3;
  spindle.inertia_kg_m2 = 5e-9;
  return {kHandpiecePresetNames[0], spindle, 322'200 * kRevolutionPerMinute};
}

/// A motor of 40,000 rpm and 3 N cm behind a step-up of 1:5, as makers say (appledentalgroup.ca).
/// - Free speed: 200,000 rpm. Stall torque: a fifth of the motor's, 6 mN m. Power: 60 W, up to
///   which the speed is held.
/// - Droop: ours, what a speed controller leaves. Inertia: ours, the motor's rotor as the burr
///   feels it: it runs up in a second.
constexpr HandpiecePreset electric() {
  SpindleSettings spindle;
  spindle.stall_torque_Nm = 6e-3;
  spindle.inertia_kg_m2 = 300e-9;
  spindle.droop = 0.02;
  spindle.power_W = 60.0;
  return {kHandpiecePresetNames[1], spindle, 200'000 * kRevolutionPerMinute};
}

constexpr std::array<HandpiecePreset, 2> kPresets{turbine(), electric()};

}  // namespace

std::span<const HandpiecePreset> handpiece_presets() noexcept { return kPresets; }

}  // namespace sulcus
