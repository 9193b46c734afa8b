#include "tools/sulcus_lab/pareto/pareto_measurement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>

#include <Eigen/Geometry>

#include "engine/core/realtime.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/contact/broad_phase.hpp"
#include "haptics/contact/contact_force.hpp"
#include "haptics/contact/evaluate_contact.hpp"
#include "haptics/contact/narrow_phase.hpp"
#include "haptics/contact/normals.hpp"

namespace sulcus::lab {

namespace {

constexpr int kPasses = 3;
constexpr std::size_t kSlowStride = 10;  // poses

std::size_t stride_of(NormalMethod method) {
  return method == NormalMethod::kExact ? kSlowStride : 1;
}

HapticsSettings haptics_of(const ParetoSetting& setting) {
  HapticsSettings haptics;
  haptics.normals = setting.method;
  haptics.neighbourhood = setting.neighbourhood;
  if (setting.method == NormalMethod::kLdmPaper) haptics.trace = 5;
  return haptics;
}

/// One setting, ready to run.
class Run {
 public:
  Run(KnownSurface& surface, const Burr& burr, const ParetoSetting& setting)
      : surface_(surface),
        burr_(burr),
        haptics_(haptics_of(setting)),
        scratch_(haptics_),
        stride_(stride_of(setting.method)) {}

  void measure_errors(std::span<const PressedPose> poses, ParetoRow& row) {
    NetForceErrors sums;  // of squares, but for the angle
    for (const PressedPose& pose : poses) {
      const ContactResult result = evaluate(pose.world_from_tool);
      const NetForceErrors e =
          net_force_errors(surface_, pose.truth, scratch_.contacts, result.wrench.force_N);
      sums.directions += e.directions * e.directions;
      sums.own_weights += e.own_weights * e.own_weights;
      sums.whole += e.whole * e.whole;
      sums.mean_angle_deg += e.mean_angle_deg;
    }
    const auto count = static_cast<double>(poses.size());
    const auto rms_pct = [&](double sum) { return 100.0 * std::sqrt(sum / count); };
    row.directions_pct = rms_pct(sums.directions);
    row.own_weights_pct = rms_pct(sums.own_weights);
    row.whole_pct = rms_pct(sums.whole);
    row.normal_error_deg = sums.mean_angle_deg / count;
  }

  /// One pass; what is less than the row's times takes their place.
  void measure_times(std::span<const PressedPose> poses, ParetoRow& row) {
    double tick_ns = 0.0, normals_ns = 0.0;
    int count = 0;
    for (std::size_t p = 0; p < poses.size(); p += stride_, ++count) {
      const Pose& pose = poses[p].world_from_tool;
      evaluate(pose);
      std::uint64_t begin = thread_cpu_ns();
      evaluate(pose);
      tick_ns += static_cast<double>(thread_cpu_ns() - begin);
      const double reach_m =
          contact_reach_m(surface_.workpiece(), haptics_.scaling, Outputs::kForce);
      broad_phase(surface_.workpiece(), burr_.capsule, pose, reach_m, scratch_);
      NarrowPhase phase(surface_.workpiece(), burr_.field, pose, reach_m, scratch_);
      for (bool more = true; more;) {
        scratch_.contacts.clear();
        more = phase.next();
        begin = thread_cpu_ns();
        normals(surface_.workpiece(), haptics_, nullptr, scratch_, 0);
        normals_ns += static_cast<double>(thread_cpu_ns() - begin);
      }
    }
    row.tick_us = std::min(row.tick_us, 1e-3 * tick_ns / count);
    row.normals_us = std::min(row.normals_us, 1e-3 * normals_ns / count);
  }

 private:
  ContactResult evaluate(const Pose& pose) {
    return evaluate_contact(surface_.workpiece(), {burr_, pose, tissues_, haptics_}, scratch_);
  }

  KnownSurface& surface_;
  const Burr& burr_;
  HapticsSettings haptics_;
  ContactScratch scratch_;
  std::size_t stride_;
  std::vector<TissueSettings> tissues_{1};
};

std::string described(const ParetoSetting& setting) {
  return std::string(kNormalMethodNames[static_cast<std::size_t>(setting.method)]) +
         ", NS = " + std::to_string(setting.neighbourhood);
}

}  // namespace

std::vector<ParetoSetting> pareto_settings(std::size_t fields) {
  std::vector<ParetoSetting> settings;
  for (std::size_t m = 0; m < kNormalMethodNames.size(); ++m) {
    const auto method = static_cast<NormalMethod>(m);
    std::vector<int> neighbourhoods{1, 2, 3, 4, 5, 6};
    if (method == NormalMethod::kLdm || method == NormalMethod::kLdmFast) {
      neighbourhoods.insert(neighbourhoods.end(), {8, 12});
    }
    for (const int ns : neighbourhoods) {
      for (std::size_t field = 0; field < fields; ++field) settings.push_back({method, ns, field});
    }
  }
  return settings;
}

std::vector<ParetoRow> measure_pareto(KnownSurface& surface, std::span<const Burr> burrs,
                                      std::span<const PressedPose> poses,
                                      std::span<const ParetoSetting> settings,
                                      const std::function<void(const std::string&)>& progress) {
  std::vector<ParetoRow> rows;
  for (const ParetoSetting& setting : settings) {
    progress("errors: " + described(setting));
    ParetoRow& row = rows.emplace_back();
    row.setting = setting;
    row.tick_us = row.normals_us = std::numeric_limits<double>::infinity();
    Run(surface, burrs[setting.field], setting).measure_errors(poses, row);
  }
  for (int pass = 0; pass < kPasses; ++pass) {
    for (ParetoRow& row : rows) {
      progress("times, pass " + std::to_string(pass + 1) + " of " + std::to_string(kPasses) + ": " +
               described(row.setting));
      Run(surface, burrs[row.setting.field], row.setting).measure_times(poses, row);
    }
  }
  mark_front(rows);
  return rows;
}

void mark_front(std::vector<ParetoRow>& rows) {
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(rows[a].tick_us, rows[a].whole_pct) <
           std::pair(rows[b].tick_us, rows[b].whole_pct);
  });
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t r : order) {
    rows[r].on_front = rows[r].whole_pct < least;
    least = std::min(least, rows[r].whole_pct);
  }
}

using Eigen::Vector3d;

namespace {

constexpr double kLargestTilt = 30.0 * kDegree;

/// Numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// In [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
};

std::vector<Cell> surface_above(const Workpiece& workpiece, double lowest_z_m) {
  const VoxelGrid& grid = workpiece.grid();
  std::vector<Cell> cells;
  for (std::uint32_t leaf = 0; leaf < grid.leaf_count(); ++leaf) {
    const Cell origin = grid.leaf_origin(leaf);
    for_each_voxel(workpiece.surface(leaf), [&](int place) {
      const Cell cell = origin + cell_in_leaf(place);
      if (grid.centre_world(cell).z() > lowest_z_m) cells.push_back(cell);
    });
  }
  return cells;
}

/// Evenly over the area: a plane with the normal n has max |n_a| surface voxels to a voxel's face,
/// so that many more of them are passed over.
Cell random_voxel(KnownSurface& surface, const std::vector<Cell>& cells, Random& random) {
  while (true) {
    const auto at = static_cast<std::size_t>(random.uniform() * static_cast<double>(cells.size()));
    const Vector3d normal = surface.closest_point(cells[at]).normal;
    if (random.uniform() * std::numbers::sqrt3 * normal.cwiseAbs().maxCoeff() < 1.0) {
      return cells[at];
    }
  }
}

/// Evenly over the cap of directions within the largest tilt.
Vector3d tilted(const Vector3d& normal, Random& random) {
  const double cosine = 1.0 - random.uniform() * (1.0 - std::cos(kLargestTilt));
  const double azimuth = 2.0 * std::numbers::pi * random.uniform();
  const Vector3d u = normal.unitOrthogonal();
  const Vector3d side = std::cos(azimuth) * u + std::sin(azimuth) * normal.cross(u);
  return cosine * normal + std::sqrt(1.0 - cosine * cosine) * side;
}

}  // namespace

std::vector<PressedPose> pressed_poses(KnownSurface& surface, const Burr& burr,
                                       double head_radius_m, double depth_m, double lowest_z_m,
                                       int count, std::uint64_t seed,
                                       const HapticsSettings& settings) {
  const std::vector<Cell> cells = surface_above(surface.workpiece(), lowest_z_m);
  ContactScratch scratch(settings);
  Random random(seed);
  std::vector<PressedPose> poses;
  while (static_cast<int>(poses.size()) < count) {
    const ComposedShape::ClosestPoint closest =
        surface.closest_point(random_voxel(surface, cells, random));
    const Vector3d axis = tilted(closest.normal, random);
    const auto pose_at = [&](double lift_m) {
      const Vector3d centre = closest.point + (head_radius_m - depth_m + lift_m) * closest.normal;
      return Pose{centre - head_radius_m * axis, orientation_along(axis)};
    };
    PressedPose pressed{pose_at(0.0), {}};
    // Lifting by what is too deep is never too much, and nearly enough where the walls are not
    // steep; the steepest of fissures take some rounds.
    double lift_m = 0.0;
    for (int round = 0; round < 60; ++round) {
      pressed.world_from_tool = pose_at(lift_m);
      pressed.truth = true_force(surface, burr, pressed.world_from_tool, settings, scratch);
      const double excess_m = pressed.truth.deepest_m - depth_m;
      if (excess_m < 0.01 * surface.workpiece().grid().voxel_m) break;
      lift_m += excess_m;
    }
    poses.push_back(std::move(pressed));
  }
  return poses;
}

}  // namespace sulcus::lab
