#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/units.hpp"
#include "haptics/contact/evaluate_contact.hpp"
#include "tools/sulcus_lab/stability/cases/case_solids.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/statistics.hpp"

namespace sulcus::lab {

// Contacts that come and go, and too few or too many of them: cases 9, 10, 14 and 16.

using Eigen::Vector3d;

namespace {

/// Voxels that take part in the contact where a tool is, the deepest first.
std::vector<std::uint32_t> voxels_in_contact(const Rig& rig, const Pose& tool) {
  const Simulation& simulation = rig.simulation();
  const Scene& scene = simulation.scene();
  ContactScratch scratch(scene.haptics);
  evaluate_contact(simulation.workpiece(), {simulation.burr(), tool, scene.tissues, scene.haptics},
                   scratch);
  std::vector<Contact> found;
  for (const Contact contact : scratch.contacts) {
    if (contact.weight > 0.0f) found.push_back(contact);
  }
  std::ranges::stable_sort(found, std::greater(), &Contact::depth_m);
  std::vector<std::uint32_t> voxels;
  voxels.reserve(found.size());
  for (const Contact& contact : found) {
    voxels.push_back(simulation.workpiece().grid().linear(contact.cell));
  }
  return voxels;
}

/// The largest jump at a change of the count between `low` and `high`: the second difference of the
/// force, so that what a step of the way itself changes is left out. None: no such change.
std::optional<double> jump_N(std::span<const Felt> ticks, std::uint32_t low, std::uint32_t high) {
  std::optional<double> largest;
  const auto step = [&](std::size_t t) -> Vector3d {
    return ticks[t].force_N - ticks[t - 1].force_N;
  };
  for (std::size_t t = 2; t + 1 < ticks.size(); ++t) {
    const auto [less, more] = std::minmax(ticks[t - 1].contacts, ticks[t].contacts);
    if (less == more || less < low || more > high) continue;
    const double jump = (step(t) - 0.5 * (step(t - 1) + step(t + 1))).norm();
    largest = std::max(largest.value_or(0.0), jump);
  }
  return largest;
}

/// Across the groove or slot, along x.
double side_peak_to_peak_N(std::span<const Felt> ticks) {
  std::vector<double> side_N;
  side_N.reserve(ticks.size());
  for (const Felt& felt : ticks) side_N.push_back(felt.force_N.x());
  return peak_to_peak(side_N);
}

}  // namespace

/// At rest on a wall and in a groove, felt 1 N behind the coupling, else 0.1 mm deep: so many of
/// the voxels in contact go, by chance or the deepest first. The largest step of the force in the
/// 50 ticks from then on.
void vanishing_voxels(CaseTrial& trial) {
  constexpr double kStep_N = 0.02;
  constexpr int kSettle = 100, kAfter = 50;
  std::vector<NamedSolid> solids{{"wall", wall_solid(12)}};
  if (!trial.brief) solids.push_back({"V of 60 degrees", groove_solid(60 * kDegree, 0.0)});
  const std::vector<int> shares = {1, 10, 50};
  const std::vector<unsigned> seeds =  // 0: the deepest
      trial.settings<unsigned>({0, 1}, {0, 1, 2, 3, 4});
  const Scene scene =
      method_scene(trial.method, case_text("tangential_ratio = 0\n[cutting]\n[loose_pieces]\n"));
  const double depth_mm = scene.coupling ? 1.0 / kCaseSpring_N_per_mm : 0.1;
  const Vector3d place(0.23 * kCaseVoxel_mm, 0.41 * kCaseVoxel_mm, 0.0);
  const std::vector<Pose> path =
      case_path({place + Vector3d(0, 0, 0.05), place - Vector3d(0, 0, depth_mm)}, 10.0, kSettle);
  for (const NamedSolid& solid : solids) {
    for (const int share : shares) {
      double felt_step_N = 0.0, contact_step_N = 0.0;
      std::size_t contacts = 0;
      for (const unsigned seed : seeds) {
        Rig rig(trial.method, scene, solid.model);
        PathDevice device(path);
        Felt before;
        for (std::size_t t = 0; t < path.size(); ++t) before = rig.step(device);
        std::vector<std::uint32_t> voxels = voxels_in_contact(rig, before.tool);
        contacts = voxels.size();
        std::mt19937 random(seed);
        for (std::size_t i = voxels.size(); seed > 0 && i > 1; --i) {
          std::swap(voxels[i - 1], voxels[random() % i]);
        }
        const auto gone = std::max<std::size_t>(
            1, static_cast<std::size_t>(std::lround(0.01 * share * static_cast<double>(contacts))));
        voxels.resize(std::min(gone, voxels.size()));
        std::vector<Felt> ticks{before, rig.step(device, voxels)};
        for (int t = 1; t < kAfter; ++t) ticks.push_back(rig.step(device));
        felt_step_N = std::max(felt_step_N, largest_step_N(ticks));
        for (std::size_t t = 1; t < ticks.size(); ++t) {
          contact_step_N = std::max(
              contact_step_N, (ticks[t].contact_force_N - ticks[t - 1].contact_force_N).norm());
        }
        if (share == 50 && seed == 1 && &solid == solids.data()) {
          trial.trace("half of them, wall", ticks);
        }
      }
      const std::string setting =
          std::to_string(share) + " % of " + std::to_string(contacts) + " on a " + solid.name;
      trial.add("felt_step_N", setting, felt_step_N, at_most(kStep_N));
      trial.add("contact_step_N", setting, contact_step_N);
    }
  }
}

/// By 0.25 um a tick into a face, where at 1 um several voxels enter at once, and by 1 um over
/// voxels that stand alone: there a contact has its depth when
/// the next one enters with none. The jump is what the step of that tick differs by from its
/// neighbours', as a share of the force 0.1 mm deep in a face. Behind the coupling also with the
/// tool itself put there, where nothing but the contact's own weights counts.
void count_steps(CaseTrial& trial) {
  constexpr double kJump = 0.02;
  struct Run {
    const char* name;
    VoxelModel solid;
    Vector3d from_mm, to_mm;
    double step_um;
  };
  const Vector3d beside(0.13 * kCaseVoxel_mm, 0.29 * kCaseVoxel_mm, 0.0);
  const auto deep = [](double mm) -> Vector3d { return -mm * Vector3d::UnitZ(); };
  const Vector3d along = kCaseVoxel_mm * Vector3d(12.0, 0.4, 0.0);
  std::vector<Run> runs{
      {"into a face", wall_solid(12), beside, beside + deep(0.1), 0.25},
      {"over pins 12 voxels apart", pins_solid(12), beside + deep(0.1), along + deep(0.1), 1.0}};
  if (!trial.brief) {
    runs.push_back(
        {"over pins 5 voxels apart", pins_solid(5), beside + deep(0.1), along + deep(0.1), 1.0});
  }
  const Scene scene = method_scene(trial.method, case_text());
  Scene put = scene;
  put.coupling.reset();
  const auto measure = [&](const Scene& s, const std::string& how) {
    double whole_N = 0.0;
    for (const Run& run : runs) {
      std::vector<Pose> path =
          case_path({run.from_mm + Vector3d(0, 0, 0.15), run.from_mm}, 10.0, 50);
      const auto begins = static_cast<std::ptrdiff_t>(path.size()) - 1;
      go_on(path, run.to_mm, run.step_um);  // um a tick are mm/s
      const std::vector<Felt> all = run_path(trial.method, s, run.solid, path);
      const std::vector<Felt> ticks(all.begin() + begins, all.end());
      if (&run == runs.data()) whole_N = ticks.back().force_N.norm();
      for (const auto& [low, high] : {std::pair{1u, 2u}, std::pair{9u, 11u}}) {
        const std::optional<double> jump = jump_N(ticks, low, high);
        if (!jump) continue;
        const std::string setting = std::string(run.name) + " " + std::to_string(low) + " to " +
                                    std::to_string(high) + " contacts" + how;
        trial.add("jump_share", setting, *jump / whole_N, at_most(kJump));
      }
      if (&run == &runs[1] && how.empty()) trial.trace(run.name, ticks);
    }
  };
  measure(scene, "");
  if (scene.coupling) measure(put, " tool put there");
}

/// From above, a rest 0.1 mm past its top, and on sideways over it; from the side, level with it.
void spur(CaseTrial& trial) {
  constexpr double kFelt_N = 0.2, kDepth_mm = 0.1, kSpeed_mm_per_s = 10.0;
  const NamedSolid solids[] = {{"column", column_solid(24)}, {"lone voxel", column_solid(1)}};
  const std::vector<Vector3d> places =  // voxels from the column's axis
      trial.settings<Vector3d>({{0.3, 0.2, 0.0}}, {{0, 0, 0}, {0.3, 0.2, 0.0}, {0.5, 0.5, 0.0}});
  const Vector3d axis = kCaseVoxel_mm * Vector3d(0.5, 0.5, 0.0);
  const Scene scene = method_scene(trial.method, case_text());
  for (const NamedSolid& solid : solids) {
    double from_above_N = 0.0, from_side_N = 0.0;
    std::vector<Felt> kept;
    const auto largest_N = [](std::span<const Felt> ticks) {
      double largest = 0.0;
      for (const Felt& felt : ticks) largest = std::max(largest, felt.force_N.norm());
      return largest;
    };
    for (const Vector3d& place : places) {
      const Vector3d over = axis + kCaseVoxel_mm * place;
      const Vector3d deep = over - kDepth_mm * Vector3d::UnitZ();
      std::vector<Pose> path =
          case_path({over + 0.05 * Vector3d::UnitZ(), deep}, kSpeed_mm_per_s, 50);
      go_on(path, deep + 0.5 * Vector3d::UnitX(), kSpeed_mm_per_s, 10);
      kept = run_path(trial.method, scene, solid.model, path);
      from_above_N = std::max(from_above_N, largest_N(kept));
      const Vector3d aside = deep - 0.5 * Vector3d::UnitX();
      from_side_N = std::max(
          from_side_N,
          largest_N(run_path(trial.method, scene, solid.model,
                             case_path({aside, aside + Vector3d::UnitX()}, kSpeed_mm_per_s))));
    }
    trial.add("felt_N", std::string(solid.name) + " from above", from_above_N, at_most(kFelt_N));
    trial.add("felt_N", std::string(solid.name) + " slid over", from_side_N, at_most(kFelt_N));
    trial.trace(solid.name, kept);
  }
}

namespace {

constexpr double kWedgeSpeed_mm_per_s = 5.0;
constexpr double kSide = 0.05, kSidePeak_N = 0.1;  // limits of what is felt across
const Vector3d kWedgeSlide_mm = 10.0 * kCaseVoxel_mm * Vector3d::UnitY();

/// Ticks of a groove, from where it is pressed down its middle, and the first that slides along.
struct Grooved {
  std::vector<Felt> ticks;
  std::size_t slides;
};
Grooved press_groove(ContactMethod method, const Scene& scene, double angle, double phase,
                     double deep_mm) {
  const Vector3d middle(phase * kCaseVoxel_mm, -0.5 * kWedgeSlide_mm.y(), 0.0);
  const Vector3d deep = middle - deep_mm * Vector3d::UnitZ();
  std::vector<Pose> path =
      case_path({middle + 0.1 * Vector3d::UnitZ(), deep}, kWedgeSpeed_mm_per_s, 100);
  const std::size_t slides = path.size();
  go_on(path, deep + kWedgeSlide_mm, kWedgeSpeed_mm_per_s);
  return {run_path(method, scene, groove_solid(angle, phase), path), slides};
}

/// Over the device's spring, from first contact on, judged from 1 N up.
double share_of_spring(const Grooved& run) {
  constexpr double kJudged_N = 1.0;
  double share = HUGE_VAL;
  for (std::size_t t = 0; t < run.slides; ++t) {
    const Felt& felt = run.ticks[t];
    if (felt.force_N.z() < kJudged_N && t + 1 < run.slides) continue;
    const double spring_N = kCaseSpring_N_per_mm / kMillimetre * -felt.device.position.z();
    share = std::min(share, felt.force_N.z() / spring_N);
  }
  return share;
}

void wedge_in_grooves(CaseTrial& trial, const Scene& scene) {
  struct Groove {
    int degrees;
    std::optional<double> share;
  };
  const bool held = is_held_outside(trial.method);
  const double deep_mm = held ? 2.0 / kCaseSpring_N_per_mm : 0.1;
  const std::vector<Pose> into_face =
      case_path({{0, 0, 0.02}, {0, 0, -deep_mm}}, kWedgeSpeed_mm_per_s, 50);
  const double face_N =
      held ? 0.0 : run_path(trial.method, scene, wall_solid(12), into_face).back().force_N.z();
  for (const Groove& groove :
       trial.settings<Groove>({{30, 0.75}, {60, 0.85}},
                              {{10, {}}, {20, {}}, {30, 0.75}, {45, {}}, {60, 0.85}, {90, 0.9}})) {
    double share = HUGE_VAL, side = 0.0, peak_N = 0.0;
    const std::string setting = "V of " + std::to_string(groove.degrees) + " degrees";
    for (const double phase : trial.settings<double>({0.0}, {0.0, 0.25, 0.5})) {
      // Where the voxels are not symmetric, a tool that is put in the middle is not in theirs.
      if (!held && phase != 0.0 && phase != 0.5) continue;
      const Grooved run =
          press_groove(trial.method, scene, groove.degrees * kDegree, phase, deep_mm);
      const auto pressed = std::span(run.ticks).subspan(run.slides - 1);
      for (const Felt& felt : pressed) {
        side = std::max(side, std::abs(felt.force_N.x()) / std::max(1e-9, felt.force_N.norm()));
      }
      peak_N = std::max(peak_N, side_peak_to_peak_N(pressed));
      share = std::min(share, held ? share_of_spring(run) : pressed.front().force_N.z() / face_N);
      if (groove.degrees == 30 && phase == 0.0) trial.trace(setting, run.ticks);
    }
    trial.add("felt_stiffness_share", setting, share, at_least(groove.share));
    trial.add("side_share", setting, side, at_most(kSide));
    trial.add("side_peak_to_peak_N", setting, peak_N, at_most(kSidePeak_N));
  }
}

void wedge_in_slots(CaseTrial& trial, const Scene& scene) {
  const double push_mm = is_held_outside(trial.method) ? 1.0 : 0.1;
  for (const int voxels : trial.settings<int>({28}, {28, 29, 30})) {
    const std::string setting = "slot of " + std::to_string(voxels) + " voxels";
    const VoxelModel slot = slot_solid(voxels);
    const Vector3d middle(slot_middle_m(voxels) / kMillimetre, -0.5 * kWedgeSlide_mm.y(), 0.0);
    const Vector3d deep = middle - 0.9 * Vector3d::UnitZ();
    const auto from_deep = [&](const Vector3d& way_mm, int rest_ticks) {
      std::vector<Pose> path = case_path({middle, deep}, kWedgeSpeed_mm_per_s, 50);
      go_on(path, deep + way_mm, kWedgeSpeed_mm_per_s, rest_ticks);
      return run_path(trial.method, scene, slot, path);
    };
    trial.add("side_peak_to_peak_N", setting, side_peak_to_peak_N(from_deep(kWedgeSlide_mm, 0)),
              at_most(kSidePeak_N));
    const auto pushed_N = [&](double way_mm) {
      return std::abs(from_deep(way_mm * Vector3d::UnitX(), 50).back().force_N.x());
    };
    const double one_N = pushed_N(-push_mm), other_N = pushed_N(push_mm);
    trial.add("side_asymmetry", setting,
              std::abs(one_N - other_N) / std::max({one_N, other_N, 1e-9}), at_most(kSide));
  }
}

}  // namespace

/// In grooves pressed down their middle, 2 N behind the coupling and 0.1 mm deep without, and slid
/// along. Felt stiffness: from first contact on, over the device's spring behind the coupling (and
/// for the single point, which stands for its ball's lowest point), else over a face's force at the
/// same depth. In slots let down, slid along, and pushed to either side, where symmetry is that
/// both sides answer alike.
void wedge(CaseTrial& trial) {
  const Scene scene = method_scene(trial.method, case_text());
  wedge_in_grooves(trial, scene);
  wedge_in_slots(trial, scene);
}

}  // namespace sulcus::lab
