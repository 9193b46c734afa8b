#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/units.hpp"
#include "engine/normals/normal_method.hpp"
#include "tools/sulcus_lab/stability/cases/case_solids.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/statistics.hpp"

namespace sulcus::lab {

// Which way the force points on surfaces whose normals are hard to tell: cases 6, 7 and 8.

using Eigen::Vector3d;

namespace {

/// Stiffer than the default coupling: a Falcon's.
constexpr const char* kStiffCoupling =
    "[coupling]\nstiffness_N_per_mm = 3.0\nforce_limit_N = 8.0\n";

/// Ways of the ball's middle over an edge along y at the origin, between two faces of 90 degrees
/// about the direction `up`.
struct EdgeWay {
  Vector3d up, across;
  double depth_mm;

  /// Down to the first face, along it, round the edge, and along the second, so deep all the way.
  std::vector<Vector3d> round_it(double step_mm) const {
    const double r = kCaseRadius_mm - depth_mm, quarter = 0.25 * std::numbers::pi;
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
    const Vector3d over = (kCaseRadius_mm - depth_mm) * up;
    return {over - 0.5 * across, over + 0.5 * across};
  }
};

}  // namespace

/// Two ways over two ridges: round the edge so deep all the way, which the force should follow by
/// 1.4 degrees a tick, and straight across. Behind the default coupling 0.1 mm gives 0.07 N, which
/// is never judged; so it is run 0.2 mm deep as well, 0.1 mm deep with a Falcon's coupling, and
/// with the tool itself put there, its contact so stiff that a face gives about 1 N. What never
/// exceeds 0.1 N has no limit: there is nothing to hold to it.
void edge_normals(CaseTrial& trial) {
  constexpr double kSpeed_mm_per_s = 10.0, kJudged_N = 0.1, kTurn_deg = 2.5;
  constexpr double kPutStiffness_N_per_m = 15e3;
  struct Ridge {
    const char* name;
    VoxelModel solid;
    Vector3d up, across;
  };
  const double half = std::sqrt(0.5);
  std::vector<Ridge> ridges{{"ridge", roof_solid(0.0), Vector3d::UnitZ(), Vector3d::UnitX()}};
  if (!trial.brief) {
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
  std::vector<Setting> settings{{0.1, Hold::kScene}, {0.2, Hold::kScene}};
  if (trial.method == ContactMethod::kCoupling) {
    settings.push_back({0.1, Hold::kStiffCoupling, " coupling of 3 N/mm"});
    settings.push_back({0.1, Hold::kPut, " tool put there"});
  }
  for (const auto& [depth_mm, hold, text] : settings) {
    const bool put = hold == Hold::kPut;
    Scene scene =
        method_scene(trial.method, case_text(hold == Hold::kStiffCoupling ? kStiffCoupling : ""),
                     put ? std::optional(kPutStiffness_N_per_m) : std::optional<double>());
    if (put) scene.coupling.reset();
    for (const Ridge& ridge : ridges) {
      for (const bool round : {true, false}) {
        if (round && trial.method == ContactMethod::kSinglePoint) continue;  // its way has no arc
        const EdgeWay way{ridge.up, ridge.across, depth_mm};
        std::vector<Vector3d> corners =
            round ? way.round_it(kSpeed_mm_per_s * kMillisecond) : way.level();
        // Off the voxels' middles and faces.
        const double off_mm = ridge.name == std::string("ridge off the grid") ? 0.25 : 0.0;
        for (Vector3d& corner : corners) {
          corner += Vector3d(off_mm * kCaseVoxel_mm, 0.3 * kCaseVoxel_mm, 0.0);
          corner -= kCaseRadius_mm * ridge.up;
        }
        std::vector<Pose> path = case_path({corners.front()}, kSpeed_mm_per_s);
        for (std::size_t c = 1; c < corners.size(); ++c) {
          go_on(path, corners[c], kSpeed_mm_per_s);
        }
        for (Pose& pose : path) pose.orientation = orientation_along(ridge.up);
        const std::vector<Felt> ticks = run_path(trial.method, scene, ridge.solid, path);
        double turn_deg = 0.0;
        int judged = 0;
        for (std::size_t t = 1; t < ticks.size(); ++t) {
          const Vector3d before = ticks[t - 1].force_N, now = ticks[t].force_N;
          if (std::min(before.norm(), now.norm()) <= kJudged_N) continue;
          turn_deg = std::max(turn_deg, angle_between_deg(before, now));
          ++judged;
        }
        const std::string setting = std::string(ridge.name) + (round ? " round it " : " level ") +
                                    with_number("%g mm deep", depth_mm) + text;
        const std::optional<double> limit =
            judged > 0 ? std::optional(kTurn_deg) : std::optional<double>();
        trial.add("turn_deg_per_tick", setting, turn_deg, at_most(limit));
        trial.add("judged_ticks", setting, judged);
        if (&ridge == ridges.data() && depth_mm == 0.2 && round) {
          trial.trace(setting, ticks, ridge.across);
        }
      }
    }
  }
}

/// Slid over by 12 voxels across the grid, the device so deep along the plane's normal. Behind
/// the coupling the tool is hardly so deep; there also with the device so far beyond that 1 N is
/// felt, and with the tool itself put there.
void tilted_planes(CaseTrial& trial) {
  constexpr double kDepth_mm = 0.1, kSpeed_mm_per_s = 2.0, kSlide_mm = 12.0 * kCaseVoxel_mm;
  constexpr double kDirection_deg = 2.0, kRipple = 0.05;
  constexpr int kSettle = 100;  // ticks
  const std::vector<double> tilts_deg = trial.settings<double>({30, 45}, {0, 5, 10, 20, 30, 45});
  const std::vector<double> azimuths_deg = trial.settings<double>({22.5}, {0, 10, 22.5, 35, 45});
  const Scene scene = method_scene(trial.method, case_text());
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
        const Vector3d touching = trial.method == ContactMethod::kSinglePoint
                                      ? Vector3d(Vector3d::Zero())
                                      : Vector3d(kCaseRadius_mm * (normal - Vector3d::UnitZ()));
        const auto tip = [&](double way_mm, double deep_mm) -> Vector3d {
          return way_mm * along - deep_mm * normal + touching;
        };
        std::vector<Pose> path = case_path(
            {tip(-0.5 * kSlide_mm, -0.05), tip(-0.5 * kSlide_mm, depth_mm)}, 5.0, kSettle);
        const std::size_t slides = path.size();
        go_on(path, tip(0.5 * kSlide_mm, depth_mm), kSpeed_mm_per_s);
        const std::vector<Felt> ticks = run_path(trial.method, s, half_space_solid(normal), path);
        slid.assign(ticks.begin() + static_cast<std::ptrdiff_t>(slides), ticks.end());
        std::vector<double> size_N;
        for (const Felt& felt : slid) {
          size_N.push_back(felt.force_N.norm());
          off_deg = std::max(off_deg, angle_between_deg(felt.force_N, normal));
        }
        ripple = std::max(ripple, peak_to_peak(size_N) / mean(size_N));
      }
      const std::string setting = with_number("%g degrees ", tilt) + how;
      trial.add("direction_deg", setting, off_deg, at_most(kDirection_deg));
      trial.add("ripple", setting, ripple, at_most(kRipple));
      if (tilt == 30.0) trial.trace(setting, slid);
    }
  };
  measure(scene, kDepth_mm, "0.1 mm deep");
  if (!scene.coupling) return;
  measure(scene, 1.0 / kCaseSpring_N_per_mm, "at 1 N");
  measure(placed, kDepth_mm, "tool put 0.1 mm deep");
}

namespace {

constexpr int kPatterns = 64;  // a bit for each neighbour that is empty
constexpr int kApart = 24;     // voxels between the patterns of a field

/// Whether what is `from` the voxel in question is solid.
bool in_pattern(int exposed, const Vector3d& from) {
  if (from.isZero()) return true;
  if (from.lpNorm<1>() > 1.5) return false;
  int axis = 0;
  from.cwiseAbs().maxCoeff(&axis);
  return (exposed >> (2 * axis + (from[axis] > 0.0 ? 1 : 0)) & 1) == 0;
}

/// Of the voxel in question in the field of all patterns.
Vector3d place_of(int pattern) {
  const double middle = 0.5 * kApart + 0.5;
  const Cell place(kApart * (pattern % 8 - 4), kApart * (pattern / 8 - 4), 0);
  return place.cast<double>() + Vector3d(middle, middle, 0.5);
}

VoxelModel pattern_field() {
  return solid_where(Eigen::Vector3i(8 * kApart, 8 * kApart, 16), [](const Vector3d& p) {
    const int pattern =
        static_cast<int>(p.x() / kApart + 4.0) + 8 * static_cast<int>(p.y() / kApart + 4.0);
    return in_pattern(pattern, p - place_of(pattern));
  });
}

/// Down on one pattern after another.
std::vector<Pose> onto_all_patterns() {
  constexpr double kDepth_mm = 0.1;
  std::vector<Pose> path;
  for (int pattern = 0; pattern < kPatterns; ++pattern) {
    const double top = (pattern >> 5 & 1) != 0 ? 0.5 : 1.5;
    const Vector3d on = kCaseVoxel_mm * (place_of(pattern) + Vector3d(0.1, -0.1, top));
    const Vector3d over = on + 0.15 * Vector3d::UnitZ();
    if (path.empty()) path = case_path({over}, 1.0);
    go_on(path, over, 100.0);
    go_on(path, on - kDepth_mm * Vector3d::UnitZ(), 10.0, 5);
    go_on(path, over, 10.0);
  }
  return path;
}

/// What there is to say of estimates of one voxel.
struct EstimateCounts {
  int bad = 0, changed = 0, none = 0;
};

/// Of the middle voxel by itself and in a row of others; `outward`: what a tool knows, or zero.
void count_estimates(const Workpiece& workpiece, const HapticsSettings& haptics,
                     const Eigen::Vector3f& outward, EstimateCounts& counts) {
  const Cell middle = workpiece.grid().cells / 2;
  std::vector<VoxelQuery> row(11, VoxelQuery{middle, outward});
  // Among others, where the pattern has one below it: only surface voxels may be asked for.
  const Cell below = middle - Cell::UnitZ();
  for (std::size_t q = 0; q < row.size() && workpiece.is_surface(below); q += 2) {
    row[q].voxel = below;
  }
  std::vector<SurfaceEstimate> found(row.size());
  estimate_surfaces(workpiece, row, haptics, found);
  const SurfaceEstimate alone = estimate_surface(workpiece, middle, haptics, outward);
  const float length = alone.normal.norm();
  const bool unit = alone.defined && std::abs(length - 1.0f) < 1e-5f;
  const bool stated = !alone.defined && length == 0.0f;
  counts.none += stated;
  counts.bad += !(unit || stated) || !std::isfinite(alone.offset);
  for (std::size_t q = 1; q < row.size(); q += 2) {
    counts.changed += found[q].normal != alone.normal || found[q].offset != alone.offset ||
                      found[q].defined != alone.defined;
  }
}

EstimateCounts count_pattern_estimates(const HapticsSettings& haptics) {
  EstimateCounts counts;
  for (int pattern = 0; pattern < kPatterns; ++pattern) {
    for (const bool in_block : {false, true}) {
      const Workpiece workpiece(solid_where(Eigen::Vector3i(32, 32, 32), [&](const Vector3d& p) {
        const Vector3d from = p - Vector3d::Constant(0.5);
        if (from.lpNorm<1>() < 1.5) return in_pattern(pattern, from);
        return in_block && from.lpNorm<Eigen::Infinity>() < 7.5;
      }));
      for (const float told : {0.0f, 1.0f}) {
        count_estimates(workpiece, haptics, told * Eigen::Vector3f::UnitZ(), counts);
      }
    }
  }
  return counts;
}

}  // namespace

/// A voxel with each pattern of its six neighbours, alone and in a block around it. Its normal, by
/// the method's own way: asked for by itself and in a row of others, with what a tool above it
/// knows and without. Then the tool comes down on all patterns, those that are alone, twice.
void opposing_faces(CaseTrial& trial) {
  const Scene scene = method_scene(trial.method, case_text());
  const VoxelModel field = pattern_field();
  const std::vector<Pose> path = onto_all_patterns();
  const std::vector<Felt> once = run_path(trial.method, scene, field, path);
  const std::vector<Felt> again = run_path(trial.method, scene, field, path);
  int bad = 0, changed = 0;
  double largest_N = 0.0;
  for (std::size_t t = 0; t < path.size(); ++t) {
    bad += !once[t].force_N.allFinite() || once[t].faults != 0;
    changed += once[t].force_N != again[t].force_N;
    largest_N = std::max(largest_N, once[t].force_N.norm());
  }
  if (trial.method != ContactMethod::kSinglePoint) {  // which has no normals of voxels
    const EstimateCounts counts = count_pattern_estimates(scene.haptics);
    trial.add("normals_neither_unit_nor_none", "", counts.bad, at_most(0.0));
    trial.add("normals_that_change", "", counts.changed, at_most(0.0));
    trial.add("normals_none", "", counts.none);
  }
  trial.add("force_not_finite_ticks", "", bad, at_most(0.0));
  trial.add("force_changed_ticks", "", changed, at_most(0.0));
  trial.add("largest_force_N", "", largest_N);
}

}  // namespace sulcus::lab
