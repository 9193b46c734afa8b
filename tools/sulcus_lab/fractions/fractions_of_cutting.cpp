#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/realtime.hpp"
#include "engine/core/units.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/shapes/basic_shapes.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "tools/sulcus_lab/fractions/force_grain.hpp"
#include "tools/sulcus_lab/fractions/fractions.hpp"
#include "tools/sulcus_lab/laws/law_rig.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

std::string surface_override(std::size_t surface) {
  return "workpiece.surface='" + std::string(kSurfaceNames[surface]) + "'";
}

struct CutScene {
  ForceGrain grain;
  double tick_ns = 0.0;  // mean
};

CutScene cut_scene(const std::string& name, std::size_t surface, int most_ticks) {
  const std::vector<std::string> overrides{surface_override(surface)};
  const Scene scene = load_scene(SULCUS_SCENES "/" + name + ".toml", overrides);
  LawRig rig(scene, build_workpiece(scene));
  const Trajectory trajectory = make_trajectory(scene.trajectory);
  ScriptedDevice device(trajectory, scene.haptics.rate_hz);
  const auto ticks = static_cast<int>(std::ceil(trajectory.duration_s() * scene.haptics.rate_hz));
  std::vector<Vector3d> positions_m, forces_N;
  const std::uint64_t begin = thread_cpu_ns();
  for (int t = 0; t < std::min(ticks, most_ticks); ++t) {
    const TickResult result = rig.step(device);
    positions_m.push_back(result.device.position);
    forces_N.push_back(result.contact.wrench.force_N);
  }
  const std::uint64_t ns = thread_cpu_ns() - begin;
  return {force_grain(positions_m, forces_N),
          static_cast<double>(ns) / static_cast<double>(forces_N.size())};
}

/// How much of a solid's voxels is filled.
double filled_mm3(const Workpiece& workpiece) {
  const VoxelGrid& grid = workpiece.grid();
  double levels = 0.0;
  for_each_cell(Cell::Zero(), grid.cells,
                [&](const Cell& c) { levels += static_cast<double>(workpiece.level(c)); });
  return levels / kFullLevel * grid.voxel_volume_m3() / 1e-9;
}

}  // namespace

std::vector<FractionRow> fractions_of_grain(const FractionOptions& options) {
  struct WantedGrain {
    std::string name;
    int quick_ticks;  // 0: not then
    double grain_pct, step_N;
  };
  constexpr int kMostTicks = 30000;
  const WantedGrain scenes[] = {{"side_cut", 500, 0.1, 0.01},
                                {"cut_sulcus", 1000, 0.1, 0.01},
                                {"crown_shoulder", 0, 0.3, 0.03},
                                {"class_one_cavity", 0, 0.5, 0.03}};
  std::vector<FractionRow> rows;
  for (const WantedGrain& wanted : scenes) {
    if (options.quick && wanted.quick_ticks == 0) continue;
    FractionRow grain, step, tick;
    grain.quantity = "force_grain_pct";
    grain.wanted = wanted.grain_pct;
    step.quantity = "largest_step_N";
    step.wanted = wanted.step_N;
    tick.quantity = "tick_us";
    grain.shape = step.shape = tick.shape = wanted.name;
    for (std::size_t s = 0; s < 2; ++s) {
      options.progress("grain: " + wanted.name + ", " + std::string(kSurfaceNames[s]));
      const CutScene cut =
          cut_scene(wanted.name, s, options.quick ? wanted.quick_ticks : kMostTicks);
      grain.value[s] = cut.grain.ticks > 0 ? cut.grain.grain_pct : NAN;
      step.value[s] = cut.grain.ticks > 0 ? cut.grain.largest_step_N : NAN;
      tick.value[s] = 1e-3 * cut.tick_ns;
      grain.ns[s] = step.ns[s] = cut.tick_ns;
      grain.setting = step.setting = with_number("%.0f ticks", cut.grain.ticks);
    }
    tick.wanted = 2.0 * tick.binary();
    tick.setting = "cutting";
    rows.insert(rows.end(), {grain, step, tick});
  }
  return rows;
}

namespace {

/// A round burr of 1 mm goes through a block that costs next to nothing to cut, from air to air,
/// kSweepDepth_m deep in its upper face, in a direction `turn` (rad) from +x: what is removed more
/// than the ball sweeps, in % of that.
constexpr double kSweepDepth_m = 0.35e-3;

double beyond_the_sweep_pct(SurfaceKind surface, double voxel_m, double turn) {
  const Vector3d size_m(1.6e-3, 3.2e-3, 1.1e-3);
  VoxelGrid grid;
  grid.cells = 8 * ((size_m.array() + 0.2e-3) / (8.0 * voxel_m)).ceil().cast<int>().matrix();
  grid.voxel_m = voxel_m;
  const BoxShape block(size_m);
  Scene scene = law_scene({.burr = "speed_rpm = 100000", .tables = "[cutting]\n"});
  for (TissueSettings& tissue : scene.tissues) tissue.specific_energy_J_per_m3 *= 1e-3;
  LawRig rig(scene, voxelise_implicit(block, grid, nullptr, {}, surface));
  const double before_mm3 = filled_mm3(rig.state().workpiece().solid);

  const Vector3d along(std::cos(turn), std::sin(turn), 0.0);
  const double half_way_m = (0.5 * size_m.x() + kLawRadius_m) / std::cos(turn) + kLawRadius_m;
  const Vector3d middle(0.0, 0.0, 0.5 * size_m.z() + kLawRadius_m - kSweepDepth_m);
  constexpr double kStep_m = 4e-6;
  rig.steps(poses_along(
      std::vector<Vector3d>{middle - half_way_m * along, middle + half_way_m * along}, kStep_m));
  const double removed_mm3 = before_mm3 - filled_mm3(rig.state().workpiece().solid);

  // The segment of the ball's disc below the face, as long as the way between the block's sides.
  const double r = kLawRadius_m, above = r - kSweepDepth_m;
  const double segment_m2 = r * r * std::acos(above / r) - above * std::sqrt(r * r - above * above);
  const double swept_mm3 = segment_m2 * size_m.x() / std::cos(turn) / 1e-9;
  return 100.0 * (removed_mm3 / swept_mm3 - 1.0);
}

}  // namespace

std::vector<FractionRow> fractions_of_sweeps(const FractionOptions& options) {
  std::vector<FractionRow> rows;
  for (const double um : {50.0, 35.0, 20.0}) {
    if (options.quick && um != 50.0) continue;
    for (const double turn_deg : {0.0, 25.0}) {
      FractionRow& row = rows.emplace_back();
      row.quantity = "swept_volume_off_pct";
      row.shape = "block";
      row.setting = with_number("voxels of %g um, ", um) +
                    with_number("%g degrees across the grid", turn_deg);
      row.wanted = 0.5;
      for (std::size_t s = 0; s < 2; ++s) {
        options.progress("sweeps: " + row.setting);
        row.value[s] = beyond_the_sweep_pct(kBothSurfaces[s], 1e-6 * um, turn_deg * kDegree);
      }
    }
  }
  return rows;
}

std::vector<FractionRow> fractions_of_pushes(const FractionOptions& options) {
  FractionRow row;
  row.quantity = "removed_finer_off_pct";
  row.shape = "side_cut";
  row.setting = "voxels of 50 and 12.5 um, 1 s";
  row.wanted = 1.0;
  for (std::size_t s = 0; s < 2; ++s) {
    const auto removed_mm3 = [&](const std::string& voxel_mm, const std::string& cells) {
      options.progress("pushes: " + voxel_mm + " mm, " + std::string(kSurfaceNames[s]));
      const std::vector<std::string> overrides{
          surface_override(s), "workpiece.voxel_mm=" + voxel_mm, "workpiece.cells=[" + cells + "]"};
      const Scene scene = load_scene(SULCUS_SCENES "/side_cut.toml", overrides);
      LawRig rig(scene, build_workpiece(scene));
      const double before_mm3 = filled_mm3(rig.state().workpiece().solid);
      const Trajectory trajectory = make_trajectory(scene.trajectory);
      ScriptedDevice device(trajectory, scene.haptics.rate_hz);
      for (int t = 0; t < 1000; ++t) rig.step(device);
      return before_mm3 - filled_mm3(rig.state().workpiece().solid);
    };
    const double coarse_mm3 = removed_mm3("0.05", "24, 72, 56");
    row.value[s] = 100.0 * (removed_mm3("0.0125", "96, 288, 224") / coarse_mm3 - 1.0);
  }
  return {row};
}

}  // namespace sulcus::lab
