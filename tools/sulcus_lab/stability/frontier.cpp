#include "tools/sulcus_lab/stability/frontier.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <tbb/parallel_for.h>

#include "engine/core/realtime.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/device_presets.hpp"
#include "tools/sulcus_lab/stability/pushes.hpp"
#include "tools/sulcus_lab/stability/wall_loop.hpp"

namespace sulcus::lab {

namespace {

constexpr std::array<ContactMethod, 6> kDrawnMethods{
    ContactMethod::kCoupling, ContactMethod::kSmooth,  ContactMethod::kCount,
    ContactMethod::kNone,     ContactMethod::kMcNeely, ContactMethod::kSinglePoint};
constexpr std::array<const char*, 4> kDiameters_mm{"1.0", "0.4", "2.0", "4.0"};
constexpr double kStiffnessRatio = 1.5;
constexpr int kSteps = 26;

/// Where a method's stiffness begins: per contact it is a part of the whole one's.
double first_stiffness(ContactMethod method) {
  if (method == ContactMethod::kNone) return 2.0;
  if (method == ContactMethod::kMcNeely) return 20.0;
  return 100.0;
}

std::string face_text(const std::string& diameter_mm, double tilt_deg) {
  return "tissue = ['enamel']\n[workpiece]\nshape = 'plate'\ncells = [160, 160, 160]\n"
         "plate.thickness_mm = 2.0\nplate.tilt_deg = " +
         std::to_string(tilt_deg) + "\n[burr]\nshape = 'round'\ndiameter_mm = " + diameter_mm +
         "\nfield = 'auto'\n";
}

PushResult push_on_face(ContactMethod method, const std::string& diameter_mm,
                        double stiffness_N_per_m) {
  Push push;
  push.method = method;
  push.delay = 1;
  return run_push(push, face_text(diameter_mm, 0.0), {0.0, 0.0, 1.4e-3}, 2e-3, stiffness_N_per_m);
}

FrontierPoint frontier_of(ContactMethod method, const std::string& diameter_mm) {
  FrontierPoint point;
  point.method = method;
  point.felt_hold_N_per_mm = point.felt_buzz_N_per_mm = std::numeric_limits<double>::quiet_NaN();
  bool buzzes = false;
  double stiffness = first_stiffness(method);
  for (int step = 0; step < kSteps && !buzzes; ++step, stiffness *= kStiffnessRatio) {
    const PushResult r = push_on_face(method, diameter_mm, stiffness);
    // One that has popped through rests on nothing: neither bound can be read from it.
    const bool holds = r.reached && !r.popped && r.contact_N > 0.5;
    if (!holds && r.stable()) continue;
    buzzes = !r.stable();
    if (buzzes) break;
    point.contacts = std::max(point.contacts, r.contacts);
    const double felt = r.stiffness_N_per_m / kNewtonPerMillimetre;
    if (std::isnan(point.felt_hold_N_per_mm)) point.felt_hold_N_per_mm = felt;
    point.felt_buzz_N_per_mm = felt;
  }
  return point;
}

}  // namespace

std::vector<FrontierPoint> measure_frontier(bool brief) {
  const std::size_t burrs = brief ? 1 : kDiameters_mm.size();
  std::vector<FrontierPoint> points(kDrawnMethods.size() * burrs);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    points[i] = frontier_of(kDrawnMethods[i / burrs], kDiameters_mm[i % burrs]);
  });
  return points;
}

std::vector<DampingPoint> measure_damping() {
  std::vector<DampingPoint> points;
  for (const HandPreset& hand : hand_presets()) {
    for (const int delay : {0, 1}) {
      for (double damping = 0.0; damping <= 100.0; damping += 2.5) {
        WallLoop loop;
        loop.device = device_preset("omni");
        loop.device.hand = hand.settings;
        loop.device.delay_ticks = delay;
        loop.wall_damping_N_s_per_m = damping;
        points.push_back({std::string(hand.name) + " hand, delay " + std::to_string(delay), damping,
                          spectral_limit(loop) / kNewtonPerMillimetre});
      }
    }
  }
  return points;
}

std::vector<SpeedErrorPoint> measure_speed_error() {
  std::vector<SpeedErrorPoint> points;
  const double tilt = 20.0 * kDegree;
  const Eigen::Vector3d out(std::sin(tilt), 0.0, std::cos(tilt));
  const Eigen::Vector3d along(std::cos(tilt), 0.0, -std::sin(tilt));
  for (const ContactMethod method : kDrawnMethods) {
    for (const int neighbourhood : {2, 4, 6}) {
      // One that does not fit a map has no neighbourhood.
      if (method == ContactMethod::kSinglePoint && neighbourhood != 6) continue;
      Scene scene = method_scene(method, face_text("1.0", 20.0));
      scene.haptics.neighbourhood = neighbourhood;
      Rig rig(method, scene);
      const double felt_N_per_m =
          scene.coupling ? scene.coupling->stiffness_N_per_m
                         : stiffness_of(method) * (method == ContactMethod::kNone ? 20.0 : 1.0);
      const double depth_m = std::min(1.0 / felt_N_per_m, scene.coupling ? 1.0 : 0.25e-3);
      const auto tip_at = [&](double way_m, double height_m) {
        const Eigen::Vector3d middle = (1e-3 + 0.5e-3 + height_m) * out + way_m * along;
        return Eigen::Vector3d(middle - 0.5e-3 * Eigen::Vector3d::UnitZ());
      };
      PathDevice path(path_along(
          {tip_at(-0.7e-3, 0.1e-3), tip_at(-0.7e-3, -depth_m), tip_at(0.7e-3, -depth_m)}, 10e-3));
      const auto slide_ticks = static_cast<std::size_t>(1.4e-3 / 10e-6);
      std::vector<Eigen::Vector3d> forces;
      std::uint64_t ns = 0;
      for (std::size_t tick = 0; tick < path.ticks(); ++tick) {
        const std::uint64_t begin = thread_cpu_ns();
        const Felt felt = rig.step(path);
        if (tick + slide_ticks < path.ticks() + 10) continue;
        ns += thread_cpu_ns() - begin;
        forces.push_back(felt.force_N);
      }
      double mean_N = 0.0, squares = 0.0;
      const auto n = static_cast<double>(forces.size());
      for (const Eigen::Vector3d& force : forces) mean_N += force.dot(out) / n;
      for (const Eigen::Vector3d& force : forces)
        squares += (force - mean_N * out).squaredNorm() / n;
      points.push_back({method, 1e-3 * static_cast<double>(ns) / n,
                        mean_N > 0.0 ? 100.0 * std::sqrt(squares) / mean_N : HUGE_VAL});
    }
  }
  return points;
}

}  // namespace sulcus::lab
