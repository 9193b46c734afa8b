#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "engine/bodies/debris_world.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/loose_schedule.hpp"
#include "haptics/tool_motion.hpp"
#include "tools/sulcus_lab/stability/cases/case_solids.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/stability/rig.hpp"

namespace sulcus::lab {

// What cutting and great numbers of contacts do: cases 15, 18 and 20.

namespace {

using Eigen::Vector3d;

// --- A piece cut loose --------------------------------------------------------------------------

constexpr double kSmallBurr_mm = 0.3;

/// Base, a bridge of 3 x 3 voxels, 12 high, and an island of 10 x 10 x 10 on it.
constexpr int kIslandSide = 10, kBridgeLow = 8, kBridgeHigh = 20;
VoxelModel island() {
  const Eigen::Vector3i cells(32, 32, 40);
  return solid_where(cells, [&](const Vector3d& p) {
    const Vector3d c = p + 0.5 * cells.cast<double>();  // from the grid's corner
    const auto within = [](double at, int from, int count) {
      return at > from && at < from + count;
    };
    if (c.z() < kBridgeLow) return true;
    if (c.z() < kBridgeHigh) return within(c.x(), 14, 3) && within(c.y(), 14, 3);
    return c.z() < kBridgeHigh + kIslandSide && within(c.x(), 11, kIslandSide) &&
           within(c.y(), 11, kIslandSide);
  });
}

/// On its side through the bridge, then up under the island, where nothing else can be touched.
PathDevice through_the_bridge(const VoxelGrid& grid) {
  const double tip_m = -0.5 * kSmallBurr_mm * kMillimetre;  // from the head's middle
  const auto at = [&](double x, double y, double z) {
    return Vector3d(grid.world_from_index({x, y, z}) + tip_m * Vector3d::UnitY());
  };
  constexpr double kMiddle = 0.5 * (kBridgeLow + kBridgeHigh - 1);
  std::vector<Pose> poses =
      path_along({at(2, 15, kMiddle), at(22, 15, kMiddle)}, 2e-3, 1000.0, Vector3d::UnitY());
  const std::vector<Pose> up =
      path_along({at(22, 15, kMiddle), at(18, 15, kMiddle + 3)}, 20e-3, 1000.0, Vector3d::UnitY());
  poses.insert(poses.end(), up.begin(), up.end());
  poses.insert(poses.end(), 250, poses.back());
  return PathDevice(std::move(poses));
}

struct Loosened {
  int loosened = -1, last_contact = -1, left = -1;  // ticks; -1: never
  std::size_t voxels = 0, remaining = 0;            // of the island
  double fallen_m = 0.0;
  std::vector<float> force_N;
};

Loosened cut_loose(ContactMethod method) {
  const VoxelModel start = island();
  const Scene scene = method_scene(method, R"(
tissue = ['caries']
[workpiece]
shape = 'box'
cells = [32, 32, 40]
[burr]
diameter_mm = 0.3
speed_rpm = 150000
field = 'auto'
[cutting]
[loose_pieces]
)");
  PathDevice path = through_the_bridge(start.grid);
  Rig rig(method, scene, start);
  // As a session does: what came loose is asked for every 10 ticks, and counts 50 later.
  LooseFinder finder(start);
  LooseSchedule schedule;
  std::deque<LooseAnswer> answers;
  LoosePieces at_once(start);  // when it truly came loose
  std::optional<DebrisWorld> world;
  std::vector<std::uint32_t> piece;
  Loosened run;
  for (int tick = 0; tick < static_cast<int>(path.ticks()); ++tick) {
    const auto number = static_cast<std::uint64_t>(tick);
    const auto leaving = schedule.before_tick(number, [&](LooseAnswer& answer) {
      if (answers.empty()) return false;
      answer = std::move(answers.front());
      answers.pop_front();
      return true;
    });
    const Felt felt = rig.step(path, leaving);
    run.force_N.push_back(static_cast<float>(felt.force_N.norm()));
    std::vector<std::uint32_t> removed;
    for (const Edit& edit : rig.simulation().edits()) {
      if (edit.is_gone()) removed.push_back(edit.voxel);
      if (edit.cause == EditCause::kLoose) piece.push_back(edit.voxel);
    }
    at_once.remove(removed);
    if (run.loosened < 0) {
      for (const LoosePiece& loose : at_once.take()) {
        if (loose.voxels.size() > run.voxels) run.voxels = loose.voxels.size();
      }
      if (run.voxels > 500) run.loosened = tick;
    }
    if (auto answer = finder.add_tick(number, rig.simulation().edits())) {
      answers.push_back(std::move(*answer));
    }
    if (run.loosened >= 0 && felt.contacts > 0) run.last_contact = tick;
    if (!piece.empty() && !world) {
      run.left = tick;
      world.emplace(finder.model().grid, *scene.loose_pieces);
      world->add(piece);
    }
    if (world) world->step(1e-3, finder.model());
  }
  if (world) run.fallen_m = -world->pose(0).position.z();
  const Workpiece& after = rig.simulation().workpiece();
  for (std::uint32_t v = 0; v < after.grid().cell_count(); ++v) {
    const Cell c = after.grid().cell_of_linear(v);
    if (c.z() >= kBridgeHigh && after.solid(c)) ++run.remaining;
  }
  return run;
}

}  // namespace

// Case 15. The burr cuts the bridge on its way under the island, whose contact is all that it then
// can have. Time counts from the tick in which the island hangs on nothing. Of the bridge's stump
// and what the burr has taken of the island itself the piece is a few voxels more or less.
void loose_piece(CaseTrial& trial) {
  constexpr double kWithin_ms = 100.0, kLeastFall_mm = 0.1, kLeastVoxels = 900.0;
  Loosened run = cut_loose(trial.method);
  const auto add = [&](const char* quantity, double value, const RowLimit& limit = {}) {
    trial.add(quantity, "", value, limit).burr_mm = kSmallBurr_mm;
  };
  add("contact_for_ms",
      run.loosened < 0 ? HUGE_VAL : std::max(0, run.last_contact - run.loosened + 1),
      at_most(kWithin_ms));
  add("left_after_ms", run.left < 0 ? HUGE_VAL : run.left - run.loosened, at_most(kWithin_ms));
  add("voxels_left_behind", static_cast<double>(run.remaining), at_most(0.0));
  add("voxels", static_cast<double>(run.voxels), at_least(kLeastVoxels));
  add("fallen_mm", run.fallen_m / kMillimetre, at_least(kLeastFall_mm));
  trial.trace("a bridge cut under an island", std::move(run.force_N));
}

// --- Overload -----------------------------------------------------------------------------------

namespace {

/// A cylinder's flat end on a flat face: all of it touches at the slightest depth.
constexpr double kFineVoxel_mm = 0.03;
double diameter_mm_for(int contacts) { return kFineVoxel_mm * std::sqrt(4.0 / M_PI * contacts); }

struct Overloaded {
  std::uint32_t contacts = 0;     // at most
  std::uint64_t evaluations = 0;  // in such a tick, at most
  double tick_us = 0.0;           // median of the ticks with nearly as many
  double cap_used = 0.0;          // contacts evaluated in a tick by contacts_per_tick
  int stale = 0;                  // ticks
  double still_felt_N = 0.0;      // long after the device has gone
  std::vector<float> force_N;
};

/// Pressed 0.5 mm beyond the face, and 0.3 mm up from it again, at 20 mm/s.
Overloaded press_flat(ContactMethod method, int wanted) {
  const double diameter_mm = diameter_mm_for(wanted);
  const int side = 8 * static_cast<int>(std::ceil((diameter_mm / kFineVoxel_mm + 8.0) / 8.0));
  char text[400];
  std::snprintf(text, sizeof text, R"(
[workpiece]
shape = 'plate'
voxel_mm = %g
cells = [%d, %d, 48]
position_mm = [0, 0, -0.3]
[workpiece.plate]
thickness_mm = 0.6
[burr]
shape = 'fissure'
diameter_mm = %.17g
length_mm = %.17g
field = 'auto'
)",
                kFineVoxel_mm, side, side, diameter_mm, std::max(2.0, 0.6 * diameter_mm));
  const Scene scene = method_scene(method, text);
  std::vector<Pose> poses =
      path_along({Vector3d(0, 0, 0.3e-3), Vector3d(0, 0, -0.5e-3), Vector3d(0, 0, 0.3e-3)}, 20e-3);
  poses.insert(poses.end(), 100, poses.back());
  PathDevice path(std::move(poses));
  Rig rig(method, scene);
  Overloaded run;
  std::vector<std::pair<std::uint32_t, double>> cost;  // contacts, microseconds
  Felt before;
  int stale = 0;
  for (std::size_t tick = 0; tick < path.ticks(); ++tick) {
    const std::uint64_t begin = thread_cpu_ns();
    const Felt felt = rig.step(path);
    cost.emplace_back(felt.contacts, 1e-3 * static_cast<double>(thread_cpu_ns() - begin));
    run.contacts = std::max(run.contacts, felt.contacts);
    const double cap = scene.coupling ? scene.coupling->contacts_per_tick : HUGE_VAL;
    // Where it rests, all of a tick's evaluations have as many contacts as its last.
    const bool rests = felt.contacts > 0 && before.contacts > 0;
    if (rests) {
      run.evaluations = std::max(run.evaluations, felt.evaluations);
      run.cap_used = std::max(run.cap_used, static_cast<double>(felt.evaluations) * felt.contacts /
                                                std::max(cap, 2.0 * felt.contacts));
    }
    // A tool that stays to the last bit while its device goes on holds an old contact.
    const bool device_moves = tick > 0 && felt.device.position != before.device.position;
    stale = device_moves && felt.contacts > 0 && felt.tool.position == before.tool.position
                ? stale + 1
                : 0;
    run.stale = std::max(run.stale, stale);
    run.still_felt_N = felt.force_N.norm();
    run.force_N.push_back(static_cast<float>(felt.force_N.z()));
    before = felt;
  }
  std::vector<double> most;
  for (const auto& [touched, us] : cost) {
    if (touched > 0.9 * run.contacts) most.push_back(us);
  }
  std::ranges::nth_element(most, most.begin() + static_cast<std::ptrdiff_t>(most.size() / 2));
  run.tick_us = most[most.size() / 2];
  return run;
}

}  // namespace

// Case 18. The rule by which a tick gives something up: [coupling] contacts_per_tick bounds the
// contacts of all its evaluations, but for two that a step takes, without which the tool would stay
// where it is; it goes on in the next tick from where it has come to. Whether a tick keeps its time
// is a matter of the machine: its processor time is reported, not judged. Stale: ticks on end in
// which the device moves and a tool in contact does not. A device that has gone 0.3 mm back off the
// face is let go of.
void overload(CaseTrial& trial) {
  constexpr double kMostStale_ms = 2.0, kLetGo_N = 0.02;
  const std::vector<int> counts =
      trial.settings<int>({1000, 12000}, {1000, 5000, 9000, 12000, 20000});
  for (const int count : counts) {
    Overloaded run = press_flat(trial.method, count);
    const auto add = [&](const char* quantity, double value, const RowLimit& limit = {}) {
      trial.add(quantity, std::to_string(count), value, limit).burr_mm = diameter_mm_for(count);
    };
    add("contacts", run.contacts);
    add("evaluations", static_cast<double>(run.evaluations));
    add("tick_us", run.tick_us);
    add("part_of_contacts_per_tick", run.cap_used, at_most(1.0));
    add("stale_ms", run.stale, at_most(kMostStale_ms));
    add("still_felt_N", run.still_felt_N, at_most(kLetGo_N));
    if (count == counts.back()) {
      trial.trace(with_number("%.0f contacts", run.contacts), std::move(run.force_N));
    }
  }
}

// --- Side cutting -------------------------------------------------------------------------------

namespace {

/// A hand that presses with a constant force along -z, and gives way across just so far that the
/// tool stays where it is, though the spring between them, if there is one, is stretched.
class LoadDevice final : public Device {
 public:
  LoadDevice(const Pose& start, double load_N, double rate_hz, double spring_N_per_m)
      : pose_(start), load_N_(load_N), dt_s_(1.0 / rate_hz), spring_(spring_N_per_m) {}
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    const double speed = std::clamp((felt_N_.z() - load_N_) / kDamping, -kFastest, kFastest);
    if (tick == 0) return pose_;
    pose_.position.z() += speed * dt_s_;
    for (const int axis : {0, 1}) {
      pose_.position[axis] +=
          kFollows * (start_[axis] - felt_N_[axis] / spring_ - pose_.position[axis]);
    }
    return pose_;
  }
  void apply(const Wrench& wrench) noexcept override { felt_N_ = wrench.force_N; }

 private:
  // At 0.2 mm/s, as fast as it cuts, it holds back a hundredth of the load.
  static constexpr double kDamping = 50.0;   // N s/m
  static constexpr double kFastest = 20e-3;  // m/s
  static constexpr double kFollows = 0.05;   // of what is missing, a tick
  Pose pose_;
  Vector3d start_ = pose_.position;
  double load_N_, dt_s_, spring_;
  Vector3d felt_N_ = Vector3d::Zero();
};

struct SideCut {
  double voxel_mm = 0.0348, rate_hz = 1000.0;
  std::string tissue = "enamel";
  double duration_s = 10.0;
};

struct CutResult {
  double removed_mm3 = 0.0, removed_at_mm3 = 0.0;  // in all; when `early_s` had passed
  double balance = 0.0, integrated = 0.0;          // relative errors
  double heat = 0.0;                               // of the work
  double load_N = 0.0;                             // mean contact force along the load
  std::vector<float> force_N;
};

constexpr double kLoad_N = 1.0, kBarTop_m = 1.2e-3;

/// A fissure burr on its side, longer than the bar that it cuts a groove into. (On a face narrower
/// than the burr a coupling cannot hold it: where it rests on an edge 1 N is a lateral stiffness of
/// -1 N / R, and the springs' 0.7 N/mm are less.)
CutResult cut_side(ContactMethod method, const SideCut& cut, double early_s) {
  const double voxel_m = cut.voxel_mm * kMillimetre;
  const auto cells_for = [&](double size_m) {
    return 8 * static_cast<int>(std::ceil((size_m / voxel_m + 4.0) / 8.0));
  };
  char text[600];
  std::snprintf(text, sizeof text, R"(
tissue = ['%s']
[workpiece]
shape = 'box'
voxel_mm = %g
cells = [%d, %d, %d]
[workpiece.box]
size_mm = [1.6, 0.7, 2.4]
[burr]
shape = 'fissure'
diameter_mm = 1.0
length_mm = 2.4
speed_rpm = 7000
tangential_ratio = 0.3
field = 'auto'
[cutting]
)",
                cut.tissue.c_str(), cut.voxel_mm, cells_for(1.6e-3), cells_for(0.7e-3),
                cells_for(2.4e-3));
  Scene scene = method_scene(method, text);
  scene.haptics.rate_hz = cut.rate_hz;
  const Pose start{{0.0, -1.2e-3, kBarTop_m + 0.52e-3}, orientation_along(Vector3d::UnitY())};
  LoadDevice device(start, kLoad_N, cut.rate_hz,
                    scene.coupling ? scene.coupling->stiffness_N_per_m : HUGE_VAL);
  Rig rig(method, scene);
  const double dt_s = 1.0 / cut.rate_hz;
  CutResult result;
  double integrated_J = 0.0, sum_N = 0.0;
  std::uint64_t removed = 0;
  const double voxel_mm3 = cut.voxel_mm * cut.voxel_mm * cut.voxel_mm;
  const auto ticks = static_cast<std::uint64_t>(std::llround(cut.duration_s * cut.rate_hz));
  Pose last = start;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    const Felt felt = rig.step(device);
    // The recorded force, torque (of the burr's reference, here of the tip) and speed against the
    // tool's motion.
    const CuttingRecord& record = rig.simulation().cutting();
    const Vector3d force_N(record.tangential_force_N[0], record.tangential_force_N[1],
                           record.tangential_force_N[2]);
    const Vector3d torque_Nm(record.tangential_torque_Nm[0], record.tangential_torque_Nm[1],
                             record.tangential_torque_Nm[2]);
    const Vector3d arm_m = felt.tool.direction(scene.burr.reference_m * Vector3d::UnitY());
    const Vector3d turn = small_turn(last.orientation, felt.tool.orientation) +
                          record.spindle_rad_per_s * dt_s * felt.tool.direction(Vector3d::UnitY());
    integrated_J -= force_N.dot(felt.tool.position - last.position) +
                    (torque_Nm + arm_m.cross(force_N)).dot(turn);
    last = felt.tool;
    removed += felt.removed;
    sum_N += felt.contact_force_N.z();
    result.force_N.push_back(static_cast<float>(felt.force_N.z()));
    if (static_cast<double>(tick) * dt_s < early_s) {
      result.removed_at_mm3 = static_cast<double>(removed) * voxel_mm3;
    }
  }
  const RemovalState& state = *rig.simulation().state().workpiece().removal;
  const double removed_J = static_cast<double>(removed) *
                           rig.simulation().workpiece().grid().voxel_volume_m3() *
                           scene.tissues.front().specific_energy_J_per_m3;
  result.removed_mm3 = static_cast<double>(removed) * voxel_mm3;
  result.balance = std::abs((removed_J + state.stored_J() + state.heat_J) / state.work_J - 1.0);
  result.integrated = std::abs(integrated_J / state.work_J - 1.0);
  result.heat = state.heat_J / state.work_J;
  result.load_N = sum_N / static_cast<double>(ticks);
  return result;
}

}  // namespace

// Case 20. Held by a device that presses with 1 N and else holds still, at 7,000 rpm.
void cutting_energy(CaseTrial& trial) {
  constexpr double kBalance = 1e-6, kIntegrated = 0.01, kSpread = 0.1;
  // In less than 2 s one layer of voxels, fallen or not yet, makes a tenth.
  const double duration_s = trial.brief ? 2.0 : 10.0;
  const double dentine_s = trial.brief ? 0.5 : 4.0;
  std::vector<SideCut> cuts;
  for (const double voxel_mm : {0.05, 0.0348, 0.025}) {
    if (!trial.brief || voxel_mm > 0.03) cuts.push_back({.voxel_mm = voxel_mm});
  }
  for (const double rate_hz : {500.0, 2000.0}) {
    if (!trial.brief || rate_hz < 1000.0) cuts.push_back({.voxel_mm = 0.05, .rate_hz = rate_hz});
  }
  cuts.push_back({.voxel_mm = 0.05, .tissue = "dentine"});
  for (SideCut& cut : cuts) cut.duration_s = cut.tissue == "dentine" ? dentine_s : duration_s;

  double least = HUGE_VAL, most = 0.0, enamel = 0.0;
  const auto add = [&](const char* quantity, const std::string& setting, double value,
                       const RowLimit& limit = {}) {
    trial.add(quantity, setting, value, limit).push_N = kLoad_N;
  };
  for (const SideCut& cut : cuts) {
    CutResult run = cut_side(trial.method, cut, dentine_s);
    const std::string setting =
        cut.tissue + with_number(", %g mm", cut.voxel_mm) + with_number(", %g Hz", cut.rate_hz);
    add("balance_error", setting, run.balance, at_most(kBalance));
    add("power_error", setting, run.integrated, at_most(kIntegrated));
    add("removed_mm3", setting, run.removed_mm3);
    add("heat_of_work", setting, run.heat);
    add("load_N", setting, run.load_N);
    if (cut.tissue == "dentine") {
      add("dentine_by_enamel", "", enamel > 0.0 ? run.removed_mm3 / enamel : 0.0, at_least(1.0));
      continue;
    }
    least = std::min(least, run.removed_mm3);
    most = std::max(most, run.removed_mm3);
    if (cut.voxel_mm == 0.05 && cut.rate_hz == 1000.0) {
      enamel = run.removed_at_mm3;
      trial.trace("enamel, voxels of 0.05 mm", std::move(run.force_N));
    }
  }
  add("volume_spread", "", least > 0.0 ? most / least - 1.0 : HUGE_VAL, at_most(kSpread));
}

}  // namespace sulcus::lab
