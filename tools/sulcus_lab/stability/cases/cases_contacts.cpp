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
#include "haptics/evaluate_contact.hpp"
#include "tools/sulcus_lab/stability/cases/case_solids.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/stability/series.hpp"

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
CaseResult vanishing_voxels(const CaseOptions& options) {
  constexpr double kStep_N = 0.02;
  constexpr int kSettle = 100, kAfter = 50;
  struct Solid {
    const char* name;
    VoxelModel model;
  };
  std::vector<Solid> solids{{"wall", wall_solid(12)}};
  if (!options.brief) solids.push_back({"V of 60 degrees", groove_solid(60 * kDegree, 0.0)});
  const std::vector<int> shares = {1, 10, 50};
  const std::vector<unsigned> seeds =  // 0: the deepest
      options.brief ? std::vector<unsigned>{0, 1} : std::vector<unsigned>{0, 1, 2, 3, 4};
  CaseResult result;
  for (const ContactMethod method : options.methods) {
    if (method == ContactMethod::kSinglePoint) continue;  // it has one contact
    const Scene scene =
        method_scene(method, case_text("tangential_ratio = 0\n[cutting]\n[loose_pieces]\n"));
    const double depth_mm = scene.coupling ? 1.0 / kCaseSpring_N_per_mm : 0.1;
    const Vector3d place(0.23 * kCaseVoxel_mm, 0.41 * kCaseVoxel_mm, 0.0);
    const std::vector<Pose> path =
        case_path({place + Vector3d(0, 0, 0.05), place - Vector3d(0, 0, depth_mm)}, 10.0, kSettle);
    for (const Solid& solid : solids) {
      for (const int share : shares) {
        double felt_step_N = 0.0, contact_step_N = 0.0;
        std::size_t contacts = 0;
        for (const unsigned seed : seeds) {
          Rig rig(method, scene, solid.model);
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
              1,
              static_cast<std::size_t>(std::lround(0.01 * share * static_cast<double>(contacts))));
          voxels.resize(std::min(gone, voxels.size()));
          std::vector<Felt> ticks{before, rig.step(device, voxels)};
          for (int t = 1; t < kAfter; ++t) ticks.push_back(rig.step(device));
          felt_step_N = std::max(felt_step_N, largest_step_N(ticks));
          for (std::size_t t = 1; t < ticks.size(); ++t) {
            contact_step_N = std::max(
                contact_step_N, (ticks[t].contact_force_N - ticks[t - 1].contact_force_N).norm());
          }
          if (share == 50 && seed == 1 && &solid == solids.data()) {
            result.traces.push_back(
                case_trace("vanishing_voxels", method, "half of them, wall", ticks));
          }
        }
        const std::string setting =
            std::to_string(share) + " % of " + std::to_string(contacts) + " on a " + solid.name;
        result.rows.push_back(
            case_row("vanishing_voxels", method, "felt_step_N", setting, felt_step_N, kStep_N));
        result.rows.push_back(
            case_row("vanishing_voxels", method, "contact_step_N", setting, contact_step_N));
      }
    }
  }
  return result;
}

/// By 0.25 um a tick into a face, where at 1 um several voxels enter at once, and by 1 um over
/// voxels that stand alone: there a contact has its depth when
/// the next one enters with none. The jump is what the step of that tick differs by from its
/// neighbours', as a share of the force 0.1 mm deep in a face. Behind the coupling also with the
/// tool itself put there, where nothing but the contact's own weights counts.
CaseResult count_steps(const CaseOptions& options) {
  constexpr double kJump = 0.02;
  struct Run {
    const char* name;
    VoxelModel solid;
    Vector3d from_mm, to_mm;
    double step_um;
  };
  const Vector3d aslant(0.13 * kCaseVoxel_mm, 0.29 * kCaseVoxel_mm, 0.0);
  const auto deep = [](double mm) -> Vector3d { return -mm * Vector3d::UnitZ(); };
  const Vector3d along = kCaseVoxel_mm * Vector3d(12.0, 0.4, 0.0);
  std::vector<Run> runs{
      {"into a face", wall_solid(12), aslant, aslant + deep(0.1), 0.25},
      {"over pins 12 voxels apart", pins_solid(12), aslant + deep(0.1), along + deep(0.1), 1.0}};
  if (!options.brief) {
    runs.push_back(
        {"over pins 5 voxels apart", pins_solid(5), aslant + deep(0.1), along + deep(0.1), 1.0});
  }
  CaseResult result;
  for (const ContactMethod method : options.methods) {
    if (method == ContactMethod::kSinglePoint) continue;  // it has one contact
    const Scene scene = method_scene(method, case_text());
    Scene put = scene;
    put.coupling.reset();
    const auto measure = [&](const Scene& s, const std::string& how) {
      double whole_N = 0.0;
      for (const Run& run : runs) {
        std::vector<Pose> path =
            case_path({run.from_mm + Vector3d(0, 0, 0.15), run.from_mm}, 10.0, 50);
        const auto begins = static_cast<std::ptrdiff_t>(path.size()) - 1;
        go_on(path, run.to_mm, run.step_um);  // um a tick are mm/s
        const std::vector<Felt> all = run_path(method, s, run.solid, path);
        const std::vector<Felt> ticks(all.begin() + begins, all.end());
        if (&run == runs.data()) whole_N = ticks.back().force_N.norm();
        for (const auto& [low, high] : {std::pair{1u, 2u}, std::pair{9u, 11u}}) {
          const std::optional<double> jump = jump_N(ticks, low, high);
          if (!jump) continue;
          const std::string setting = std::string(run.name) + " " + std::to_string(low) + " to " +
                                      std::to_string(high) + " contacts" + how;
          result.rows.push_back(
              case_row("count_steps", method, "jump_share", setting, *jump / whole_N, kJump));
        }
        if (&run == &runs[1] && how.empty()) {
          result.traces.push_back(case_trace("count_steps", method, run.name, ticks));
        }
      }
    };
    measure(scene, "");
    if (scene.coupling) measure(put, " tool put there");
  }
  return result;
}

/// From above, a rest 0.1 mm past its top, and on sideways over it; from the side, level with it.
CaseResult spur(const CaseOptions& options) {
  constexpr double kFelt_N = 0.2, kDepth_mm = 0.1, kSpeed_mm_per_s = 10.0;
  struct Solid {
    const char* name;
    VoxelModel model;
  };
  const Solid solids[] = {{"column", column_solid(24)}, {"lone voxel", column_solid(1)}};
  const std::vector<Vector3d> places =  // voxels from the column's axis
      options.brief ? std::vector<Vector3d>{{0.3, 0.2, 0.0}}
                    : std::vector<Vector3d>{{0, 0, 0}, {0.3, 0.2, 0.0}, {0.5, 0.5, 0.0}};
  const Vector3d axis = kCaseVoxel_mm * Vector3d(0.5, 0.5, 0.0);
  CaseResult result;
  for (const ContactMethod method : options.methods) {
    const Scene scene = method_scene(method, case_text());
    for (const Solid& solid : solids) {
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
        kept = run_path(method, scene, solid.model, path);
        from_above_N = std::max(from_above_N, largest_N(kept));
        const Vector3d aside = deep - 0.5 * Vector3d::UnitX();
        from_side_N = std::max(
            from_side_N,
            largest_N(run_path(method, scene, solid.model,
                               case_path({aside, aside + Vector3d::UnitX()}, kSpeed_mm_per_s))));
      }
      result.rows.push_back(case_row("spur", method, "felt_N",
                                     std::string(solid.name) + " from above", from_above_N,
                                     kFelt_N));
      result.rows.push_back(case_row("spur", method, "felt_N",
                                     std::string(solid.name) + " slid over", from_side_N, kFelt_N));
      result.traces.push_back(case_trace("spur", method, solid.name, kept));
    }
  }
  return result;
}

/// In grooves pressed down their middle, 2 N behind the coupling and 0.1 mm deep without, and slid
/// along. Felt stiffness: from first contact on, over the device's spring behind the coupling (and
/// for the single point, which stands for its ball's lowest point), else over a face's force at the
/// same depth; judged from 1 N up. In slots let down, slid along, and pushed to either side, where
/// symmetry is that both sides answer alike.
CaseResult wedge(const CaseOptions& options) {
  constexpr double kSide = 0.05, kPeak_N = 0.1, kJudged_N = 1.0, kSpeed_mm_per_s = 5.0;
  struct Groove {
    int degrees;
    std::optional<double> share;
  };
  const std::vector<Groove> grooves =
      options.brief
          ? std::vector<Groove>{{30, 0.75}, {60, 0.85}}
          : std::vector<Groove>{{10, {}}, {20, {}}, {30, 0.75}, {45, {}}, {60, 0.85}, {90, 0.9}};
  const std::vector<double> phases =
      options.brief ? std::vector<double>{0.0} : std::vector<double>{0.0, 0.25, 0.5};
  const std::vector<int> slots =
      options.brief ? std::vector<int>{28} : std::vector<int>{28, 29, 30};
  const Vector3d slide = 10.0 * kCaseVoxel_mm * Vector3d::UnitY();
  CaseResult result;
  for (const ContactMethod method : options.methods) {
    const Scene scene = method_scene(method, case_text());
    const bool held = is_held_outside(method);
    const auto add = [&](const char* quantity, const std::string& setting, double value,
                         std::optional<double> limit, bool at_least = false) {
      result.rows.push_back(case_row("wedge", method, quantity, setting, value, limit, at_least));
    };
    const double deep_mm = held ? 2.0 / kCaseSpring_N_per_mm : 0.1;
    const double face_N =
        held ? 0.0
             : run_path(method, scene, wall_solid(12),
                        case_path({{0, 0, 0.02}, {0, 0, -deep_mm}}, kSpeed_mm_per_s, 50))
                   .back()
                   .force_N.z();
    for (const Groove& groove : grooves) {
      double share = HUGE_VAL, side = 0.0, peak_N = 0.0;
      const std::string setting = "V of " + std::to_string(groove.degrees) + " degrees";
      for (const double phase : phases) {
        // Where the voxels are not symmetric, a tool that is put in the middle is not in theirs.
        if (!held && phase != 0.0 && phase != 0.5) continue;
        const Vector3d middle(phase * kCaseVoxel_mm, -0.5 * slide.y(), 0.0);
        const Vector3d deep = middle - deep_mm * Vector3d::UnitZ();
        std::vector<Pose> path =
            case_path({middle + 0.1 * Vector3d::UnitZ(), deep}, kSpeed_mm_per_s, 100);
        const std::size_t slides = path.size();
        go_on(path, deep + slide, kSpeed_mm_per_s);
        const std::vector<Felt> ticks =
            run_path(method, scene, groove_solid(groove.degrees * kDegree, phase), path);
        const auto pressed = std::span(ticks).subspan(slides - 1);
        for (const Felt& felt : pressed) {
          side = std::max(side, std::abs(felt.force_N.x()) / std::max(1e-9, felt.force_N.norm()));
        }
        peak_N = std::max(peak_N, side_peak_to_peak_N(pressed));
        if (held) {
          for (std::size_t t = 0; t < slides; ++t) {
            const Felt& felt = ticks[t];
            if (felt.force_N.z() < kJudged_N && t + 1 < slides) continue;
            const double spring_N = kCaseSpring_N_per_mm / kMillimetre * -felt.device.position.z();
            share = std::min(share, felt.force_N.z() / spring_N);
          }
        } else {
          share = std::min(share, ticks[slides - 1].force_N.z() / face_N);
        }
        if (groove.degrees == 30 && phase == 0.0) {
          result.traces.push_back(case_trace("wedge", method, setting, ticks));
        }
      }
      add("felt_stiffness_share", setting, share, groove.share, true);
      add("side_share", setting, side, kSide);
      add("side_peak_to_peak_N", setting, peak_N, kPeak_N);
    }
    for (const int voxels : slots) {
      const std::string setting = "slot of " + std::to_string(voxels) + " voxels";
      const VoxelModel slot = slot_solid(voxels);
      const Vector3d middle(slot_middle_m(voxels) / kMillimetre, -0.5 * slide.y(), 0.0);
      const Vector3d deep = middle - 0.9 * Vector3d::UnitZ();
      std::vector<Pose> down = case_path({middle, deep}, kSpeed_mm_per_s, 50);
      std::vector<Pose> path = down;
      go_on(path, deep + slide, kSpeed_mm_per_s);
      add("side_peak_to_peak_N", setting, side_peak_to_peak_N(run_path(method, scene, slot, path)),
          kPeak_N);
      double pushed_N[2] = {};
      const double push_mm = held ? 1.0 : 0.1;
      for (const int side : {0, 1}) {
        path = down;
        go_on(path, deep + (side == 0 ? -push_mm : push_mm) * Vector3d::UnitX(), kSpeed_mm_per_s,
              50);
        pushed_N[side] = std::abs(run_path(method, scene, slot, path).back().force_N.x());
      }
      const double larger_N = std::max({pushed_N[0], pushed_N[1], 1e-9});
      add("side_asymmetry", setting, std::abs(pushed_N[0] - pushed_N[1]) / larger_N, kSide);
    }
  }
  return result;
}

}  // namespace sulcus::lab
