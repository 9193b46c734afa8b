#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "haptics/tick.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

// A scene that ticks, for tests.

namespace sulcus::test {

inline constexpr double kTickVoxel = 50e-6;

/// Poses from a list, and the wrenches that came back.
class ListDevice final : public Device {
 public:
  explicit ListDevice(std::vector<Pose> list) : poses(std::move(list)) {
    applied.reserve(poses.size() + 10);
  }
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    return poses[std::min<std::size_t>(tick, poses.size() - 1)];
  }
  void apply(const Wrench& wrench) noexcept override { applied.push_back(wrench); }

  std::vector<Pose> poses;
  std::vector<Wrench> applied;
};

inline Scene make_scene(bool cutting) {
  Scene scene;
  scene.tissues = one_tissue();
  scene.tissues[0].specific_energy_J_per_m3 = 0.05e9;  // soft, so that voxels go within a few ticks
  if (cutting) scene.cutting.emplace();
  return scene;
}

inline const Burr& burr() {
  static const Burr round = make_burr(small_burr(), kTickVoxel);
  return round;
}

/// Down into a flat block and along it, aslant.
inline std::vector<Pose> path(int ticks) {
  std::vector<Pose> poses;
  const Eigen::Vector3d axis = Eigen::Vector3d(0.5, 0.2, 1).normalized();
  for (int i = 0; i < ticks; ++i) {
    const double down_m = std::min(i, 60) * 5e-6;
    poses.push_back(pose_along(Eigen::Vector3d(-0.3e-3 + i * 2e-6, 0.1e-3, 0.1e-3 - down_m), axis));
  }
  return poses;
}

/// A scene in the middle of being run.
struct TickRun {
  explicit TickRun(bool cutting, const VoxelModel& start = block({64, 64, 64}, kTickVoxel,
                                                                 {0, 0, 0}, {64, 64, 32}))
      : scene(make_scene(cutting)),
        context{scene, burr()},
        state(initial_state(scene, {Workpiece(start)})),
        scratch(scene) {}
  const Workpiece& workpiece() const { return state.workpiece().solid; }
  RemovalState& removal() { return *state.workpiece().removal; }
  void replace(const VoxelModel& start) { state.bodies = make_bodies(scene, {Workpiece(start)}); }
  /// From the start again, after the scene was changed.
  void begin_again(const Pose& start = {}) {
    state = initial_state(scene, {workpiece()}, start);
    scratch = TickScratch(scene);
  }
  TickResult step(Device& device) {
    const TickResult record = tick(context, device, state, scratch);
    edits.insert(edits.end(), scratch.edits.begin(), scratch.edits.end());
    return record;
  }
  std::vector<TickResult> steps(Device& device, int count) {
    std::vector<TickResult> records;
    for (int i = 0; i < count; ++i) records.push_back(step(device));
    return records;
  }

  Scene scene;
  TickContext context;
  SimulationState state;
  TickScratch scratch;
  std::vector<Edit> edits;
};

/// Behind a coupling, as stiff as tissues are there.
struct CoupledTickRun : TickRun {
  explicit CoupledTickRun(bool cutting) : TickRun(cutting) {
    scene.coupling.emplace();
    scene.tissues[0].stiffness_N_per_m *= 10.0;
  }
};

/// A pose, or none, for each tick; the last for ever.
class SilentDevice final : public Device {
 public:
  explicit SilentDevice(std::vector<std::optional<Pose>> list) : poses(std::move(list)) {}
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    return poses[std::min<std::size_t>(tick, poses.size() - 1)];
  }
  void apply(const Wrench& wrench) noexcept override { last = wrench; }

  std::vector<std::optional<Pose>> poses;
  Wrench last;
};

inline std::vector<std::optional<Pose>> with_none(std::vector<Pose> poses) {
  return {poses.begin(), poses.end()};
}

inline bool same(const Wrench& a, const Wrench& b) {
  return a.force_N == b.force_N && a.torque_Nm == b.torque_Nm;
}
inline bool same(const Pose& a, const Pose& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}
inline bool same(const TickResult& a, const TickResult& b) {
  return a.tick == b.tick && same(a.device, b.device) && same(a.tool, b.tool) &&
         same(a.contact.wrench, b.contact.wrench) &&
         same(a.contact.tangential, b.contact.tangential) &&
         a.contact.contacts == b.contact.contacts && a.contact.tested == b.contact.tested &&
         a.contact.leaves == b.contact.leaves && same(a.commanded, b.commanded) &&
         same(a.sent, b.sent) && a.spindle_rad_per_s == b.spindle_rad_per_s &&
         a.evaluations == b.evaluations && a.removed == b.removed && a.faults == b.faults;
}
inline bool same(const std::vector<TickResult>& a, const std::vector<TickResult>& b) {
  return std::ranges::equal(a, b, [](const auto& x, const auto& y) { return same(x, y); });
}

}  // namespace sulcus::test
