#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/units.hpp"
#include "engine/scene/device_presets.hpp"
#include "haptics/buzz_detector.hpp"
#include "haptics/simulated_device.hpp"
#include "tools/sulcus_lab/stability/cases.hpp"
#include "tools/sulcus_lab/stability/rig.hpp"
#include "tools/sulcus_lab/wall_loop.hpp"

namespace sulcus::lab {

// What a device and a hand make of a flat face: cases 5, 12, 13, 17 and 19.

namespace {

using Eigen::Vector3d;

constexpr double kRate_hz = 1000.0, kTick_s = 1.0 / kRate_hz;
constexpr double kRadius_m = 0.5e-3;
constexpr double kPush_N = 1.0;

/// A face at z = 0, half a millimetre thick, under a round burr of R = 0.5 mm.
const std::string kFace = R"(
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
const std::string kDevice = "[device]\nmodel = 'simulated'\n";

struct Held {
  std::string_view device = "omni", hand = "light";
  int delay_ticks = 0;
};

template <class Presets>
const auto& preset(const Presets& presets, std::string_view name) {
  return std::find_if(presets.begin(), presets.end(), [&](const auto& p) { return p.name == name; })
      ->settings;
}

DeviceSettings device_of(const Held& held, double push_N = 0.0) {
  DeviceSettings d = preset(device_presets(), held.device);
  d.hand = preset(hand_presets(), held.hand);
  d.hand.push_N = push_N;
  d.delay_ticks = held.delay_ticks;
  return d;
}

/// The face under a method, in a device's loop; the coupling as the device's maker recommends.
Scene face_scene(ContactMethod method, const DeviceSettings& device) {
  Scene scene = method_scene(method, kFace + kDevice);
  scene.device = device;
  if (scene.coupling) {
    scene.coupling->stiffness_N_per_m = device.stiffness_N_per_m;
    scene.coupling->force_limit_N = device.force_limit_N;
  }
  return scene;
}

StabilityRow row_of(std::string_view name, ContactMethod method, const Held& held, double push_N,
                    std::string quantity, double value, std::optional<double> limit = {}) {
  StabilityRow row;
  row.case_name = name;
  row.method = method;
  row.device = held.device;
  row.hand = held.hand;
  row.burr_mm = 2.0 * kRadius_m / kMillimetre;
  row.delay = held.delay_ticks;
  row.push_N = push_N;
  row.quantity = std::move(quantity);
  row.value = value;
  row.limit = limit;
  return row;
}

std::string with_number(const char* form, double number) {
  char text[64];
  std::snprintf(text, sizeof text, form, number);
  return text;
}

double mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double rms(std::span<const double> values) {
  const double middle = mean(values);
  double sum = 0.0;
  for (const double v : values) sum += (v - middle) * (v - middle);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double peak_to_peak(std::span<const double> values) {
  const auto [least, most] = std::ranges::minmax(values);
  return most - least;
}

std::span<const double> last(std::span<const double> values, std::size_t count,
                             std::size_t before_end = 0) {
  return values.subspan(values.size() - before_end - count, count);
}

/// The hand's far end: along corners of the tip, at a speed.
Trajectory hand_along(const std::vector<Vector3d>& corners_m, double speed_m_per_s) {
  std::vector<TimedPose> poses;
  double time_s = 0.0;
  for (std::size_t c = 0; c < corners_m.size(); ++c) {
    if (c > 0) time_s += (corners_m[c] - corners_m[c - 1]).norm() / speed_m_per_s;
    poses.push_back({time_s, {corners_m[c], orientation_along(Vector3d::UnitZ())}});
  }
  return Trajectory(std::move(poses));
}

/// A method and a simulated device that is held by a hand.
class HeldTool {
 public:
  HeldTool(ContactMethod method, const Scene& scene, Trajectory hand)
      : hand_(std::move(hand)),
        rig_(method, scene),
        device_(*scene.device, hand_, scene.haptics.rate_hz, scene.burr.reference_m),
        reference_m_(scene.burr.reference_m) {}

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

// --- Pressed onto the face ----------------------------------------------------------------------

/// One run: at 20 mm/s to the face, then pushed.
struct Pressed {
  std::vector<double> force_N, handle_m, read_m;  // felt, true, as it was read
  double deepest_m = 0.0;                         // of the tool; once through, the run is over
  bool popped() const { return deepest_m > kRadius_m; }
  int first_fall = -1;  // tick in which the force has first turned round
  int first_buzz = -1;  // in which the detector speaks
};

constexpr int kPressedTicks = 1000;   // 0.4 s to touch and be pushed, the rest to be judged in
constexpr std::size_t kJudged = 600;  // ticks

/// What the detector takes the contact to be as stiff as.
double heard_stiffness(const Scene& scene) {
  return scene.coupling ? scene.coupling->stiffness_N_per_m
                        : scene.tissues.front().stiffness_N_per_m;
}

Pressed press(ContactMethod method, const Scene& scene) {
  // So far beyond the face that the hand's spring overcomes the friction twice.
  const double beyond_m = 2.0 * scene.device->friction_N / scene.device->hand.stiffness_N_per_m;
  HeldTool tool(method, scene,
                hand_along({Vector3d(0, 0, 0.2e-3), Vector3d(0, 0, -beyond_m)}, 20e-3));
  const double threshold_N = buzz_threshold_N(heard_stiffness(scene), scene.device->resolution_m);
  Pressed run;
  BuzzState heard;
  double most_N = 0.0;
  for (int tick = 0; tick < kPressedTicks; ++tick) {
    const Felt felt = tool.step();
    const double force_N = felt.force_N.z();
    run.force_N.push_back(force_N);
    run.handle_m.push_back(tool.tip_m());
    run.read_m.push_back(felt.device.position.z());
    run.deepest_m = std::max(run.deepest_m, -felt.tool.position.z());
    if (run.popped()) break;
    most_N = std::max(most_N, force_N);
    if (run.first_fall < 0 && force_N < most_N - threshold_N) run.first_fall = tick;
    // Beside a single point there is no simulation that listens.
    const bool buzzes = method == ContactMethod::kSinglePoint
                            ? buzz(felt.force_N, threshold_N, kTick_s, heard)
                            : (felt.faults & kFaultBuzz) != 0;
    if (buzzes && run.first_buzz < 0) run.first_buzz = tick;
  }
  return run;
}

/// F(depth) of a method at a tissue stiffness of 1 N/m, the tool where it is put.
class ContactCurve {
 public:
  explicit ContactCurve(ContactMethod method) {
    const Scene scene = method_scene(method, kFace, 1.0);
    Rig rig(method, scene);
    PathDevice path(
        path_along({Vector3d(0, 0, kStep_m), Vector3d(0, 0, -kRadius_m)}, kStep_m * kRate_hz));
    for (std::size_t tick = 0; tick < path.ticks(); ++tick) {
      const Felt felt = rig.step(path);
      if (felt.tool.position.z() < 0.5 * kStep_m) force_N_.push_back(felt.force_N.z());
    }
  }

  /// The depth at which the slope is `stiffness`, the contact scaled so that it holds `push_N`
  /// there: push f'/f falls with depth. The tissue's stiffness for that.
  double tissue_for(double push_N, double stiffness) const {
    std::size_t at = kSmoothed;
    while (at + kSmoothed + 1 < force_N_.size() &&
           push_N * slope(at) / std::max(force_N_[at], 1e-300) > stiffness) {
      ++at;
    }
    return push_N / force_N_[at];
  }
  /// Depth at which a tissue holds a push, m; all there is where none does.
  double depth_m(double push_N, double tissue_N_per_m) const {
    std::size_t at = 1;
    while (at + 1 < force_N_.size() && tissue_N_per_m * force_N_[at] < push_N) ++at;
    const double below = force_N_[at - 1], above = force_N_[at];
    const double part = above > below ? (push_N / tissue_N_per_m - below) / (above - below) : 1.0;
    return (static_cast<double>(at - 1) + part) * kStep_m;
  }
  /// Stiffness of the contact between two pushes, N/m.
  double stiffness(double from_N, double to_N, double tissue_N_per_m) const {
    return (to_N - from_N) / (depth_m(to_N, tissue_N_per_m) - depth_m(from_N, tissue_N_per_m));
  }

 private:
  static constexpr double kStep_m = 0.5e-6;
  static constexpr std::size_t kSmoothed = 60;  // steps, of the slope: about a voxel

  double slope(std::size_t at) const {
    return (force_N_[at + kSmoothed] - force_N_[at - kSmoothed]) / (2 * kSmoothed * kStep_m);
  }
  std::vector<double> force_N_;
};

/// The face as a method makes it, with a stiffness for the hand: that of the coupling, or where the
/// tool follows the device that of the tissue.
class FeltFace {
 public:
  explicit FeltFace(ContactMethod method)
      : method_(method),
        curve_(method == ContactMethod::kSinglePoint
                   ? std::nullopt
                   : std::optional<ContactCurve>(std::in_place, without_coupling(method))) {}

  /// Felt as `stiffness` at the push.
  Scene scene(const DeviceSettings& device, double push_N, double stiffness) const {
    Scene scene = face_scene(method_, device);
    if (method_ == ContactMethod::kCoupling) {
      const double contact = curve_->stiffness(0.9 * push_N, 1.1 * push_N, stiffness_of(method_));
      scene.coupling->stiffness_N_per_m = 1.0 / (1.0 / stiffness - 1.0 / contact);
      return scene;
    }
    const double tissue = curve_ ? curve_->tissue_for(push_N, stiffness) : stiffness;
    for (TissueSettings& t : scene.tissues) t.stiffness_N_per_m = tissue;
    return scene;
  }

 private:
  static ContactMethod without_coupling(ContactMethod method) {
    return method == ContactMethod::kCoupling ? ContactMethod::kSmooth : method;
  }
  ContactMethod method_;
  std::optional<ContactCurve> curve_;
};

/// The loop without quanta and friction, to know where to look.
double linear_limit(const DeviceSettings& device) {
  WallLoop loop;
  loop.device = device;
  return spectral_limit(loop);
}

/// The largest felt stiffness that holds the push and does not buzz: stepped upward coarsely to the
/// first that does, then finely to where all over 12 % do; where it ends, quanta and friction make
/// it patchy. 0: what is stiff enough to hold it buzzes.
double largest_stable(ContactMethod method, const FeltFace& face, const DeviceSettings& device) {
  constexpr double kCoarse = 1.12, kFine = 1.03, kMost = 4.0;  // times the linear limit
  const double linear = linear_limit(device);
  double largest = 0.0;
  const auto climb = [&](double from, double ratio, int failures) {
    for (double k = from; k < kMost * linear && failures > 0; k *= ratio) {
      const Pressed run = press(method, face.scene(device, kPush_N, k));
      if (run.popped()) continue;
      const bool stable = rms(last(run.handle_m, kJudged)) < device.resolution_m;
      if (stable) largest = k;
      failures = stable ? failures : failures - 1;
    }
  };
  climb(0.7 * linear, kCoarse, 1);
  if (largest > 0.0) climb(kFine * largest, kFine, 4);
  return largest;
}

}  // namespace

// Case 5. At 0.5 to 1.5 of the largest felt stiffness that is stable in that very loop, friction
// and quanta included: with them it is up to 2.6 times what the linear loop allows. A tool that
// went through has no peaks to be measured: infinite. The time to the detector's first word counts
// from the force's first turn.
CaseResult buzz_case(const CaseOptions& options) {
  constexpr double kMostQuanta = 1.5, kWithin_ms = 50.0;
  CaseResult result;
  std::vector<Held> loops;
  for (const std::string_view hand : kHandPresetNames) {
    for (const int delay : {0, 1}) loops.push_back({"omni", hand, delay});
  }
  for (const ContactMethod method : options.methods) {
    const FeltFace face(method);
    for (const Held& held : loops) {
      // All for ours only; the rest is measured against it where the hand is lightest.
      const bool is_first = held.hand == "light" && held.delay_ticks == 0;
      if (!is_first && method != ContactMethod::kCoupling) continue;
      if (options.brief && !is_first) continue;
      const DeviceSettings device = device_of(held, kPush_N);
      const double largest = largest_stable(method, face, device);
      const auto add = [&](std::string quantity, double value, std::optional<double> limit = {}) {
        result.rows.push_back(
            row_of("buzz", method, held, kPush_N, std::move(quantity), value, limit));
      };
      const auto pressed_at = [&](double part) {
        const double k = part * (largest > 0.0 ? largest : linear_limit(device));
        Pressed run = press(method, face.scene(device, kPush_N, k));
        if (held.hand == "light" && held.delay_ticks == 0 && (part == 0.79 || part == 1.1)) {
          result.traces.push_back({.case_name = "buzz",
                                   .label = with_number("%.2f of the largest stable", part),
                                   .method = method,
                                   .dt_s = kTick_s,
                                   .force_N = {run.force_N.begin(), run.force_N.end()},
                                   .depth_mm = {}});
        }
        const double quantum_N = k * device.resolution_m;
        return std::pair{std::move(run), quantum_N};
      };
      add("largest_stable_N_per_m", largest);
      for (const double part : {0.5, 0.6, 0.7, 0.79}) {
        const auto [run, quantum_N] = pressed_at(part);
        add(with_number("peak_to_peak_quanta: at %.2f", part),
            run.popped() ? HUGE_VAL : peak_to_peak(last(run.force_N, kJudged)) / quantum_N,
            kMostQuanta);
      }
      for (const double part : {1.1, 1.5}) {
        const Pressed run = pressed_at(part).first;
        const double after_ms =
            run.first_buzz < 0 ? HUGE_VAL : (run.first_buzz - run.first_fall) * kTick_s / 1e-3;
        add(with_number("detected_after_ms: at %.1f", part), after_ms,
            part == 1.1 ? std::optional(kWithin_ms) : std::nullopt);
      }
    }
  }
  return result;
}

// --- Thrown at the face -------------------------------------------------------------------------

namespace {

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
      constexpr double h = kTick_s / kSubsteps;
      const double a = held_N_ / device_.mass_kg;
      z_m_ += h * (v_ + 0.5 * h * a);
      v_ += h * a;
    }
    const bool is_back = v_ > 0.0 && z_m_ > kHigh_m && held_N_ == 0.0;
    const bool is_through = z_m_ < -kRadius_m - 1e-3;
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
CaseResult sample_and_hold(const CaseOptions& options) {
  constexpr double kMostGain = 0.02, kSpeed_m_per_s = 0.05;
  const std::size_t taps = options.brief ? 30 : 100;
  CaseResult result;
  for (const ContactMethod method : options.methods) {
    for (const std::string_view device_name : {"touch", "omni"}) {
      for (const int delay : {0, 1}) {
        for (const bool controlled : {false, true}) {
          if (controlled && method == ContactMethod::kSinglePoint) continue;
          const Held held{device_name, "", delay};
          DeviceSettings device = preset(device_presets(), device_name);
          device.delay_ticks = delay;
          device.passivity_controller = controlled;
          Rig rig(method, face_scene(method, device));
          ThrownHandle handle(device, kSpeed_m_per_s);
          ForceTrace trace{.case_name = "sample_and_hold",
                           .label = controlled ? "with the controller" : "without it",
                           .method = method,
                           .dt_s = kTick_s,
                           .force_N = {},
                           .depth_mm = {}};
          for (int tick = 0; handle.gains().size() < taps && tick < 400 * 1000; ++tick) {
            const Felt felt = rig.step(handle);
            if (tick < 600) trace.force_N.push_back(static_cast<float>(felt.force_N.z()));
          }
          const double most =
              handle.gains().size() < taps ? HUGE_VAL : std::ranges::max(handle.gains());
          result.rows.push_back(row_of("sample_and_hold", method, held, 0.0,
                                       controlled ? "gain: controller on" : "gain: controller off",
                                       most, controlled ? std::optional(kMostGain) : std::nullopt));
          if (device_name == "omni" && delay == 0) result.traces.push_back(std::move(trace));
        }
      }
    }
  }
  return result;
}

namespace {

/// The stiffest coupling in a loop before the first that swings by more than a resolution, friction
/// and quanta included, under either push. (At the linear loop's limit a device of 1 g swings, on
/// quanta of 0.35 N, over all from no contact to the spring's limit, and no stiffness is felt.)
double own_limit(DeviceSettings device, std::span<const double> pushes_N) {
  constexpr double kRatio = 1.1;
  const double linear = linear_limit(device);
  double largest = 0.0;
  for (double k = 0.7 * linear; k < 4.0 * linear; k *= kRatio) {
    for (const double push_N : pushes_N) {
      device.hand.push_N = push_N;
      Scene scene = face_scene(ContactMethod::kCoupling, device);
      scene.coupling->stiffness_N_per_m = k;
      const Pressed run = press(ContactMethod::kCoupling, scene);
      if (run.popped() || rms(last(run.handle_m, kJudged)) >= device.resolution_m) return largest;
    }
    largest = k;
  }
  return largest;
}

}  // namespace

// Case 13. The proxy is quasi-static and has no mass of its own, so that the range of masses, which
// was meant for one with a mass, is given to the device instead. Growth: RMS of the handle over the
// last 0.3 s by that over the 0.3 s before, or by one resolution where that was less. Felt
// stiffness: from the force and the depth as read, between pushes of 1 and 2 N, against the
// coupling and the contact in series, whose curve is measured with the tool where it is put.
CaseResult coupling_mismatch(const CaseOptions& options) {
  constexpr double kMostGrowth = 1.0, kMostError = 0.05;
  constexpr std::size_t kHalf = 300;
  CaseResult result;
  if (std::ranges::find(options.methods, ContactMethod::kCoupling) == options.methods.end()) {
    return result;
  }
  constexpr ContactMethod kMethod = ContactMethod::kCoupling;
  const ContactCurve curve(ContactMethod::kSmooth);
  const double tissue = stiffness_of(kMethod);
  const std::vector<double> masses_g =
      options.brief ? std::vector<double>{1} : std::vector<double>{1, 3, 10, 45, 100};
  for (const double mass_g : masses_g) {
    for (const int delay : {0, 1}) {
      if (options.brief && delay > 0) continue;
      constexpr double kPushes_N[] = {1.0, 2.0};
      const Held held{"omni", "light", delay};
      DeviceSettings device = device_of(held);
      device.mass_kg = 1e-3 * mass_g;
      const double limit = own_limit(device, kPushes_N);
      double growth = 0.0, error = 0.0;
      for (const double part : {0.25, 0.5, 0.75, 1.0}) {
        const double k = part * limit;
        double force_N[2], read_m[2];
        for (const std::size_t load : {0u, 1u}) {
          device.hand.push_N = kPushes_N[load];
          Scene scene = face_scene(kMethod, device);
          scene.coupling->stiffness_N_per_m = k;
          const Pressed run = press(kMethod, scene);
          if (run.popped()) {
            growth = error = HUGE_VAL;
            break;
          }
          const double before = rms(last(run.handle_m, kHalf, kHalf));
          growth = std::max(growth,
                            rms(last(run.handle_m, kHalf)) / std::max(before, device.resolution_m));
          force_N[load] = mean(last(run.force_N, kJudged));
          read_m[load] = -mean(last(run.read_m, kJudged));
        }
        if (growth == HUGE_VAL) break;
        const double felt = (force_N[1] - force_N[0]) / (read_m[1] - read_m[0]);
        const double contact = curve.stiffness(force_N[0], force_N[1], tissue);
        error = std::max(error, std::abs(felt * (1.0 / k + 1.0 / contact) - 1.0));
      }
      const auto add = [&](const char* quantity, double value, std::optional<double> most = {}) {
        StabilityRow row = row_of("coupling_mismatch", kMethod, held, 2.0, quantity, value, most);
        row.device += with_number(", %g g", mass_g);
        result.rows.push_back(std::move(row));
      };
      add("own_limit_N_per_m", limit);
      add("growth", growth, kMostGrowth);
      add("series_error", error, kMostError);
    }
  }
  return result;
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
      const double speed = (felt.tool.position - last_tool_m).norm() / kTick_s;
      run.fastest_tool_m_per_s = std::max(run.fastest_tool_m_per_s, speed);
    }
    last_force_N = felt.force_N;
    last_sent_N = sent_N;
    last_tool_m = felt.tool.position;
    run.force_N.push_back(static_cast<float>(felt.force_N.norm()));
    run.depth_mm.push_back(static_cast<float>(-felt.tool.position.z() / kMillimetre));
  }
  run.step_limited_ticks = tool.rig().simulation().state().port.edge.step_limited_ticks;
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
CaseResult proxy_thrown(const CaseOptions& options) {
  constexpr double kWithin_ms = 50.0;
  const double limit_N = device_of({}).force_limit_N;
  CaseResult result;
  for (const ContactMethod method : options.methods) {
    const auto add = [&](const Held& held, std::string quantity, double value,
                         std::optional<double> limit) {
      result.rows.push_back(
          row_of("proxy_thrown", method, held, 0.0, std::move(quantity), value, limit));
    };
    const auto add_run = [&](const Held& held, const std::string& by, const auto& run) {
      add(held, "not_finite: " + by, run.finite ? 0.0 : 1.0, 0.0);
      add(held, "deepest_mm: " + by, run.deepest_m / kMillimetre, kRadius_m / kMillimetre);
      // To the rounding of its square root.
      add(held, "force_N: " + by, run.largest_N, limit_N * (1.0 + 1e-12));
    };
    Thrown thrown = throw_tool(method);
    add_run({"", "", 0}, "jumps of 50 mm", thrown);
    add({"", "", 0}, "settled_ms: jumps of 50 mm", thrown.settled * kTick_s / 1e-3, kWithin_ms);
    result.traces.push_back({"proxy_thrown", "50 mm in, back, out and back", method, kTick_s,
                             std::move(thrown.force_N), std::move(thrown.depth_mm)});
    const std::uint64_t ticks = options.brief ? 1000 : 3000;
    for (const double length_ms : {0.001, 10.0, 100.0}) {
      std::vector<LateTick> late;
      for (std::uint64_t tick = 37; tick < ticks; tick += 73) {
        late.push_back({tick, 1e-3 * length_ms - kTick_s});
      }
      add_run(kTapping, with_number("ticks of %g ms", length_ms),
              tap(method, std::move(late), ticks));
    }
  }
  return result;
}

// Case 19. Every tick a little late, some by up to 16 ms, while a hand taps at 20 mm/s. Velocity:
// of the tool as a tick takes it, from two poses a nominal tick apart, which is to be no more than
// in the same taps on time or than a voxel a tick, the limit of [McNeely et al. 1999]; one quantum
// of the encoders is already 55 mm/s. Force step: as felt, held to the cap of the device's edge
// behind it.
CaseResult late_tick(const CaseOptions& options) {
  constexpr double kMostStep_N = 0.5, kVoxelATick_mm_per_s = 34.8;
  CaseResult result;
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
  for (const ContactMethod method : options.methods) {
    const Tapped on_time = tap(method, {}, kTicks);
    Tapped run = tap(method, late, kTicks);
    const auto add = [&](std::string quantity, double value, std::optional<double> limit = {}) {
      result.rows.push_back(
          row_of("late_tick", method, kTapping, 0.0, std::move(quantity), value, limit));
    };
    add("not_finite", run.finite ? 0.0 : 1.0, 0.0);
    add("force_step_N", run.largest_step_N, kMostStep_N);
    add("force_step_on_time_N", on_time.largest_step_N);
    add("sent_step_N", run.largest_sent_step_N, kMostStep_N * (1.0 + 1e-12));
    add("step_limited_ticks", static_cast<double>(run.step_limited_ticks));
    add("handle_mm_per_s", run.fastest_handle_m_per_s / kMillimetre);
    add("handle_on_time_mm_per_s", on_time.fastest_handle_m_per_s / kMillimetre);
    add("tool_mm_per_s", run.fastest_tool_m_per_s / kMillimetre,
        std::max(kVoxelATick_mm_per_s, on_time.fastest_tool_m_per_s / kMillimetre) * (1.0 + 1e-9));
    add("tool_on_time_mm_per_s", on_time.fastest_tool_m_per_s / kMillimetre);
    result.traces.push_back({"late_tick", "gaps up to 16 ms", method, kTick_s,
                             std::move(run.force_N), std::move(run.depth_mm)});
  }
  return result;
}

}  // namespace sulcus::lab
