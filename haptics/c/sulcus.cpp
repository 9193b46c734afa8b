#include "haptics/c/sulcus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/scene/scene_file.hpp"
#include "haptics/c/c_values.hpp"
#include "haptics/c/handle.hpp"
#include "haptics/c/scene_run.hpp"
#include "haptics/c/simulation_handle.hpp"

namespace sulcus {

namespace {

constexpr std::array<const char*, 12> kTexts{
    "done",
    "a pointer that has to be there is NULL",
    "the handle was closed",
    "another thread is using the handle",
    "a number is not finite or out of range, or an orientation is not of length 1",
    "a scene, a file or a saved state cannot be used",
    "there is no room for what was asked",
    "the scene's device is a plug-in: step with poses",
    "edits that far back are no longer kept",
    "a force was not finite: the run has ended",
    "not for a scene like this, or not in this build",
    "out of memory, or an error of the library: close the handle",
};

void put(const Pose& pose, double (&to)[7]) noexcept {
  for (int a = 0; a < 3; ++a) to[a] = pose.position[a];
  to[3] = pose.orientation.w();
  for (int a = 0; a < 3; ++a) to[4 + a] = pose.orientation.vec()[a];
}

void put(const Wrench& wrench, double* to) noexcept {
  for (int a = 0; a < 3; ++a) {
    to[a] = wrench.force_N[a];
    to[3 + a] = wrench.torque_Nm[a];
  }
}

/// What the caller says of a source, as far as it knows the structure.
SulcusSource known(const SulcusSource& source) noexcept {
  SulcusSource whole{};
  std::memcpy(&whole, &source, std::min(source.struct_size, sizeof whole));
  return whole;
}

Scene scene_of(const SulcusSource& source) {
  std::vector<std::string> overrides;
  for (std::size_t i = 0; i < source.override_count; ++i) {
    overrides.emplace_back(source.overrides[i]);
  }
  const std::string file = source.file ? source.file : "scene";
  return source.text ? parse_scene(source.text, file, overrides) : load_scene(file, overrides);
}

bool has_all_pointers(const SulcusSource& source) noexcept {
  if (!source.file && !source.text) return false;
  if (source.override_count > 0 && !source.overrides) return false;
  return std::all_of(source.overrides, source.overrides + source.override_count,
                     [](const char* text) { return text != nullptr; });
}

/// A step, and what comes out of it.
template <class Step>
int step_with(SulcusSimulation* simulation, double* wrench, const Step& step) noexcept {
  return with_run(simulation, [&](SceneRun& run) -> int {
    if (run.has_ended()) return SULCUS_ENDED;
    const TickResult* result = step(run);
    if (!result) return SULCUS_NO_DEVICE;
    if (wrench) put(result->sent, wrench);
    return run.has_ended() ? SULCUS_ENDED : SULCUS_DONE;
  });
}

template <class T, class Value>
int answer(const SulcusSimulation* simulation, T* to, const Value& value) noexcept {
  if (!to) return SULCUS_NULL;
  return with_run(simulation, [&](SceneRun& run) -> int {
    *to = value(run);
    return SULCUS_DONE;
  });
}

SulcusTick tick_of(const SceneRun& run) noexcept {
  const TickResult& last = run.last();
  SulcusTick tick{};
  tick.tick = last.tick;
  tick.time_s = static_cast<double>(last.tick) / run.scene().haptics.rate_hz;
  put(last.device, tick.device_pose);
  put(last.tool, tick.tool_pose);
  put(last.sent, tick.wrench);
  put(last.contact.wrench, tick.contact_wrench);
  tick.spindle_rad_per_s = last.spindle_rad_per_s;
  tick.contacts = last.contact.contacts;
  tick.removed = last.removed;
  tick.faults = last.faults;
  tick.evaluations = static_cast<std::uint32_t>(last.evaluations);
  return tick;
}

}  // namespace

}  // namespace sulcus

using namespace sulcus;  // NOLINT: what follows is C

const char* sulcus_release(void) { return SULCUS_RELEASE; }
uint32_t sulcus_version(void) { return SULCUS_VERSION; }
const char* sulcus_error_text(int code) {
  const auto number = static_cast<std::size_t>(code);
  return number < kTexts.size() ? kTexts[number] : "no code of this library";
}

int sulcus_open(const SulcusSource* source, SulcusSimulation** simulation, char* error,
                size_t error_size) {
  if (!source || !simulation) return SULCUS_NULL;
  const SulcusSource whole = known(*source);
  if (!has_all_pointers(whole)) return SULCUS_NULL;
  return guarded(
      [&]() -> int {
        Scene scene = scene_of(whole);
        std::optional<VoxelModel> own;
        if (whole.voxels) own = own_voxels(scene, std::span(whole.voxels, whole.voxel_count));
        SceneParts parts = load_parts(scene, std::move(own));
        auto made = std::make_unique<SulcusSimulation>();
        made->run = std::make_unique<SceneRun>(std::move(scene), std::move(parts));
        *simulation = made.release();
        return SULCUS_DONE;
      },
      error, error_size);
}

int sulcus_open_file(const char* file, SulcusSimulation** simulation, char* error,
                     size_t error_size) {
  SulcusSource source{};
  source.struct_size = sizeof source;
  source.file = file;
  return sulcus_open(&source, simulation, error, error_size);
}

int sulcus_close(SulcusSimulation* simulation) {
  return with_run(simulation, [&](SceneRun&) -> int {
    simulation->run.reset();
    return SULCUS_DONE;
  });
}

int sulcus_free(SulcusSimulation** simulation) {
  if (!simulation) return SULCUS_NULL;
  if (!*simulation) return SULCUS_DONE;
  if (!Turn((*simulation)->taken).is_ours()) return SULCUS_BUSY;
  delete std::exchange(*simulation, nullptr);
  return SULCUS_DONE;
}

int sulcus_step(SulcusSimulation* simulation, const double pose[7], double wrench[6]) {
  if (!pose) return SULCUS_NULL;
  const std::optional<Pose> read = pose_from(std::span<const double, 7>(pose, 7));
  if (!read) return simulation ? SULCUS_BAD_VALUE : SULCUS_NULL;
  return step_with(simulation, wrench, [&](SceneRun& run) { return &run.step(*read); });
}

int sulcus_step_scene(SulcusSimulation* simulation, double wrench[6]) {
  return step_with(simulation, wrench, [](SceneRun& run) -> const TickResult* {
    return run.has_own_device() ? &run.step_scene() : nullptr;
  });
}

int sulcus_scene_ticks(const SulcusSimulation* simulation, uint64_t* ticks) {
  return answer(simulation, ticks, [](const SceneRun& run) { return run.scene_ticks(); });
}

int sulcus_scene_pose(const SulcusSimulation* simulation, double time_s, double pose[7]) {
  if (!pose) return SULCUS_NULL;
  return with_run(simulation, [&](SceneRun& run) -> int {
    if (!std::isfinite(time_s)) return SULCUS_BAD_VALUE;
    double numbers[7];
    put(run.trajectory().pose_at(time_s), numbers);
    std::copy_n(numbers, 7, pose);
    return SULCUS_DONE;
  });
}

int sulcus_rate_hz(const SulcusSimulation* simulation, double* rate_hz) {
  return answer(simulation, rate_hz,
                [](const SceneRun& run) { return run.scene().haptics.rate_hz; });
}

int sulcus_last_tick(const SulcusSimulation* simulation, SulcusTick* tick) {
  if (!tick) return SULCUS_NULL;
  return with_run(simulation, [&](SceneRun& run) -> int {
    if (run.state().tick == 0) return SULCUS_BAD_VALUE;
    SulcusTick whole = tick_of(run);
    whole.struct_size = tick->struct_size;
    std::memcpy(tick, &whole, std::min(tick->struct_size, sizeof whole));
    return SULCUS_DONE;
  });
}

int sulcus_contacts(const SulcusSimulation* simulation, SulcusContact* contacts, size_t capacity,
                    size_t* count) {
  if (!count || (!contacts && capacity > 0)) return SULCUS_NULL;
  return with_run(simulation, [&](SceneRun& run) -> int {
    *count = 0;
    run.for_each_contact([&](const FeltContact&) { ++*count; });
    if (*count > capacity) return SULCUS_TOO_SMALL;
    run.for_each_contact([&](const FeltContact& felt) { *contacts++ = contact_of(felt); });
    return SULCUS_DONE;
  });
}

int sulcus_edits(const SulcusSimulation* simulation, uint64_t from, SulcusEdit* edits,
                 size_t capacity, size_t* count) {
  if (!count || (!edits && capacity > 0)) return SULCUS_NULL;
  return with_run(simulation, [&](SceneRun& run) -> int {
    const EditLog& log = run.edits();
    if (from > log.end()) return SULCUS_BAD_VALUE;
    if (from < log.begin()) return SULCUS_LOST;
    const auto taken =
        static_cast<std::size_t>(std::min<std::uint64_t>(log.end() - from, capacity));
    for (std::size_t i = 0; i < taken; ++i) {
      edits[i] = edit_of(log[from + i]);
    }
    *count = taken;
    return SULCUS_DONE;
  });
}

int sulcus_edit_count(const SulcusSimulation* simulation, uint64_t* count) {
  return answer(simulation, count, [](const SceneRun& run) { return run.edits().end(); });
}

int sulcus_grid(const SulcusSimulation* simulation, uint32_t body, SulcusGrid* grid) {
  if (!grid) return SULCUS_NULL;
  return with_run(simulation, [&](SceneRun& run) -> int {
    if (body >= run.state().bodies.size()) return SULCUS_BAD_VALUE;
    const Body& of = run.state().bodies[body];
    const VoxelGrid& from = of.solid.grid();
    const Eigen::Vector3d origin = of.world_from_grid.point(from.centre_world(Cell::Zero()));
    for (int a = 0; a < 3; ++a) {
      grid->cells[a] = from.cells[a];
      grid->origin_m[a] = origin[a];
    }
    grid->voxel_m = from.voxel_m;
    return SULCUS_DONE;
  });
}

int sulcus_volume(const SulcusSimulation* simulation, uint32_t body, uint8_t* bits, size_t size,
                  size_t* needed) {
  if (!needed || (!bits && size > 0)) return SULCUS_NULL;
  return with_run(simulation, [&](SceneRun& run) -> int {
    if (body >= run.state().bodies.size()) return SULCUS_BAD_VALUE;
    const VoxelModel& model = run.state().bodies[body].solid.model();
    *needed = static_cast<std::size_t>(model.grid.cell_count() / 8);
    if (size < *needed) return SULCUS_TOO_SMALL;
    write_bits(model, std::span(bits, *needed));
    return SULCUS_DONE;
  });
}

int sulcus_solid_voxels(const SulcusSimulation* simulation, uint64_t* voxels) {
  return answer(simulation, voxels,
                [](const SceneRun& run) { return run.workpiece().solid_voxels(); });
}

int sulcus_volume_hash(const SulcusSimulation* simulation, uint64_t* hash) {
  return answer(simulation, hash, [](const SceneRun& run) { return run.volume_hash(); });
}
int sulcus_force_hash(const SulcusSimulation* simulation, uint64_t* hash) {
  return answer(simulation, hash, [](const SceneRun& run) { return run.force_hash(); });
}
int sulcus_state_hash(const SulcusSimulation* simulation, uint64_t* hash) {
  return answer(simulation, hash, [](const SceneRun& run) { return run.state().hash(); });
}

int sulcus_save(SulcusSimulation* simulation, void* bytes, size_t size, size_t* needed) {
  if (!needed || (!bytes && size > 0)) return SULCUS_NULL;
  return with_run(simulation, [&](SceneRun& run) -> int {
    if (!run.can_be_saved()) return SULCUS_UNSUPPORTED;
    const std::vector<std::byte> saved = run.saved();
    *needed = saved.size();
    if (size < saved.size()) return SULCUS_TOO_SMALL;
    std::memcpy(bytes, saved.data(), saved.size());
    return SULCUS_DONE;
  });
}

int sulcus_restore(SulcusSimulation* simulation, const void* bytes, size_t size, char* error,
                   size_t error_size) {
  if (!bytes) return SULCUS_NULL;
  return with_run(
      simulation,
      [&](SceneRun& run) -> int {
        if (!run.can_be_saved()) return SULCUS_UNSUPPORTED;
        run.restore(std::span(static_cast<const std::byte*>(bytes), size));
        return SULCUS_DONE;
      },
      error, error_size);
}
