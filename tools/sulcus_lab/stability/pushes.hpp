#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/sulcus_lab/stability/rig.hpp"

namespace sulcus::lab {

/// A hand that brings a burr to a place at 20 mm/s and, once there, presses until the contact force
/// is what is wanted; a simulated device in a closed loop.
struct Push {
  ContactMethod method = ContactMethod::kCoupling;
  std::string device = "omni", hand = "light";
  int delay = 0;
  bool friction = true;
  bool cutting = false;
  double force_N = 1.0;
  Eigen::Vector3d into{0, 0, -1};  // unit, world: where the hand presses
  Eigen::Vector3d axis{0, 0, 1};   // of the burr, from tip to shank
  double duration_s = 1.4;         // of the press; its last 0.6 s are judged
};

/// Judged over the last 0.6 s.
struct PushResult {
  bool popped = false;      // deeper than its radius; cutting: inside, or pressed on nothing
  bool reached = false;     // contact was made at all
  double rms_m = 0.0;       // of the handle about its mean; while cutting about its straight line
  double tool_rms_m = 0.0;  // of the tool
  double resolution_m = 0.0;
  double contact_N = 0.0;              // mean felt force, along the press
  double in_device_m = 0.0;            // mean: how far the device is in, from first contact on
  double stiffness_N_per_m = 0.0;      // felt: force over how far the device is in
  double contacts = 0.0;               // mean
  double step_N = 0.0;                 // largest change in a tick after first contact
  double torque_Nm = 0.0, turn = 0.0;  // mean, about the handle; rad, of the device from the hand's
  double turn_rms = 0.0;               // rad
  Eigen::Vector3d tip_m{0, 0, 0};      // where the tool is in the end
  std::uint64_t buzz_ticks = 0;
  std::vector<float> felt_N, depth_mm;  // of every tick
  bool stable() const { return rms_m < resolution_m; }
};

/// Runs a push. `text` is a scene's [workpiece] and [burr]; the tip starts at `start_m`, in free
/// space, and goes `into` the solid, which must lie within `reach_m` of it.
PushResult run_push(const Push& push, const std::string& text, const Eigen::Vector3d& start_m,
                    double reach_m, std::optional<double> stiffness_N_per_m = {},
                    const VoxelModel* solid = nullptr);

}  // namespace sulcus::lab
