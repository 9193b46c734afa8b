#include "tools/sulcus_lab/table1/table1_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

#include "app/session/simulation.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/units.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/import/load_burr.hpp"
#include "engine/normals/neighbour_pattern.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/shapes/molar.hpp"
#include "haptics/contact/evaluate_contact.hpp"
#include "haptics/tool_motion.hpp"
#include "tools/sulcus_lab/truth/composed_shape.hpp"
#include "tools/sulcus_lab/truth/known_contact.hpp"

namespace sulcus::lab {

namespace {

using Progress = std::function<void(const std::string&)>;

constexpr std::uint64_t kTellEvery = 200;  // ticks

/// Every normal found when it is needed, by the method itself, as the paper's are.
Scene with_fresh_normals(Scene scene) {
  scene.haptics.keep_normals = false;
  return scene;
}

/// A scene, read and ready to be run again and again from its start.
struct LoadedScene {
  explicit LoadedScene(const Scene& s)
      : scene(with_fresh_normals(s)),
        trajectory(make_trajectory(s.trajectory)),
        burr(load_burr(s)),
        start(build_workpiece(s)),
        bodies(build_bodies(s)),
        ticks(static_cast<std::uint64_t>(
            std::max(1.0, std::ceil(trajectory.duration_s() * s.haptics.rate_hz - 1e-6)))) {
    check_start(scene, start, bodies, burr, trajectory.pose_at(0.0));
  }

  Scene scene;
  Trajectory trajectory;
  Burr burr;
  VoxelModel start;
  std::vector<VoxelModel> bodies;
  std::uint64_t ticks;
};

/// One pass over a loaded scene, from a tooth that nothing has touched yet.
struct Pass {
  explicit Pass(const LoadedScene& loaded)
      : simulation(loaded.scene, loaded.start, loaded.bodies, loaded.burr),
        device(loaded.trajectory, loaded.scene.haptics.rate_hz) {}

  TickRecord step() {
    const TickRecord record = simulation.step(device);
    if (record.faults != 0) {
      throw std::runtime_error("tick " + std::to_string(record.tick) + " ended with the faults " +
                               std::to_string(record.faults));
    }
    return record;
  }

  Simulation simulation;
  ScriptedDevice device;
};

void tell(const Progress& progress, const char* what, std::uint64_t tick, std::uint64_t ticks) {
  if (tick % kTellEvery == 0) progress(what + std::to_string(100 * tick / ticks) + " %");
}

void run_alone(const LoadedScene& loaded, Table1Run& run, const Progress& progress) {
  Pass pass(loaded);
  std::uint64_t leaves = 0, tested = 0, ns = 0;
  for (std::uint64_t tick = 0; tick < loaded.ticks; ++tick) {
    tell(progress, "alone: ", tick, loaded.ticks);
    const std::uint64_t begin = thread_cpu_ns();
    const TickRecord record = pass.step();
    ns += thread_cpu_ns() - begin;
    run.contacts.push_back(record.contacts);
    leaves += record.leaves;
    tested += record.tested;
    run.removed_voxels += record.removed;
  }
  const auto ticks = static_cast<double>(loaded.ticks);
  run.leaves_mean = static_cast<double>(leaves) / ticks;
  run.tested_mean = static_cast<double>(tested) / ticks;
  run.tick_us_mean = 1e-3 * static_cast<double>(ns) / ticks;
}

/// Analytic normals and surface points of the built-in molar, found once for each voxel.
class KnownMolar {
 public:
  /// `placement`: scene from shape.
  KnownMolar(const Molar& molar, const Pose& placement)
      : shape_({side_of(molar)}, molar.bounds()), placement_(placement) {}

  struct Surface {
    Eigen::Vector3f normal;
    float offset_m;
  };
  const Surface& at(const VoxelGrid& grid, const Cell& cell) {
    const auto [at, is_new] = known_.try_emplace(voxel_key(cell));
    if (is_new) at->second = surface_at(grid.centre_world(cell));
    return at->second;
  }

 private:
  Surface surface_at(const Eigen::Vector3d& centre_world) const {
    const Eigen::Vector3d centre = placement_.inverse_point(centre_world);
    const ComposedShape::ClosestPoint closest = shape_.closest_point(centre);
    return {placement_.direction(closest.normal).cast<float>(),
            static_cast<float>((closest.point - centre).dot(closest.normal))};
  }

  ComposedShape shape_;
  Pose placement_;
  std::unordered_map<std::uint32_t, Surface> known_;
};

bool is_known(const Scene& scene) {
  const WorkpieceSettings& w = scene.workpiece;
  return w.shape == ShapeKind::kMolar && !scene.cutting && w.rotation.isZero();
}

/// Evaluates a tick's contact by several methods, on what the tick is about to see.
class Comparison {
 public:
  Comparison(const LoadedScene& loaded, Table1Run& run)
      : loaded_(loaded),
        run_(run),
        exact_settings_(loaded.scene.haptics),
        ours_(loaded.scene.haptics, StageClock(thread_cpu_ns)),
        exact_(loaded.scene.haptics, StageClock(thread_cpu_ns)),
        truth_(loaded.scene.haptics) {
    exact_settings_.normals = NormalMethod::kExact;
    run_.has_truth = is_known(loaded.scene);
    if (run_.has_truth) {
      molar_.emplace(Molar(loaded.scene.workpiece.molar_caries_radius_m),
                     Pose{loaded.scene.workpiece.position_m, Eigen::Quaterniond::Identity()});
    }
  }

  void compare(const Simulation& simulation, const Pose& pose) {
    const Scene& scene = loaded_.scene;
    const SimulationState& state = simulation.state();
    const Workpiece& workpiece = simulation.workpiece();
    const Twist twist = motion_between(state.has_pose ? state.tool : pose, pose,
                                       1.0 / scene.haptics.rate_hz, scene.burr.speed_rad_per_s);
    const Twist* cutting = scene.cutting ? &twist : nullptr;

    ComparedTick compared;
    compared.tick = state.tick;
    ours_.clock.reset();
    const ContactResult ours = evaluate_contact(
        workpiece, {loaded_.burr, pose, scene.tissues, scene.haptics, cutting}, ours_);
    compared.ours = ours.wrench;
    compared.contacts = ours.contacts;
    exact_.clock.reset();
    compared.exact =
        evaluate_contact(workpiece, {loaded_.burr, pose, scene.tissues, exact_settings_, cutting},
                         exact_)
            .wrench;
    run_.ours_us += 1e-3 * static_cast<double>(ours_.clock.ns(Stage::kNormals));
    run_.exact_us += 1e-3 * static_cast<double>(exact_.clock.ns(Stage::kNormals));
    run_.normals += ours_.contacts.size();
    for (std::size_t i = 0; i < ours_.contacts.size(); ++i) {
      const Contact contact = ours_.contacts[i];
      const Eigen::Vector3i& direction =
          projection_directions()[exposed_faces(workpiece, contact.cell)];
      ++run_.by_axes[static_cast<std::size_t>(direction.cwiseAbs().sum())];
      run_.ours_to_exact.add(contact.normal, exact_.contacts[i].normal);
    }
    if (run_.has_truth) compared.truth = evaluate_truth(workpiece, pose, cutting);
    run_.compared.push_back(compared);
  }

 private:
  /// The forces of the same contacts with the analytic surface.
  Wrench evaluate_truth(const Workpiece& workpiece, const Pose& pose, const Twist* cutting) {
    const Scene& scene = loaded_.scene;
    const double reach_m = contact_reach_m(workpiece, scene.haptics.scaling, Outputs::kForce);
    const ContactResult result = evaluate_known(
        workpiece, {loaded_.burr, pose, scene.tissues, scene.haptics, cutting}, reach_m, truth_,
        [&](const Cell& cell) { return molar_->at(workpiece.grid(), cell); });
    for (std::size_t i = 0; i < truth_.contacts.size(); ++i) {
      run_.ours_to_truth.add(ours_.contacts[i].normal, truth_.contacts[i].normal);
      run_.exact_to_truth.add(exact_.contacts[i].normal, truth_.contacts[i].normal);
    }
    return result.wrench;
  }

  const LoadedScene& loaded_;
  Table1Run& run_;
  HapticsSettings exact_settings_;
  ContactScratch ours_, exact_, truth_;
  std::optional<KnownMolar> molar_;
};

/// The comparison is only worth something if it is with the tick's own force.
void expect_same(const Wrench& wrench, const TickRecord& record) {
  if (std::memcmp(wrench.force_N.data(), record.contact_force_N, sizeof record.contact_force_N) ||
      std::memcmp(wrench.torque_Nm.data(), record.contact_torque_Nm,
                  sizeof record.contact_torque_Nm)) {
    throw std::runtime_error("tick " + std::to_string(record.tick) +
                             ": the force evaluated beside the tick is not the tick's");
  }
}

void run_compared(const LoadedScene& loaded, int every, Table1Run& run, const Progress& progress) {
  Pass pass(loaded);
  Comparison comparison(loaded, run);
  for (std::uint64_t tick = 0; tick < loaded.ticks; ++tick) {
    tell(progress, "beside the reference: ", tick, loaded.ticks);
    const bool is_compared = tick % static_cast<std::uint64_t>(every) == 0;
    if (is_compared) comparison.compare(pass.simulation, *pass.device.pose(tick));
    const TickRecord record = pass.step();
    if (is_compared) expect_same(run.compared.back().ours, record);
  }
}

}  // namespace

void MeanAngle::add(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  const Eigen::Vector3d p = a.cast<double>(), q = b.cast<double>();
  const double angle_deg = std::atan2(p.cross(q).norm(), p.dot(q)) / kDegree;
  sum_deg += angle_deg;
  max_deg = std::max(max_deg, angle_deg);
  ++count;
}

Table1Run run_table1_experiment(const Scene& scene, int every, const Progress& progress) {
  progress("loading");
  const LoadedScene loaded(scene);
  Table1Run run;
  run_alone(loaded, run, progress);
  run_compared(loaded, every, run, progress);
  return run;
}

}  // namespace sulcus::lab
