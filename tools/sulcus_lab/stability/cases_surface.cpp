#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/units.hpp"
#include "engine/normals/normal_method.hpp"
#include "haptics/evaluate_contact.hpp"
#include "tools/sulcus_lab/stability/case_solids.hpp"
#include "tools/sulcus_lab/stability/cases.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr double kVoxel_mm = kCaseVoxel_m / kMillimetre;
constexpr double kRadius_mm = kCaseRadius_m / kMillimetre;
constexpr double kSpring_N_per_mm = 0.7;  // of [coupling] where no device is named

std::string text_of(double value, std::string_view unit) {
  std::ostringstream text;
  text << value << " " << unit;
  return text.str();
}

/// Stiffer than the default coupling: a Falcon's.
constexpr const char* kStiffCoupling =
    "[coupling]\nstiffness_N_per_mm = 3.0\nforce_limit_N = 8.0\n";

// --- edge_normals -------------------------------------------------------------------------------

/// Ways of the ball's middle over an edge along y at the origin, between two faces of 90 degrees
/// about the direction `up`.
struct EdgeWay {
  Vector3d up, across;
  double depth_mm;

  /// Down to the first face, along it, round the edge, and along the second, so deep all the way.
  std::vector<Vector3d> round_it(double step_mm) const {
    const double r = kRadius_mm - depth_mm, quarter = 0.25 * std::numbers::pi;
    const double face_mm = 0.5;
    const auto on_arc = [&](double angle) -> Vector3d {
      return r * (std::cos(angle) * up + std::sin(angle) * across);
    };
    const Vector3d first = on_arc(-quarter), last = on_arc(quarter);
    // A face leads down from the edge, across its own normal.
    const Vector3d begin = first - face_mm * last.normalized();
    std::vector<Vector3d> way{begin + 2.0 * depth_mm * first.normalized(), begin, first};
    const int steps = static_cast<int>(std::ceil(2.0 * quarter * r / step_mm));
    for (int s = 1; s <= steps; ++s) way.push_back(on_arc(quarter * (2.0 * s / steps - 1.0)));
    way.push_back(last - face_mm * first.normalized());
    return way;
  }
  /// Straight across, the tip so deep below the edge.
  std::vector<Vector3d> level() const {
    const Vector3d over = (kRadius_mm - depth_mm) * up;
    return {over - 0.5 * across, over + 0.5 * across};
  }
};

// --- vanishing_voxels ---------------------------------------------------------------------------

/// Voxels that take part in the contact where a tool is, the deepest first.
std::vector<std::uint32_t> voxels_in_contact(const Rig& rig, const Pose& tool) {
  const Simulation& simulation = rig.simulation();
  const Scene& scene = simulation.scene();
  ContactScratch scratch(scene.haptics);
  evaluate_contact(simulation.workpiece(), scene.tissues, simulation.burr(), tool, nullptr,
                   scene.haptics, nullptr, scratch);
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

// --- count_steps --------------------------------------------------------------------------------

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

// --- wedge --------------------------------------------------------------------------------------

double peak_to_peak(std::span<const Felt> ticks, int axis) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Felt& felt : ticks) {
    low = std::min(low, felt.force_N[axis]);
    high = std::max(high, felt.force_N[axis]);
  }
  return high - low;
}

}  // namespace

/// Two ways over two ridges: round the edge so deep all the way, which the force should follow by
/// 1.4 degrees a tick, and straight across. Behind the default coupling 0.1 mm gives 0.07 N, which
/// is never judged; so it is run 0.2 mm deep as well, 0.1 mm deep with a Falcon's coupling, and
/// with the tool itself put there, its contact so stiff that a face gives about 1 N. What never
/// exceeds 0.1 N has no limit: there is nothing to hold to it.
CaseResult edge_normals(const CaseOptions& options) {
  constexpr double kSpeed_mm_per_s = 10.0, kJudged_N = 0.1, kTurn_deg = 2.5;
  constexpr double kPutStiffness_N_per_m = 15e3;
  struct Ridge {
    const char* name;
    VoxelModel solid;
    Vector3d up, across;
  };
  const double half = std::sqrt(0.5);
  std::vector<Ridge> ridges{{"ridge", roof_solid(0.0), Vector3d::UnitZ(), Vector3d::UnitX()}};
  if (!options.brief) {
    const double off = 0.25;
    ridges.push_back({"ridge off the grid", roof_solid(off), Vector3d::UnitZ(), Vector3d::UnitX()});
    ridges.push_back(
        {"edge of a block", block_edge_solid(), {half, 0.0, half}, {half, 0.0, -half}});
  }
  enum class Hold { kScene, kStiffCoupling, kPut };
  struct Setting {
    double depth_mm;
    Hold hold;
    const char* text = "";
  };
  CaseResult result;
  for (const ContactMethod method : options.methods) {
    std::vector<Setting> settings{{0.1, Hold::kScene}, {0.2, Hold::kScene}};
    if (method == ContactMethod::kCoupling) {
      settings.push_back({0.1, Hold::kStiffCoupling, " coupling of 3 N/mm"});
      settings.push_back({0.1, Hold::kPut, " tool put there"});
    }
    for (const auto& [depth_mm, hold, text] : settings) {
      const bool put = hold == Hold::kPut;
      Scene scene =
          method_scene(method, case_text(hold == Hold::kStiffCoupling ? kStiffCoupling : ""),
                       put ? std::optional(kPutStiffness_N_per_m) : std::optional<double>());
      if (put) scene.coupling.reset();
      for (const Ridge& ridge : ridges) {
        for (const bool round : {true, false}) {
          if (round && method == ContactMethod::kSinglePoint) continue;  // its way has no arc
          const EdgeWay way{ridge.up, ridge.across, depth_mm};
          std::vector<Vector3d> corners =
              round ? way.round_it(kSpeed_mm_per_s * kMillisecond) : way.level();
          // Off the voxels' middles and faces.
          const double off_mm = ridge.name == std::string("ridge off the grid") ? 0.25 : 0.0;
          for (Vector3d& corner : corners) {
            corner += Vector3d(off_mm * kVoxel_mm, 0.3 * kVoxel_mm, 0.0);
            corner -= kRadius_mm * ridge.up;
          }
          std::vector<Pose> path = case_path({corners.front()}, kSpeed_mm_per_s);
          for (std::size_t c = 1; c < corners.size(); ++c) {
            go_on(path, corners[c], kSpeed_mm_per_s);
          }
          for (Pose& pose : path) pose.orientation = orientation_along(ridge.up);
          const std::vector<Felt> ticks = run_path(method, scene, ridge.solid, path);
          double turn_deg = 0.0;
          int judged = 0;
          for (std::size_t t = 1; t < ticks.size(); ++t) {
            const Vector3d before = ticks[t - 1].force_N, now = ticks[t].force_N;
            if (std::min(before.norm(), now.norm()) <= kJudged_N) continue;
            turn_deg = std::max(turn_deg, angle_between_deg(before, now));
            ++judged;
          }
          const std::string setting = std::string(ridge.name) + (round ? " round it " : " level ") +
                                      text_of(depth_mm, "mm deep") + text;
          const std::optional<double> limit =
              judged > 0 ? std::optional(kTurn_deg) : std::optional<double>();
          result.rows.push_back(
              case_row("edge_normals", method, "turn_deg_per_tick", setting, turn_deg, limit));
          result.rows.push_back(case_row("edge_normals", method, "judged_ticks", setting, judged));
          if (&ridge == ridges.data() && depth_mm == 0.2 && round) {
            result.traces.push_back(
                case_trace("edge_normals", method, setting, ticks, ridge.across));
          }
        }
      }
    }
  }
  return result;
}

/// Slid over by 12 voxels aslant of the grid, the device so deep along the plane's normal. Behind
/// the coupling the tool is hardly so deep; there also with the device so far beyond that 1 N is
/// felt, and with the tool itself put there.
CaseResult tilted_planes(const CaseOptions& options) {
  constexpr double kDepth_mm = 0.1, kSpeed_mm_per_s = 2.0, kSlide_mm = 12.0 * kVoxel_mm;
  constexpr double kDirection_deg = 2.0, kRipple = 0.05;
  constexpr int kSettle = 100;  // ticks
  const std::vector<double> tilts_deg =
      options.brief ? std::vector<double>{30, 45} : std::vector<double>{0, 5, 10, 20, 30, 45};
  const std::vector<double> azimuths_deg =
      options.brief ? std::vector<double>{22.5} : std::vector<double>{0, 10, 22.5, 35, 45};
  CaseResult result;
  for (const ContactMethod method : options.methods) {
    const Scene scene = method_scene(method, case_text());
    Scene placed = scene;
    placed.coupling.reset();
    const auto measure = [&](const Scene& s, double depth_mm, const std::string& how) {
      for (const double tilt : tilts_deg) {
        double off_deg = 0.0, ripple = 0.0;
        std::vector<Felt> slid;
        for (const double azimuth : azimuths_deg) {
          if (tilt == 0.0 && azimuth != azimuths_deg.front()) continue;
          const double a = azimuth * kDegree, b = tilt * kDegree;
          const Vector3d normal(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
          const Vector3d along = normal.cross(Vector3d(0.4, 1.0, 0.2)).normalized();
          // From where the burr touches to its tip.
          const Vector3d touching = method == ContactMethod::kSinglePoint
                                        ? Vector3d(Vector3d::Zero())
                                        : Vector3d(kRadius_mm * (normal - Vector3d::UnitZ()));
          const auto tip = [&](double way_mm, double deep_mm) -> Vector3d {
            return way_mm * along - deep_mm * normal + touching;
          };
          std::vector<Pose> path = case_path(
              {tip(-0.5 * kSlide_mm, -0.05), tip(-0.5 * kSlide_mm, depth_mm)}, 5.0, kSettle);
          const std::size_t slides = path.size();
          go_on(path, tip(0.5 * kSlide_mm, depth_mm), kSpeed_mm_per_s);
          const std::vector<Felt> ticks = run_path(method, s, half_space_solid(normal), path);
          slid.assign(ticks.begin() + static_cast<std::ptrdiff_t>(slides), ticks.end());
          double low = HUGE_VAL, high = 0.0, sum = 0.0;
          for (const Felt& felt : slid) {
            const double size = felt.force_N.norm();
            low = std::min(low, size), high = std::max(high, size), sum += size;
            off_deg = std::max(off_deg, angle_between_deg(felt.force_N, normal));
          }
          ripple = std::max(ripple, (high - low) * static_cast<double>(slid.size()) / sum);
        }
        const std::string setting = text_of(tilt, "degrees ") + how;
        result.rows.push_back(
            case_row("tilted_planes", method, "direction_deg", setting, off_deg, kDirection_deg));
        result.rows.push_back(
            case_row("tilted_planes", method, "ripple", setting, ripple, kRipple));
        if (tilt == 30.0) {
          result.traces.push_back(case_trace("tilted_planes", method, setting, slid));
        }
      }
    };
    measure(scene, kDepth_mm, "0.1 mm deep");
    if (!scene.coupling) continue;
    measure(scene, 1.0 / kSpring_N_per_mm, "at 1 N");
    measure(placed, kDepth_mm, "tool put 0.1 mm deep");
  }
  return result;
}

/// A voxel with each pattern of its six neighbours, alone and in a block around it. Its normal, by
/// the method's own way: asked for by itself and in a row of others, with what a tool above it
/// knows and without. Then the tool comes down on all patterns, those that are alone, twice.
CaseResult opposing_faces(const CaseOptions& options) {
  constexpr double kDepth_mm = 0.1;
  constexpr int kApart = 24;  // voxels between the patterns of a field
  /// Whether what is `from` the voxel in question is solid.
  const auto in_pattern = [](int exposed, const Vector3d& from) {
    if (from.isZero()) return true;
    if (from.lpNorm<1>() > 1.5) return false;
    int axis = 0;
    from.cwiseAbs().maxCoeff(&axis);
    return (exposed >> (2 * axis + (from[axis] > 0.0 ? 1 : 0)) & 1) == 0;
  };
  const auto place_of = [](int pattern) -> Vector3d {
    const double middle = 0.5 * kApart + 0.5;
    const Cell place(kApart * (pattern % 8 - 4), kApart * (pattern / 8 - 4), 0);
    return place.cast<double>() + Vector3d(middle, middle, 0.5);
  };
  const VoxelModel field =
      solid_where(Eigen::Vector3i(8 * kApart, 8 * kApart, 16), [&](const Vector3d& p) {
        const int pattern =
            static_cast<int>(p.x() / kApart + 4.0) + 8 * static_cast<int>(p.y() / kApart + 4.0);
        return in_pattern(pattern, p - place_of(pattern));
      });
  std::vector<Pose> path;
  for (int pattern = 0; pattern < 64; ++pattern) {
    const double top = (pattern >> 5 & 1) != 0 ? 0.5 : 1.5;
    const Vector3d on = kVoxel_mm * (place_of(pattern) + Vector3d(0.1, -0.1, top));
    const Vector3d over = on + 0.15 * Vector3d::UnitZ();
    if (path.empty()) path = case_path({over}, 1.0);
    go_on(path, over, 100.0);
    go_on(path, on - kDepth_mm * Vector3d::UnitZ(), 10.0, 5);
    go_on(path, over, 10.0);
  }
  CaseResult result;
  for (const ContactMethod method : options.methods) {
    const Scene scene = method_scene(method, case_text());
    int bad = 0, changed = 0, none = 0, forces_bad = 0, forces_changed = 0;
    for (int pattern = 0; pattern < 64; ++pattern) {
      for (const bool in_block : {false, true}) {
        const Workpiece workpiece(solid_where(Eigen::Vector3i(32, 32, 32), [&](const Vector3d& p) {
          const Vector3d from = p - Vector3d::Constant(0.5);
          if (from.lpNorm<1>() < 1.5) return in_pattern(pattern, from);
          return in_block && from.lpNorm<Eigen::Infinity>() < 7.5;
        }));
        const Cell middle = workpiece.grid().cells / 2;
        for (const float told : {0.0f, 1.0f}) {
          const VoxelQuery query{middle, told * Eigen::Vector3f::UnitZ()};
          std::vector<VoxelQuery> row(11, query);
          // Among others, where the pattern has one below it: only surface voxels may be asked for.
          const Cell below = middle - Cell::UnitZ();
          for (std::size_t q = 0; q < row.size() && workpiece.is_surface(below); q += 2) {
            row[q].voxel = below;
          }
          std::vector<SurfaceEstimate> found(row.size());
          estimate_surfaces(workpiece, row, scene.haptics, found);
          const SurfaceEstimate alone =
              estimate_surface(workpiece, middle, scene.haptics, query.outward);
          const float length = alone.normal.norm();
          const bool unit = alone.defined && std::abs(length - 1.0f) < 1e-5f;
          const bool stated = !alone.defined && length == 0.0f;
          none += stated;
          bad += !(unit || stated) || !std::isfinite(alone.offset);
          for (std::size_t q = 1; q < row.size(); q += 2) {
            changed += found[q].normal != alone.normal || found[q].offset != alone.offset ||
                       found[q].defined != alone.defined;
          }
        }
      }
    }
    const std::vector<Felt> once = run_path(method, scene, field, path);
    const std::vector<Felt> again = run_path(method, scene, field, path);
    double largest_N = 0.0;
    for (std::size_t t = 0; t < path.size(); ++t) {
      forces_bad += !once[t].force_N.allFinite() || once[t].faults != 0;
      forces_changed += once[t].force_N != again[t].force_N;
      largest_N = std::max(largest_N, once[t].force_N.norm());
    }
    const auto add = [&](const char* quantity, double value, std::optional<double> limit) {
      result.rows.push_back(case_row("opposing_faces", method, quantity, "", value, limit));
    };
    if (method != ContactMethod::kSinglePoint) {  // which has no normals of voxels
      add("normals_neither_unit_nor_none", bad, 0.0);
      add("normals_that_change", changed, 0.0);
      add("normals_none", none, {});
    }
    add("force_not_finite_ticks", forces_bad, 0.0);
    add("force_changed_ticks", forces_changed, 0.0);
    add("largest_force_N", largest_N, {});
  }
  return result;
}

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
    const double depth_mm = scene.coupling ? 1.0 / kSpring_N_per_mm : 0.1;
    const Vector3d place(0.23 * kVoxel_mm, 0.41 * kVoxel_mm, 0.0);
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
  const Vector3d aslant(0.13 * kVoxel_mm, 0.29 * kVoxel_mm, 0.0);
  const auto deep = [](double mm) -> Vector3d { return -mm * Vector3d::UnitZ(); };
  const Vector3d along = kVoxel_mm * Vector3d(12.0, 0.4, 0.0);
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
  const Vector3d axis = kVoxel_mm * Vector3d(0.5, 0.5, 0.0);
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
        const Vector3d over = axis + kVoxel_mm * place;
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
  const Vector3d slide = 10.0 * kVoxel_mm * Vector3d::UnitY();
  CaseResult result;
  for (const ContactMethod method : options.methods) {
    const Scene scene = method_scene(method, case_text());
    const bool held = is_held_outside(method);
    const auto add = [&](const char* quantity, const std::string& setting, double value,
                         std::optional<double> limit, bool at_least = false) {
      result.rows.push_back(case_row("wedge", method, quantity, setting, value, limit, at_least));
    };
    const double deep_mm = held ? 2.0 / kSpring_N_per_mm : 0.1;
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
        const Vector3d middle(phase * kVoxel_mm, -0.5 * slide.y(), 0.0);
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
        peak_N = std::max(peak_N, peak_to_peak(pressed, 0));
        if (held) {
          for (std::size_t t = 0; t < slides; ++t) {
            const Felt& felt = ticks[t];
            if (felt.force_N.z() < kJudged_N && t + 1 < slides) continue;
            const double spring_N = kSpring_N_per_mm / kMillimetre * -felt.device.position.z();
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
      add("side_peak_to_peak_N", setting, peak_to_peak(run_path(method, scene, slot, path), 0),
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
