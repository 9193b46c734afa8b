#include "tools/sulcus_lab/stability/held_face.hpp"

#include <utility>

#include "engine/scene/device_presets.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

DeviceSettings device_of(const Held& held, double push_N) {
  DeviceSettings d = device_preset(held.device);
  d.hand = hand_preset(held.hand);
  d.hand.push_N = push_N;
  d.delay_ticks = held.delay_ticks;
  return d;
}

std::string face_text() {
  return R"(
[workpiece]
shape = 'plate'
cells = [48, 48, 32]
position_mm = [0, 0, -0.25]
[workpiece.plate]
thickness_mm = 0.5
[burr]
diameter_mm = 1.0
field = 'auto'
)";
}

Scene face_scene(ContactMethod method, const DeviceSettings& device) {
  Scene scene = method_scene(method, face_text() + "[device]\nmodel = 'simulated'\n");
  scene.device = device;
  if (scene.coupling) {
    scene.coupling->stiffness_N_per_m = device.stiffness_N_per_m;
    scene.coupling->force_limit_N = device.force_limit_N;
  }
  return scene;
}

StabilityRow& in_loop(StabilityRow& row, const Held& held, double push_N) {
  row.device = held.device;
  row.hand = held.hand;
  row.delay = held.delay_ticks;
  row.push_N = push_N;
  return row;
}

Trajectory hand_along(const std::vector<Vector3d>& corners_m, double speed_m_per_s) {
  std::vector<TimedPose> poses;
  double time_s = 0.0;
  for (std::size_t c = 0; c < corners_m.size(); ++c) {
    if (c > 0) time_s += (corners_m[c] - corners_m[c - 1]).norm() / speed_m_per_s;
    poses.push_back({time_s, {corners_m[c], orientation_along(Vector3d::UnitZ())}});
  }
  return Trajectory(std::move(poses));
}

HeldTool::HeldTool(ContactMethod method, const Scene& scene, Trajectory hand)
    : hand_(std::move(hand)),
      rig_(method, scene),
      device_(*scene.device, hand_, scene.haptics.rate_hz, scene.burr.reference_m),
      reference_m_(scene.burr.reference_m) {}

}  // namespace sulcus::lab
