#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/fault.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/scene/scene_file.hpp"
#include "tools/sulcus_lab/laws/law_rig.hpp"
#include "tools/sulcus_lab/laws/laws.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

const RemovalState& removal_of(const LawRig& rig) { return *rig.state().workpiece().removal; }

double solid_mm3(const LawRig& rig) {
  const VoxelModel& model = rig.state().workpiece().solid.model();
  return filled_voxels(model) * model.grid.voxel_volume_m3() / 1e-9;
}

/// What was lost as heat, where the state counts it.
template <class State>
double heat_of(const State& removal) {
  if constexpr (requires { removal.heat_J; }) {
    return removal.heat_J;
  } else {
    return 0.0;
  }
}

/// A block with a flat face at z = 0: of the second tissue for x < 0, of the first beyond.
VoxelModel block_of_two_tissues(double voxel_m, SurfaceKind surface) {
  VoxelModel block = law_voxels(Vector3d::Constant(2.78e-3), voxel_m, surface,
                                {[](const Vector3d& p) { return p.z(); }});
  auto tissues = std::make_shared<TissueMap>(block.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < block.grid.leaf_count(); ++leaf) {
    const Cell first = block.grid.leaf_origin(leaf);
    LabelBlock labels;
    for (int place = 0; place < 512; ++place) {
      const int x = (first + cell_in_leaf(place)).x();
      labels[static_cast<std::size_t>(place)] = 2 * x < block.grid.cells.x() ? 1 : 0;
    }
    tissues->set_block(leaf, labels, block.leaves[leaf]);
  }
  block.tissues = std::move(tissues);
  return block;
}

/// By tissue: the work at its voxels, and what was spent on those that went.
struct TissueEnergies {
  double worked_J[2] = {}, spent_J[2] = {};
};

TissueEnergies cut_two_tissues(LawRig& rig, const std::vector<Pose>& way) {
  const Workpiece& solid = rig.state().workpiece().solid;
  TissueEnergies energies;
  double before[2];
  for (std::uint8_t tissue = 0; tissue < 2; ++tissue)
    before[tissue] = filled_voxels(solid.model(), tissue);
  for (const Pose& pose : way) {
    rig.step(pose);
    for (const Contact contact : rig.scratch().bodies.front().contact.contacts) {
      energies.worked_J[contact.tissue] +=
          static_cast<double>(contact.power_W) / rig.scene().haptics.rate_hz;
    }
  }
  for (std::uint8_t tissue = 0; tissue < 2; ++tissue) {
    energies.spent_J[tissue] = (before[tissue] - filled_voxels(solid.model(), tissue)) *
                               solid.grid().voxel_volume_m3() *
                               rig.scene().tissues[tissue].specific_energy_J_per_m3;
  }
  return energies;
}

}  // namespace

/// A burr at 300,000 rpm goes from a soft tissue on to enamel: what is removed, stored and lost as
/// heat makes up the work, and no more is spent on a tissue than was worked there.
void cutting_balance(LawTrial& trial) {
  const VoxelModel block =
      block_of_two_tissues(trial.quick() ? kLawVoxel_m : 20e-6, trial.surface());
  for (const std::string& soft : trial.shapes({"dentine"}, {"dentine", "caries", "pulp"})) {
    for (const std::string& scaling : trial.scalings()) {
      for (const bool coupled : {false, true}) {
        const double depth_m = coupled ? 0.6e-3 : 0.05e-3;
        const Vector3d from(-0.6e-3, 0.013e-3, kLawRadius_m), down(0.0, 0.0, -depth_m);
        const std::vector<Pose> way =
            poses_along(std::vector<Vector3d>{from + Vector3d(0.0, 0.0, 0.1e-3), from + down,
                                              from + down + Vector3d(1.2e-3, 0.0, 0.0)},
                        4e-6);
        LawRig rig(law_scene({.scaling = scaling,
                              .burr = "speed_rpm = 300000",
                              .tables = "[cutting]\n",
                              .tissues = "'enamel', '" + soft + "'",
                              .coupling = coupled}),
                   block);
        const TissueEnergies energies = cut_two_tissues(rig, way);
        const RemovalState& removal = removal_of(rig);
        const double accounted_J = removal.removed_J + removal.stored_J() + heat_of(removal);
        const LawPlace where{soft + " to enamel", scaling, coupled ? "coupled" : "rigid"};
        trial.add(where, "work_mJ", 1e3 * removal.work_J);
        trial.add(where, "not_accounted_for", std::abs(accounted_J / removal.work_J - 1.0),
                  at_most(1e-10));
        const double beyond_J = energies.spent_J[0] - energies.worked_J[0];
        trial.add(where, "spent_in_enamel_beyond_work_there_mJ", 1e3 * std::max(0.0, beyond_J),
                  at_most(1e-6));
        trial.add(where, "not_yet_spent_percent", 100.0 * removal.stored_J() / removal.work_J);
      }
    }
  }
}

/// What a push of 1 N removes in scenes/side_cut.toml against the voxel size.
void removed_and_voxels(LawTrial& trial) {
  struct Voxels {
    double um;
    std::string_view cells;
  };
  const std::vector<Voxels> sizes =
      trial.settings<Voxels>({{25, "48, 144, 112"}, {50, "24, 72, 56"}},
                             {{12.5, "96, 288, 224"}, {25, "48, 144, 112"}, {50, "24, 72, 56"}});
  if (!trial.asks_for("side_cut")) return;
  for (const std::string& scaling : trial.scalings()) {
    double finest_mm3 = 0.0;
    for (const Voxels& size : sizes) {
      const std::vector<std::string> overrides{with_number("workpiece.voxel_mm=%g", 1e-3 * size.um),
                                               "workpiece.cells=[" + std::string(size.cells) + "]",
                                               "workpiece.surface='" + trial.surface_name() + "'",
                                               "haptics.scaling='" + scaling + "'"};
      const Scene scene = load_scene(SULCUS_SCENES "/side_cut.toml", overrides);
      LawRig rig(scene, build_workpiece(scene));
      const Trajectory trajectory = make_trajectory(scene.trajectory);
      ScriptedDevice device(trajectory, scene.haptics.rate_hz);
      const double before_mm3 = solid_mm3(rig);
      for (int t = 0; t < (trial.quick() ? 2000 : 10000); ++t) rig.step(device);
      const double mm3 = before_mm3 - solid_mm3(rig);
      if (finest_mm3 == 0.0) finest_mm3 = mm3;
      const LawPlace where{"side_cut", scaling, with_number("voxels of %g um", size.um)};
      trial.add(where, "removed_mm3", mm3);
      // Of whole voxels it is only reported; and under `none`, where finer voxels are so many
      // contacts, each as stiff, that the burr hardly enters, and no more goes than lies in it.
      const bool held = trial.surface() == SurfaceKind::kFractions && scaling != "none";
      trial.add(where, "off_the_finest_percent", 100.0 * std::abs(mm3 / finest_mm3 - 1.0),
                held ? at_most(1.0) : RowLimit{});
    }
  }
}

namespace {

/// What the tick did in which the device gave a pose after a gap.
void add_arrival(LawTrial& trial, const LawPlace& where, const TickResult& arrival) {
  trial.add(where, "contacts", arrival.contact.contacts, at_least(1.0));
  trial.add(where, "removed_voxels", arrival.removed, at_most(0.0));
  trial.add(where, "friction_N", arrival.contact.tangential.force_N.norm(), at_most(0.0));
}

}  // namespace

/// A device that jumps by 20 mm, and one that gives no pose for 60 ticks and comes back elsewhere,
/// both into contact, the spindle standing: neither cuts nor rubs.
void jump_and_silence(LawTrial& trial) {
  for (const std::string& name :
       trial.shapes({"plane", "blob"}, {"plane", "blob", "box", "molar"})) {
    const LawShape shape = law_shape(name, trial.surface());
    const Vector3d there = touching_centre(shape) - 0.1e-3 * shape.normal;
    for (const std::string& scaling : trial.scalings()) {
      const Scene scene =
          law_scene({.scaling = scaling, .tables = "[cutting]\n", .tissues = "'dentine'"});
      LawRig jumping(scene, shape.model);
      const Pose away = pose_at_centre(there + 20e-3 * shape.normal);
      jumping.steps(std::vector<Pose>(5, away));
      add_arrival(trial, {name, scaling, "jump of 20 mm"}, jumping.step(pose_at_centre(there)));

      LawRig silent(scene, shape.model);
      PutDevice device;
      device.put = pose_at_centre(there + 0.3e-3 * shape.across);
      for (int t = 0; t < 5; ++t) silent.step(device);
      device.put.reset();
      for (int t = 0; t < 60; ++t) silent.step(device);
      device.put = pose_at_centre(there);
      add_arrival(trial, {name, scaling, "after a silence of 60 ticks"}, silent.step(device));
    }
  }
}

namespace {

constexpr double kShortStep_m = 5e-6;

struct LongStep {
  double removed_mm3 = 0.0;
  bool fault = false;
};

/// Drawn 3.6 mm through a block's face at a speed, the spindle standing: the work, and so the
/// volume, is of the way alone, whatever the steps that it is taken in.
LongStep draw_through(Scene scene, const VoxelModel& block, double speed_m_per_s, double step_m) {
  scene.haptics.rate_hz = speed_m_per_s / step_m;
  const Vector3d from(-1.8e-3, 0.013e-3, kLawRadius_m - 0.1e-3), up(0.0, 0.0, 0.15e-3),
      way(3.6e-3, 0.0, 0.0);
  LawRig rig(scene, block);
  rig.steps(poses_along(std::vector<Vector3d>{from + up, from}, 5e-6));
  LongStep drawn;
  const double before_mm3 = solid_mm3(rig);
  for (const Pose& pose : poses_along(std::vector<Vector3d>{from, from + way}, step_m)) {
    drawn.fault |= (rig.step(pose).faults & kFaultStepTooLong) != 0;
  }
  drawn.removed_mm3 = before_mm3 - solid_mm3(rig);
  return drawn;
}

/// Whether a wall of one voxel is crossed at 0.5 m/s without a word; the phase of the steps
/// differs.
bool crosses_without_fault(const Scene& scene, const VoxelModel& wall, double phase_m) {
  LawRig rig(scene, wall);
  const Vector3d x = Vector3d::UnitX();
  bool fault = false;
  for (int t = 0; t < 8; ++t) {
    const double at_m = -2.0e-3 + phase_m + 0.5e-3 * t;
    fault |= (rig.step(pose_at_centre(at_m * x)).faults & kFaultStepTooLong) != 0;
  }
  return !fault;
}

}  // namespace

/// Steps from 20 um to 2 mm a tick: where less is cut than by short ones at the same speed, a fault
/// tells it.
void long_steps(LawTrial& trial) {
  const VoxelModel block = law_voxels({5.5e-3, 2.2e-3, 2.2e-3}, kLawVoxel_m, trial.surface(),
                                      {[](const Vector3d& p) { return p.z(); }});
  const VoxelModel wall =
      law_voxels({4e-3, 1.6e-3, 1.6e-3}, kLawVoxel_m, trial.surface(),
                 {[](const Vector3d& p) { return std::max(-p.x(), p.x() - kLawVoxel_m); }});
  for (const std::string& scaling : trial.scalings()) {
    if (trial.asks_for("block")) {
      Scene scene = law_scene({.scaling = scaling, .tables = "[cutting]\n"});
      scene.tissues[0].specific_energy_J_per_m3 = 0.5e6;  // all that is touched goes
      for (const double step_mm :
           trial.settings<double>({0.02, 1.0}, {0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0})) {
        const double speed_m_per_s = step_mm;  // at a thousand ticks a second
        const LongStep drawn = draw_through(scene, block, speed_m_per_s, kMillimetre * step_mm);
        const LongStep shortest = draw_through(scene, block, speed_m_per_s, kShortStep_m);
        const double lost_percent = 100.0 * (1.0 - drawn.removed_mm3 / shortest.removed_mm3);
        const LawPlace where{"block", scaling, with_number("%g mm a tick", step_mm)};
        trial.add(where, "lost_percent", lost_percent);
        // No false alarm, either.
        trial.add(where, "fault_set", drawn.fault ? 1.0 : 0.0,
                  step_mm <= 0.02 ? at_most(0.0) : RowLimit{});
        trial.add(where, "lost_without_fault_percent",
                  drawn.fault ? 0.0 : std::max(0.0, lost_percent), at_most(5.0));
      }
    }
    if (!trial.asks_for("one_voxel_wall")) continue;
    double crossed = 0.0;
    for (int phase = 0; phase < 16; ++phase) {
      crossed += crosses_without_fault(law_scene({.scaling = scaling}), wall, 0.031e-3 * phase)
                     ? 1.0
                     : 0.0;
    }
    trial.add({"one_voxel_wall", scaling, "500 mm/s"}, "crossed_without_fault_of_16", crossed,
              at_most(0.0));
  }
}

}  // namespace sulcus::lab
