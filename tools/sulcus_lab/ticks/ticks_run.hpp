#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/stage_clock.hpp"

namespace sulcus::lab {

/// Counts the instructions of the calling thread, outside the kernel, where the system lets it
/// (perf_event_open; virtual machines often have no such counter). Else it reads 0.
class InstructionCounter {
 public:
  InstructionCounter();
  ~InstructionCounter();
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;

  /// Since it was made.
  std::uint64_t read() const noexcept;
  /// Why it does not count; empty where it does.
  const std::string& refused() const { return refused_; }

 private:
  int file_ = -1;
  std::string refused_;
};

/// Where the normals of a tick come from.
enum class TickCache : std::uint8_t {
  kFresh,    // every one is found anew
  kKept,     // all were found in earlier ticks
  kCutting,  // voxels go in every tick
};
inline constexpr std::array<std::string_view, 3> kTickCacheNames{"fresh", "kept", "cutting"};

struct TickSetting {
  NormalMethod method = NormalMethod::kLdm;
  TickCache cache = TickCache::kFresh;
  bool operator==(const TickSetting&) const = default;
};
std::string_view method_name(const TickSetting& setting);
std::string_view cache_name(const TickSetting& setting);

/// [haptics] of a setting with `wanted` voxels in contact, at neighbourhood 6.
///
/// `scaling = "smooth"`, the default: it is what a scene has that says nothing, and the dearer:
/// depth and gradient are sampled a second time, at each contact's own surface point.
HapticsSettings haptics_of(const TickSetting& setting, int wanted);

/// What is run: a burr at poses over a workpiece, one tick after another, from the first pose again
/// after the last. The referred objects outlive it.
struct TickTask {
  const Workpiece& start;
  const Burr& burr;
  std::span<const Pose> poses;
  int wanted = 0;                         // voxels in contact
  int lead = 0;                           // ticks before those that count
  int ticks = 0;                          // that count
  int bodies = 1;                         // the workpiece, and others in a row beside it
  double specific_energy_J_per_m3 = 0.0;  // kCutting only
};

/// What came of the ticks that count.
struct TickSamples {
  std::vector<float> us;                                 // thread CPU time of each
  std::array<std::vector<float>, kStageCount> stage_us;  // with a clock only
  std::vector<std::uint32_t> contacts, removed;
  std::uint64_t force_hash = 0;    // over forces and torques, in order
  std::uint64_t instructions = 0;  // of all of them; 0 where the system does not count them
  std::uint64_t faults = 0;        // bits of Fault
};

/// Runs a task on a copy of the workpiece. With `now` the stages are timed as well, which
/// the ticks' own times then pay for.
TickSamples run_ticks(const TickTask& task, const TickSetting& setting,
                      StageClock::Now now = nullptr);

/// The tissues of every run: those of the molar, all as stiff as enamel, and as hard to cut.
std::vector<TissueSettings> tick_tissues(double specific_energy_J_per_m3);

}  // namespace sulcus::lab
