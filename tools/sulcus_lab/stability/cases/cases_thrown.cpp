#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/units.hpp"
#include "engine/scene/device_presets.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/stability/held_face.hpp"

namespace sulcus::lab {

// A device that is thrown or tapped at a flat face, jumps, or is answered late: cases 12, 17 and
// 19.

// --- Thrown at the face -------------------------------------------------------------------------

namespace {

using Eigen::Vector3d;

/// A handle that nobody holds, without friction, thrown at the face from above over and over, each
/// time from another place in its quanta: whatever it gains came out of the simulation. Its
/// encoders are the device's.
class ThrownHandle final : public Device {
 public:
  ThrownHandle(const DeviceSettings& device, double speed_m_per_s)
      : device_(device), thrown_m_per_s_(speed_m_per_s) {}

  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    if (tick > 0) advance();
    if (device_.delay_ticks > 0) held_N_ = std::exchange(next_N_, 0.0);
    const double read = device_.resolution_m * std::floor(z_m_ / device_.resolution_m + 0.5);
    return Pose{{0.0, 0.0, read}, orientation_};
  }
  void apply(const Wrench& wrench) noexcept override {
    (device_.delay_ticks > 0 ? next_N_ : held_N_) = wrench.force_N.z();
  }
  /// Of its kinetic energy, what it came back with more than it was thrown with: one for each tap.
  const std::vector<double>& gains() const { return gains_; }

 private:
  static constexpr double kHigh_m = 0.5e-3;
  static constexpr int kSubsteps = 40;
  static constexpr int kWait = 150;  // ticks, until the device's force has faded in

  void advance() {
    if (waited_++ < kWait) return;
    for (int i = 0; i < kSubsteps; ++i) {  // exact under the force held
      constexpr double h = kHeldTick_s / kSubsteps;
      const double a = held_N_ / device_.mass_kg;
      z_m_ += h * (v_ + 0.5 * h * a);
      v_ += h * a;
    }
    const bool is_back = v_ > 0.0 && z_m_ > kHigh_m && held_N_ == 0.0;
    const bool is_through = z_m_ < -kCaseRadius_m - 1e-3;
    if (!is_back && !is_through) return;
    gains_.push_back(is_through ? HUGE_VAL : v_ * v_ / (thrown_m_per_s_ * thrown_m_per_s_) - 1.0);
    // Nowhere a step that no hand makes: the device's force would fade in anew.
    z_m_ = kHigh_m + 7.3e-6 * static_cast<double>(gains_.size());
    v_ = -thrown_m_per_s_;
  }

  DeviceSettings device_;
  double thrown_m_per_s_;
  Eigen::Quaterniond orientation_ = orientation_along(Vector3d::UnitZ());
  int waited_ = 0;
  double z_m_ = kHigh_m, v_ = -thrown_m_per_s_;
  double held_N_ = 0.0, next_N_ = 0.0;
  std::vector<double> gains_;
};

}  // namespace

// Case 12. The handle alone, so that its energy before and after a tap is known exactly. The
// controller is a part of the simulation's port, which a single point does not have.
void sample_and_hold(CaseTrial& trial) {
  constexpr double kMostGain = 0.02, kSpeed_m_per_s = 0.05;
  const std::size_t taps = trial.brief ? 30 : 100;
  for (const std::string_view device_name : {"touch", "omni"}) {
    for (const int delay : {0, 1}) {
      for (const bool controlled : {false, true}) {
        if (controlled && trial.method == ContactMethod::kSinglePoint) continue;
        const Held held{device_name, "", delay};
        DeviceSettings device = device_preset(device_name);
        device.delay_ticks = delay;
        device.passivity_controller = controlled;
        Rig rig(trial.method, face_scene(trial.method, device));
        ThrownHandle handle(device, kSpeed_m_per_s);
        std::vector<float> force_N;
        for (int tick = 0; handle.gains().size() < taps && tick < 400 * 1000; ++tick) {
          const Felt felt = rig.step(handle);
          if (tick < 600) force_N.push_back(static_cast<float>(felt.force_N.z()));
        }
        const double most =
            handle.gains().size() < taps ? HUGE_VAL : std::ranges::max(handle.gains());
        in_loop(trial.add("gain", controlled ? "controller on" : "controller off", most,
                          controlled ? at_most(kMostGain) : RowLimit()),
                held);
        if (device_name == "omni" && delay == 0) {
          trial.trace(controlled ? "with the controller" : "without it", std::move(force_N));
        }
      }
    }
  }
}

// --- Jumps and late ticks -----------------------------------------------------------------------

namespace {

/// What taps: a firm hand, which presses with a newton where its end is 3 mm beyond the face.
constexpr Held kTapping{"omni", "firm", 0};

/// It taps on the face and slides along it, 0.6 mm up and 3 mm in, at 20 mm/s.
Trajectory tapping_hand(int taps) {
  std::vector<Vector3d> corners{{-0.2e-3, 0.0, 0.6e-3}};
  for (int tap = 0; tap < taps; ++tap) {
    const double side = tap % 2 == 0 ? 1.0 : -1.0;
    corners.emplace_back(0.0, 0.0, -3e-3);
    corners.emplace_back(side * 0.2e-3, 0.0, 0.6e-3);
  }
  return hand_along(corners, 20e-3);
}

/// What a run over late ticks showed.
struct Tapped {
  double deepest_m = 0.0, largest_N = 0.0, largest_step_N = 0.0, largest_sent_step_N = 0.0;
  double fastest_handle_m_per_s = 0.0, fastest_tool_m_per_s = 0.0;
  double fastest_touching_m_per_s = 0.0;  // of the tool, from one contact to another
  std::uint64_t step_limited_ticks = 0;
  bool finite = true;
  std::vector<float> force_N, depth_mm;
};

Tapped tap(ContactMethod method, std::vector<LateTick> late, std::uint64_t ticks) {
  constexpr int kTapTicks = 360;
  DeviceSettings device = device_of(kTapping);
  device.late = std::move(late);
  HeldTool tool(method, face_scene(method, device),
                tapping_hand(1 + static_cast<int>(ticks) / kTapTicks));
  Tapped run;
  Vector3d last_force_N = Vector3d::Zero(), last_sent_N = Vector3d::Zero();
  Vector3d last_tool_m = Vector3d::Zero();
  bool touched = false;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    const Felt felt = tool.step();
    const Vector3d sent_N = tool.handle().held.force_N;
    run.finite &= felt.force_N.allFinite() && felt.tool.position.allFinite() &&
                  tool.handle().position.allFinite();
    run.deepest_m = std::max(run.deepest_m, -felt.tool.position.z());
    run.largest_N = std::max(run.largest_N, felt.force_N.norm());
    run.largest_step_N = std::max(run.largest_step_N, (felt.force_N - last_force_N).norm());
    run.largest_sent_step_N = std::max(run.largest_sent_step_N, (sent_N - last_sent_N).norm());
    run.fastest_handle_m_per_s =
        std::max(run.fastest_handle_m_per_s, tool.handle().velocity_m_per_s.norm());
    if (tick > 0) {
      const double speed = (felt.tool.position - last_tool_m).norm() / kHeldTick_s;
      run.fastest_tool_m_per_s = std::max(run.fastest_tool_m_per_s, speed);
      if (touched && felt.contacts > 0) {
        run.fastest_touching_m_per_s = std::max(run.fastest_touching_m_per_s, speed);
      }
    }
    last_force_N = felt.force_N;
    last_sent_N = sent_N;
    last_tool_m = felt.tool.position;
    touched = felt.contacts > 0;
    run.force_N.push_back(static_cast<float>(felt.force_N.norm()));
    run.depth_mm.push_back(static_cast<float>(-felt.tool.position.z() / kMillimetre));
  }
  run.step_limited_ticks = tool.rig().simulation().state().port.limiter.step_limited_ticks;
  return run;
}

/// What a device that jumps does to the tool: a path whose phases are `kPhase` ticks long.
struct Thrown {
  double deepest_m = 0.0, largest_N = 0.0;
  int settled = 0;  // ticks after a jump, at most
  bool finite = true;
  std::vector<float> force_N, depth_mm;
};

Thrown throw_tool(ContactMethod method) {
  constexpr std::size_t kPhase = 150;
  constexpr double kStill_N = 0.02;  // of the force that the phase ends with
  const double in = -0.5e-3, jump = 50e-3;
  // Pressed; thrown in and back; thrown out and back.
  const double heights_m[] = {in, in - jump, in, in + jump, in};
  std::vector<Pose> poses = path_along({Vector3d(0, 0, 0.2e-3), Vector3d(0, 0, in)}, 20e-3);
  const std::size_t lead = poses.size();
  for (const double z : heights_m) {
    poses.insert(poses.end(), kPhase, Pose{{0.0, 0.0, z}, poses.front().orientation});
  }
  PathDevice path(std::move(poses));
  Rig rig(method, face_scene(method, device_of({})));
  Thrown run;
  std::vector<Vector3d> force_N;
  for (std::size_t tick = 0; tick < path.ticks(); ++tick) {
    const Felt felt = rig.step(path);
    run.finite &= felt.force_N.allFinite() && felt.tool.position.allFinite();
    run.deepest_m = std::max(run.deepest_m, -felt.tool.position.z());
    run.largest_N = std::max(run.largest_N, felt.force_N.norm());
    force_N.push_back(felt.force_N);
    run.force_N.push_back(static_cast<float>(felt.force_N.norm()));
    run.depth_mm.push_back(static_cast<float>(-felt.tool.position.z() / kMillimetre));
  }
  for (std::size_t begin = lead + kPhase; begin < force_N.size(); begin += kPhase) {
    for (std::size_t i = 0; i < kPhase; ++i) {
      if ((force_N[begin + i] - force_N[begin + kPhase - 1]).norm() > kStill_N) {
        run.settled = std::max(run.settled, static_cast<int>(i) + 1);
      }
    }
  }
  return run;
}

}  // namespace

// Case 17. The jumps by a path, so that it is the proxy that settles and no hand. The late ticks in
// a closed loop that taps; one of no length is a microsecond long.
void proxy_thrown(CaseTrial& trial) {
  constexpr double kWithin_ms = 50.0;
  const double limit_N = device_of({}).force_limit_N;
  const auto add = [&](const Held& held, const char* quantity, const std::string& by, double value,
                       double limit) {
    in_loop(trial.add(quantity, by, value, at_most(limit)), held);
  };
  const auto add_run = [&](const Held& held, const std::string& by, const auto& run) {
    add(held, "not_finite", by, run.finite ? 0.0 : 1.0, 0.0);
    add(held, "deepest_mm", by, run.deepest_m / kMillimetre, kCaseRadius_m / kMillimetre);
    // To the rounding of its square root.
    add(held, "force_N", by, run.largest_N, limit_N * (1.0 + 1e-12));
  };
  constexpr Held kByAPath{"", "", 0};
  Thrown thrown = throw_tool(trial.method);
  add_run(kByAPath, "jumps of 50 mm", thrown);
  add(kByAPath, "settled_ms", "jumps of 50 mm", thrown.settled * kHeldTick_s / 1e-3, kWithin_ms);
  trial.trace("50 mm in, back, out and back", std::move(thrown.force_N),
              std::move(thrown.depth_mm));
  const std::uint64_t ticks = trial.brief ? 1000 : 3000;
  for (const double length_ms : {0.001, 10.0, 100.0}) {
    std::vector<LateTick> late;
    for (std::uint64_t tick = 37; tick < ticks; tick += 73) {
      late.push_back({tick, 1e-3 * length_ms - kHeldTick_s});
    }
    add_run(kTapping, with_number("ticks of %g ms", length_ms),
            tap(trial.method, std::move(late), ticks));
  }
}

// Case 19. Every tick a little late, some by up to 16 ms, while a hand taps at 20 mm/s. Velocity:
// of the tool as a tick takes it, from two poses a nominal tick apart, which is to be no more than
// in the same taps on time or than a voxel a tick, the limit of [McNeely et al. 1999]; one quantum
// of the encoders is already 55 mm/s. Beside it that of a tool that touches before and after, where
// velocity makes forces. Force step: as felt, held to the cap of the device's edge behind it.
void late_tick(CaseTrial& trial) {
  constexpr double kMostStep_N = 0.5, kVoxelATick_mm_per_s = 34.8;
  constexpr std::uint64_t kTicks = 4000;
  std::vector<LateTick> late;
  std::uint32_t random = 1;  // as the C standard's example
  for (std::uint64_t tick = 1; tick < kTicks; ++tick) {
    random = random * 1103515245u + 12345u;
    const double part = static_cast<double>(random >> 8) / 16777216.0;
    const double noise_s = -25e-6 * std::log(1.0 - part);
    late.push_back(
        {tick, tick % 37 == 0 ? 1e-3 * static_cast<double>(1 << tick / 37 % 5) : noise_s});
  }
  const Tapped on_time = tap(trial.method, {}, kTicks);
  Tapped run = tap(trial.method, late, kTicks);
  const auto add = [&](const char* quantity, double value, const RowLimit& limit = {}) {
    in_loop(trial.add(quantity, "", value, limit), kTapping);
  };
  add("not_finite", run.finite ? 0.0 : 1.0, at_most(0.0));
  add("force_step_N", run.largest_step_N, at_most(kMostStep_N));
  add("force_step_on_time_N", on_time.largest_step_N);
  add("sent_step_N", run.largest_sent_step_N, at_most(kMostStep_N * (1.0 + 1e-12)));
  add("step_limited_ticks", static_cast<double>(run.step_limited_ticks));
  add("handle_mm_per_s", run.fastest_handle_m_per_s / kMillimetre);
  add("handle_on_time_mm_per_s", on_time.fastest_handle_m_per_s / kMillimetre);
  add("tool_mm_per_s", run.fastest_tool_m_per_s / kMillimetre,
      at_most(std::max(kVoxelATick_mm_per_s, on_time.fastest_tool_m_per_s / kMillimetre) *
              (1.0 + 1e-9)));
  add("tool_on_time_mm_per_s", on_time.fastest_tool_m_per_s / kMillimetre);
  add("touching_mm_per_s", run.fastest_touching_m_per_s / kMillimetre);
  add("touching_on_time_mm_per_s", on_time.fastest_touching_m_per_s / kMillimetre);
  trial.trace("gaps up to 16 ms", std::move(run.force_N), std::move(run.depth_mm));
}

}  // namespace sulcus::lab
