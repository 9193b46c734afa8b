#include "tools/sulcus_lab/ticks/ticks_run.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "engine/core/hash.hpp"
#include "engine/core/realtime.hpp"
#include "haptics/tick.hpp"
#include "tools/sulcus_lab/ticks/ticks_path.hpp"

namespace sulcus::lab {

namespace {

/// Poses in a circle, whatever the force.
class LoopDevice final : public Device {
 public:
  explicit LoopDevice(std::span<const Pose> poses) : poses_(poses) {}
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    return poses_[tick % poses_.size()];
  }
  void apply(const Wrench&) noexcept override {}

 private:
  std::span<const Pose> poses_;
};

/// The workpiece, and bodies of its size in a row along x, as teeth stand, of which nothing but
/// where they are counts here.
std::vector<Workpiece> body_row(const Workpiece& workpiece, Scene& scene, int bodies) {
  const VoxelGrid& grid = workpiece.grid();
  VoxelModel empty;
  empty.grid = {Cell::Constant(kLeafEdge), grid.voxel_m * grid.cells.x() / kLeafEdge};
  empty.leaves.resize(1);
  std::vector<Workpiece> row{workpiece};
  for (int b = 1; b < bodies; ++b) {
    BodySettings& other = scene.bodies.emplace_back();
    other.world_from_grid.position.x() = b * 1.05 * grid.voxel_m * grid.cells.x();
    row.emplace_back(empty);
  }
  return row;
}

Scene scene_of(const TickTask& task, const TickSetting& setting) {
  Scene scene;
  scene.haptics = haptics_of(setting, task.wanted);
  scene.tissues = tick_tissues(task.specific_energy_J_per_m3);
  if (setting.cache == TickCache::kCutting) scene.cutting.emplace();
  return scene;
}

}  // namespace

std::string_view method_name(const TickSetting& setting) {
  return kNormalMethodNames[static_cast<std::size_t>(setting.method)];
}

std::string_view cache_name(const TickSetting& setting) {
  return kTickCacheNames[static_cast<std::size_t>(setting.cache)];
}

HapticsSettings haptics_of(const TickSetting& setting, int wanted) {
  HapticsSettings haptics = counting_settings(wanted);
  haptics.normals = setting.method;
  if (setting.method == NormalMethod::kLdmPaper) haptics.trace = 5;
  haptics.keep_normals = setting.cache != TickCache::kFresh;
  return haptics;
}

std::vector<TissueSettings> tick_tissues(double specific_energy_J_per_m3) {
  std::vector<TissueSettings> tissues;
  for (const char* name : {"enamel", "dentine", "pulp"}) {
    TissueSettings& tissue = tissues.emplace_back();
    tissue.name = name;
    tissue.specific_energy_J_per_m3 = specific_energy_J_per_m3;
  }
  return tissues;
}

TickSamples run_ticks(const TickTask& task, const TickSetting& setting, StageClock::Now now) {
  Scene scene = scene_of(task, setting);
  std::vector<Workpiece> row = body_row(task.start, scene, task.bodies);
  SimulationState state = initial_state(scene, std::move(row));
  const TickContext context{scene, task.burr};
  TickScratch scratch(scene, StageClock(now));
  LoopDevice device(task.poses);
  for (int t = 0; t < task.lead; ++t) tick(context, device, state, scratch);

  TickSamples samples;
  const auto count = static_cast<std::size_t>(task.ticks);
  samples.us.reserve(count);
  samples.contacts.reserve(count);
  samples.removed.reserve(count);
  for (auto& stage : samples.stage_us) stage.reserve(now ? count : 0);
  const InstructionCounter counter;
  const std::uint64_t before = counter.read();
  for (int t = 0; t < task.ticks; ++t) {
    scratch.reset_clocks();
    const std::uint64_t begin = thread_cpu_ns();
    const TickResult result = tick(context, device, state, scratch);
    samples.us.push_back(1e-3f * static_cast<float>(thread_cpu_ns() - begin));
    samples.contacts.push_back(result.contact.contacts);
    samples.removed.push_back(result.removed);
    samples.faults |= result.faults;
    std::array<double, 6> wrench;
    std::copy_n(result.contact.wrench.force_N.data(), 3, wrench.begin());
    std::copy_n(result.contact.wrench.torque_Nm.data(), 3, wrench.begin() + 3);
    samples.force_hash = hash_bytes(wrench.data(), sizeof(wrench), samples.force_hash);
    if (!now) continue;
    for (int s = 0; s < kStageCount; ++s) {
      const std::uint64_t ns = scratch.stage_ns(static_cast<Stage>(s));
      samples.stage_us[static_cast<std::size_t>(s)].push_back(1e-3f * static_cast<float>(ns));
    }
  }
  samples.instructions = counter.read() - before;
  return samples;
}

InstructionCounter::InstructionCounter() {
  perf_event_attr event{};
  event.size = sizeof event;
  event.type = PERF_TYPE_HARDWARE;
  event.config = PERF_COUNT_HW_INSTRUCTIONS;
  event.exclude_kernel = 1;
  event.exclude_hv = 1;
  // The C library has no function of that name.
  file_ = static_cast<int>(syscall(SYS_perf_event_open, &event, 0, -1, -1, 0));
  if (file_ < 0) refused_ = std::string("perf_event_open: ") + std::strerror(errno);
}

InstructionCounter::~InstructionCounter() {
  if (file_ >= 0) close(file_);
}

std::uint64_t InstructionCounter::read() const noexcept {
  std::uint64_t count = 0;
  if (file_ < 0 || ::read(file_, &count, sizeof count) != sizeof count) return 0;
  return count;
}

}  // namespace sulcus::lab
