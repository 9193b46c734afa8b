#include "tools/sulcus_lab/stability/pushes.hpp"

#include <algorithm>
#include <cmath>

#include "engine/scene/trajectory.hpp"
#include "haptics/device/simulated_device.hpp"
#include "haptics/tool_motion.hpp"
#include "tools/sulcus_lab/statistics.hpp"

namespace sulcus::lab {

namespace {

constexpr double kApproach_m_per_s = 20e-3;
constexpr double kRamp_s = 0.3;
constexpr double kBeyond_m = 1e-3;
constexpr double kJudged_s = 0.6;

std::string device_text(const Push& push, const std::string& model) {
  std::string text = "\n[device]\nmodel = 'simulated'\npreset = '" + model + "'\nhand = '" +
                     push.hand + "'\ndelay_ticks = " + std::to_string(push.delay) +
                     "\npush_ramp_s = " + std::to_string(kRamp_s) +
                     "\npush_N = " + std::to_string(push.force_N) + "\n";
  if (!push.friction) text += "friction_N = 0\n";
  return text;
}

/// Depth of the way, from the start, at which a tool that is moved along it first feels anything.
double first_contact_m(const Push& push, const std::string& text, const Eigen::Vector3d& start_m,
                       double reach_m, const VoxelModel* solid) {
  Rig rig(push.method, method_scene(push.method, text),
          solid ? std::optional<VoxelModel>(*solid) : std::nullopt);
  PathDevice path(path_along({start_m, start_m + reach_m * push.into}, 5e-3, 1000.0, push.axis));
  for (std::size_t tick = 0; tick < path.ticks(); ++tick) {
    const Felt felt = rig.step(path);
    if (felt.force_N.norm() > 1e-3) return (felt.device.position - start_m).dot(push.into);
  }
  return HUGE_VAL;
}

/// The hand's far end: at 20 mm/s until it is where the wanted force will hold it, so that in the
/// end its spring takes no part in the press, and the force is the push.
struct Hand {
  Trajectory way;
  double touch_s;
};
Hand hand_of(const Push& push, const Scene& scene, const Eigen::Vector3d& start_m,
             double contact_m) {
  const double felt_N_per_m = scene.coupling
                                  ? scene.coupling->stiffness_N_per_m
                                  : scene.tissues.front().stiffness_N_per_m *
                                        (push.method == ContactMethod::kNone ? 20.0 : 1.0);
  const double in_m = push.force_N / felt_N_per_m;
  const double lead_m = std::min(1e-3, 0.5 * contact_m);
  const Eigen::Quaterniond turn = orientation_along(push.axis);
  const Eigen::Vector3d from = start_m + (contact_m - lead_m) * push.into;
  const Eigen::Vector3d touch = start_m + contact_m * push.into;
  const double touch_s = lead_m / kApproach_m_per_s;
  std::vector<TimedPose> way{{0.0, {from, turn}}, {touch_s, {touch, turn}}};
  // Friction leaves the handle short of where its spring would bring it: first a little too far.
  const double contact_s = touch_s + kBeyond_m / kApproach_m_per_s;
  way.push_back({contact_s, {touch + kBeyond_m * push.into, turn}});
  way.push_back({contact_s + kRamp_s, {touch + in_m * push.into, turn}});
  return {Trajectory(std::move(way)), touch_s};
}

/// What a run is judged by, of each of its last ticks.
struct Judged {
  std::vector<double> handle_m, tool_m, felt_N, contacts, in_device_m, torque_Nm, turned;

  void add(const Push& push, const Felt& felt, const SimulatedDeviceState& state,
           const Eigen::Vector3d& touch) {
    handle_m.push_back(state.position.dot(push.into));
    tool_m.push_back(felt.tool.position.dot(push.into));
    felt_N.push_back(-felt.force_N.dot(push.into));
    in_device_m.push_back((felt.device.position - touch).dot(push.into));
    contacts.push_back(felt.contacts);
    torque_Nm.push_back(felt.torque_Nm.norm());
    turned.push_back(small_turn(orientation_along(push.axis), state.orientation).norm());
  }
  void sum_up(bool cutting, PushResult& result) const {
    const auto rms_of = [&](const std::vector<double>& values) {
      return cutting ? detrended_rms(values) : rms(values);
    };
    result.rms_m = rms_of(handle_m);
    result.tool_rms_m = rms_of(tool_m);
    result.contact_N = mean(felt_N);
    result.contacts = mean(contacts);
    result.in_device_m = mean(in_device_m);
    result.stiffness_N_per_m =
        result.in_device_m > 0.0 ? result.contact_N / result.in_device_m : HUGE_VAL;
    result.torque_Nm = mean(torque_Nm);
    result.turn = mean(turned);
    result.turn_rms = rms_of(turned);
  }
};

}  // namespace

PushResult run_push(const Push& push, const std::string& text, const Eigen::Vector3d& start_m,
                    double reach_m, std::optional<double> stiffness_N_per_m,
                    const VoxelModel* solid) {
  PushResult result;
  const double contact_m = first_contact_m(push, text, start_m, reach_m, solid);
  if (contact_m == HUGE_VAL) return result;
  result.reached = true;
  Scene scene = method_scene(
      push.method, text + (push.cutting ? "\n[cutting]\n" : "") + device_text(push, push.device),
      stiffness_N_per_m);
  scene.device->hand.push_direction = push.into;
  result.resolution_m = scene.device->resolution_m;
  Rig rig(push.method, scene, solid ? std::optional<VoxelModel>(*solid) : std::nullopt);

  const Hand hand = hand_of(push, scene, start_m, contact_m);
  SimulatedDevice device(*scene.device, hand.way, scene.haptics.rate_hz, scene.burr.reference_m);

  const double dt_s = 1.0 / scene.haptics.rate_hz;
  const auto ticks = static_cast<std::size_t>((hand.touch_s + push.duration_s) / dt_s);
  const auto judged_from = ticks - static_cast<std::size_t>(kJudged_s / dt_s);
  const Eigen::Vector3d touch = start_m + contact_m * push.into;
  Judged judged;
  Eigen::Vector3d last_N = Eigen::Vector3d::Zero();
  std::size_t touched = 0;
  const double radius_m = 0.5 * scene.burr.diameter_m;
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const Felt felt = rig.step(device);
    result.buzz_ticks += (felt.faults & kFaultBuzz) != 0;
    const double depth_m = (felt.tool.position - touch).dot(push.into);
    result.felt_N.push_back(static_cast<float>(felt.force_N.norm()));
    result.depth_mm.push_back(static_cast<float>(1e3 * depth_m));
    // While cutting the surface itself recedes.
    result.popped |= push.cutting ? rig.is_inside(felt.tool) : depth_m > radius_m;
    if (felt.contacts > 0) ++touched;
    if (touched > 5) result.step_N = std::max(result.step_N, (felt.force_N - last_N).norm());
    last_N = felt.force_N;
    result.tip_m = felt.tool.position;
    if (tick < judged_from) continue;
    if (push.cutting && felt.contacts == 0 && felt.force_N.norm() > 0.9 * push.force_N) {
      result.popped = true;
    }
    judged.add(push, felt, device.state(), touch);
  }
  judged.sum_up(push.cutting, result);
  return result;
}

}  // namespace sulcus::lab
