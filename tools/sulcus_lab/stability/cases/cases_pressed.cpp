#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/units.hpp"
#include "engine/scene/device_presets.hpp"
#include "haptics/device/buzz_detector.hpp"
#include "haptics/device/device_port.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/stability/held_face.hpp"
#include "tools/sulcus_lab/stability/wall_loop.hpp"
#include "tools/sulcus_lab/statistics.hpp"

namespace sulcus::lab {

// What a device and a hand make of a flat face on which they press: cases 5 and 13.

namespace {

using Eigen::Vector3d;

constexpr double kPush_N = 1.0;

std::span<const double> last(std::span<const double> values, std::size_t count,
                             std::size_t before_end = 0) {
  return values.subspan(values.size() - before_end - count, count);
}

/// One run: at 20 mm/s to the face, then pushed.
struct Pressed {
  std::vector<double> force_N, handle_m, read_m;  // felt, true, as it was read
  double deepest_m = 0.0;                         // of the tool; once through, the run is over
  bool popped() const { return deepest_m > kCaseRadius_m; }
  int first_fall = -1;  // tick in which the force has first turned round
  int first_buzz = -1;  // in which the detector speaks
};

constexpr int kPressedTicks = 1000;   // 0.4 s to touch and be pushed, the rest to be judged in
constexpr std::size_t kJudged = 600;  // ticks

Pressed press(ContactMethod method, const Scene& scene) {
  // So far beyond the face that the hand's spring overcomes the friction twice.
  const double beyond_m = 2.0 * scene.device->friction_N / scene.device->hand.stiffness_N_per_m;
  HeldTool tool(method, scene,
                hand_along({Vector3d(0, 0, 0.2e-3), Vector3d(0, 0, -beyond_m)}, 20e-3));
  const double threshold_N = buzz_threshold_N(felt_stiffness(scene), scene.device->resolution_m);
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
                            ? buzz(felt.force_N, threshold_N, kHeldTick_s, heard)
                            : (felt.faults & kFaultBuzz) != 0;
    if (buzzes && run.first_buzz < 0) run.first_buzz = tick;
  }
  return run;
}

/// F(depth) of a method at a tissue stiffness of 1 N/m, the tool where it is put.
class ContactCurve {
 public:
  explicit ContactCurve(ContactMethod method) {
    const Scene scene = method_scene(method, face_text(), 1.0);
    Rig rig(method, scene);
    PathDevice path(path_along({Vector3d(0, 0, kStep_m), Vector3d(0, 0, -kCaseRadius_m)},
                               kStep_m * kHeldRate_hz));
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

// Case 5. At 0.5 to 1.5 of the largest felt stiffness that is stable in that very loop, friction
// and quanta included. A tool that went through has no peaks to be measured: infinite. The time to
// the detector's first word counts from the force's first turn.
void buzz_case(CaseTrial& trial) {
  constexpr double kMostQuanta = 1.5, kWithin_ms = 50.0;
  std::vector<Held> loops;
  for (const std::string_view hand : kHandPresetNames) {
    for (const int delay : {0, 1}) loops.push_back({"omni", hand, delay});
  }
  const FeltFace face(trial.method);
  for (const Held& held : loops) {
    // All for ours only; the rest is measured against it where the hand is lightest.
    const bool is_first = held.hand == "light" && held.delay_ticks == 0;
    if (!is_first && trial.method != ContactMethod::kCoupling) continue;
    if (trial.brief && !is_first) continue;
    const DeviceSettings device = device_of(held, kPush_N);
    const double largest = largest_stable(trial.method, face, device);
    const auto add = [&](const char* quantity, const std::string& setting, double value,
                         const RowLimit& limit = {}) {
      in_loop(trial.add(quantity, setting, value, limit), held, kPush_N);
    };
    const auto pressed_at = [&](double part) {
      const double k = part * (largest > 0.0 ? largest : linear_limit(device));
      Pressed run = press(trial.method, face.scene(device, kPush_N, k));
      if (held.hand == "light" && held.delay_ticks == 0 && (part == 0.79 || part == 1.1)) {
        trial.trace(with_number("%.2f of the largest stable", part),
                    {run.force_N.begin(), run.force_N.end()});
      }
      const double quantum_N = k * device.resolution_m;
      return std::pair{std::move(run), quantum_N};
    };
    add("largest_stable_N_per_m", "", largest);
    for (const double part : {0.5, 0.6, 0.7, 0.79}) {
      const auto [run, quantum_N] = pressed_at(part);
      add("peak_to_peak_quanta", with_number("at %.2f", part),
          run.popped() ? HUGE_VAL : peak_to_peak(last(run.force_N, kJudged)) / quantum_N,
          at_most(kMostQuanta));
    }
    for (const double part : {1.1, 1.5}) {
      const Pressed run = pressed_at(part).first;
      const double after_ms =
          run.first_buzz < 0 ? HUGE_VAL : (run.first_buzz - run.first_fall) * kHeldTick_s / 1e-3;
      add("detected_after_ms", with_number("at %.1f", part), after_ms,
          part == 1.1 ? at_most(kWithin_ms) : RowLimit());
    }
  }
}

// Case 13. The proxy is quasi-static and has no mass of its own, so that the range of masses, which
// was meant for one with a mass, is given to the device instead. Growth: RMS of the handle over the
// last 0.3 s by that over the 0.3 s before, or by one resolution where that was less. Felt
// stiffness: from the force and the depth as read, between pushes of 1 and 2 N, against the
// coupling and the contact in series, whose curve is measured with the tool where it is put.
void coupling_mismatch(CaseTrial& trial) {
  constexpr double kMostGrowth = 1.0, kMostError = 0.05;
  constexpr std::size_t kHalf = 300;
  const ContactCurve curve(ContactMethod::kSmooth);
  const double tissue = stiffness_of(trial.method);
  const std::vector<double> masses_g = trial.settings<double>({1}, {1, 3, 10, 45, 100});
  for (const double mass_g : masses_g) {
    for (const int delay : {0, 1}) {
      if (trial.brief && delay > 0) continue;
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
          Scene scene = face_scene(trial.method, device);
          scene.coupling->stiffness_N_per_m = k;
          const Pressed run = press(trial.method, scene);
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
      const auto add = [&](const char* quantity, double value, const RowLimit& most = {}) {
        in_loop(trial.add(quantity, "", value, most), held, 2.0).device +=
            with_number(", %g g", mass_g);
      };
      add("own_limit_N_per_m", limit);
      add("growth", growth, at_most(kMostGrowth));
      add("series_error", error, at_most(kMostError));
    }
  }
}

}  // namespace sulcus::lab
