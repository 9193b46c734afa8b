#include "tools/sulcus_lab/ticks/ticks_cutting.hpp"

#include <algorithm>
#include <cstdlib>

#include "haptics/tick.hpp"
#include "tools/sulcus_lab/ticks/ticks_run.hpp"

namespace sulcus::lab {

namespace {

constexpr double kUncut = 1e30;                                // J/m^3: more than all ticks bring
constexpr double kSharePerTick = 10103.0 / (20000.0 * 351.0);  // [Kim and Park 2019, Table 1]
constexpr int kTrialTicks = 1500;
constexpr double kLargestSink = 2e-6;  // m, in a tick, at least

double voxels_per_tick(int wanted) { return kSharePerTick * wanted; }

/// The path in a circle, each place of it lower or higher by what was learnt there.
class SinkingDevice final : public Device {
 public:
  explicit SinkingDevice(const std::vector<Pose>& path) : path_(path), lift_m_(path.size(), 0.0) {}
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    Pose pose = path_[tick % path_.size()];
    pose.position.z() += lift_m_[tick % path_.size()];
    return pose;
  }
  void apply(const Wrench&) noexcept override {}

  /// All places by one way, and those around a tick's by another that fades to both sides.
  void lift(std::uint64_t tick, double all_m, double here_m) {
    const auto count = static_cast<int>(path_.size());
    for (double& lift : lift_m_) lift += all_m;
    const int at = static_cast<int>(tick % path_.size());
    for (int to = -kReach; to <= kReach; ++to) {
      const double share = 1.0 - std::abs(to) / (kReach + 1.0);
      lift_m_[static_cast<std::size_t>((at + to + count) % count)] += share * here_m;
    }
  }

 private:
  static constexpr int kReach = 6;
  const std::vector<Pose>& path_;
  std::vector<double> lift_m_;
};

/// One run of cutting on a copy of the workpiece.
class CuttingRun {
 public:
  CuttingRun(const Workpiece& start, const TickPath& path, const HapticsSettings& haptics,
             double specific_energy)
      : device_(path.poses),
        scene_(scene_with(haptics, specific_energy)),
        state_(initial_state(scene_, {start})),
        context_{scene_, path.burr},
        scratch_(scene_) {}
  TickResult step() { return tick(context_, device_, state_, scratch_); }
  SinkingDevice& device() { return device_; }
  double work_J() const { return state_.workpiece().removal->work_J; }

 private:
  static Scene scene_with(const HapticsSettings& haptics, double specific_energy) {
    Scene scene;
    scene.haptics = haptics;
    scene.haptics.keep_normals = false;
    scene.tissues = tick_tissues(specific_energy);
    scene.cutting.emplace();
    return scene;
  }

  SinkingDevice device_;
  Scene scene_;
  SimulationState state_;
  TickContext context_;
  TickScratch scratch_;
};

/// One run; the poses that it went through, and the voxels that went in a tick, of the later half.
struct Sunk {
  std::vector<Pose> poses;
  double removed = 0.0;
};
Sunk sink(const Workpiece& workpiece, const TickPath& path, int wanted, double specific_energy,
          int ticks, const HapticsSettings& haptics) {
  Sunk sunk;
  // Coarse voxels go faster than that: then twice their pace.
  const double largest_m =
      std::max(kLargestSink, 2.0 * voxels_per_tick(wanted) / wanted * workpiece.grid().voxel_m);
  CuttingRun run(workpiece, path, haptics, specific_energy);
  for (int t = 0; t < ticks; ++t) {
    const TickResult result = run.step();
    sunk.poses.push_back({result.tool.position,
                          path.poses[static_cast<std::size_t>(t) % path.poses.size()].orientation});
    if (t >= ticks / 2) sunk.removed += result.removed / (0.5 * ticks);
    // In a cap of height h the contacts grow by 1 / h per way. The whole path follows at once; a
    // place, which comes again after a period, is told through the seven visits around it.
    const double excess_m =
        path.depth_m * (result.contact.contacts / static_cast<double>(wanted) - 1.0);
    run.device().lift(result.tick, std::clamp(0.1 * excess_m, -largest_m, largest_m),
                      std::clamp(0.1 * excess_m, -largest_m, largest_m));
  }
  return sunk;
}

/// As many joules as bring `voxels` a tick where nothing goes.
double energy_uncut(const Workpiece& workpiece, const TickPath& path, int wanted, double voxels) {
  CuttingRun run(workpiece, path, counting_settings(wanted), kUncut);
  for (std::size_t t = 0; t < path.poses.size(); ++t) run.step();
  const double work_J = run.work_J() / static_cast<double>(path.poses.size());
  return work_J / (voxels * workpiece.grid().voxel_volume_m3());
}

}  // namespace

double find_specific_energy(const Workpiece& workpiece, const TickPath& path, int wanted,
                            int ticks) {
  const double voxels = voxels_per_tick(wanted);
  double energy = energy_uncut(workpiece, path, wanted, voxels);
  // Ground that the burr has shaped lies less deep in it: less force, less work. Two rounds.
  for (int round = 0; round < 2; ++round) {
    const Sunk trial = sink(workpiece, path, wanted, energy, std::min(ticks, kTrialTicks),
                            counting_settings(wanted));
    energy *= std::clamp(trial.removed / voxels, 0.1, 2.0);
  }
  return energy;
}

CuttingPlan plan_cutting(const Workpiece& workpiece, const TickPath& path, int wanted, int ticks,
                         double specific_energy_J_per_m3, const HapticsSettings& haptics) {
  return {specific_energy_J_per_m3,
          sink(workpiece, path, wanted, specific_energy_J_per_m3, ticks, haptics).poses};
}

}  // namespace sulcus::lab
