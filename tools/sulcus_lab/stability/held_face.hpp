#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/trajectory.hpp"
#include "haptics/device/simulated_device.hpp"
#include "tools/sulcus_lab/stability/cases/case_solids.hpp"
#include "tools/sulcus_lab/stability/rig.hpp"

namespace sulcus::lab {

// What the cases of a device's loop have in common: a flat face at z = 0, half a millimetre thick,
// under the cases' round burr, and a simulated device that is held by a hand.

inline constexpr double kHeldRate_hz = 1000.0, kHeldTick_s = 1.0 / kHeldRate_hz;

/// Device and hand by their presets' names.
struct Held {
  std::string_view device = "omni", hand = "light";
  int delay_ticks = 0;
};
DeviceSettings device_of(const Held& held, double push_N = 0.0);

/// The face alone, for method_scene.
std::string face_text();
/// The face under a method, in a device's loop; the coupling as the device's maker recommends.
Scene face_scene(ContactMethod method, const DeviceSettings& device);

/// Says of a row that its run was in such a loop. The row.
StabilityRow& in_loop(StabilityRow& row, const Held& held, double push_N = 0.0);

/// The hand's far end: along corners of the tip, at a speed.
Trajectory hand_along(const std::vector<Eigen::Vector3d>& corners_m, double speed_m_per_s);

/// A method and a simulated device that is held by a hand.
class HeldTool {
 public:
  HeldTool(ContactMethod method, const Scene& scene, Trajectory hand);

  Felt step() { return rig_.step(device_); }
  const Rig& rig() const { return rig_; }
  const SimulatedDeviceState& handle() const { return device_.state(); }
  /// Where the handle truly is, as the height of the tip.
  double tip_m() const { return device_.state().position.z() - reference_m_; }

 private:
  Trajectory hand_;
  Rig rig_;
  SimulatedDevice device_;
  double reference_m_;
};

}  // namespace sulcus::lab
