#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/core/fault.hpp"
#include "engine/scene/scene.hpp"
#include "haptics/c/edit_log.hpp"
#include "haptics/c/scene_parts.hpp"
#include "haptics/device/simulated_device.hpp"
#include "haptics/loose_schedule.hpp"
#include "haptics/tick.hpp"

namespace sulcus {

/// A voxel in contact, as others get it.
struct FeltContact {
  Eigen::Vector3d position_world;  // m, of the voxel's centre
  Eigen::Vector3f normal_world;    // unit, out of the tooth; zero: none
  float depth_m = 0.0f, force_N = 0.0f;
  std::uint32_t voxel = 0;  // VoxelGrid::linear
  std::uint16_t body = 0;
  std::uint8_t tissue = 0;  // of the scene's
};

/// Which voxels are solid: 8 a byte, the lowest bit first, x fastest, then y, then z. `bits`: cells
/// / 8 bytes.
void write_bits(const VoxelModel& model, std::span<std::uint8_t> bits) noexcept;

/// A scene run tick by tick by a program that embeds it: what the faces to C and Python stand on.
/// The same bits as a run of the program at pace `fast`. Used by one thread at a time.
class SceneRun {
 public:
  SceneRun(Scene scene, SceneParts parts);
  SceneRun(const SceneRun&) = delete;  // the context refers into it
  SceneRun& operator=(const SceneRun&) = delete;

  /// One tick with the hand at a pose, finite, its orientation of length 1. Takes no memory but
  /// in a scene with [loose_pieces], every tenth time, where it may throw std::bad_alloc.
  const TickResult& step(const Pose& pose);
  /// The same with the scene's own device, which there has to be one of (has_own_device).
  const TickResult& step_scene();
  bool has_own_device() const { return !scene_.device || simulated_.has_value(); }
  /// A force was not finite: no tick more is of use.
  bool has_ended() const { return (last_.faults & kFaultNotFinite) != 0; }

  const Scene& scene() const { return scene_; }
  const Burr& burr() const { return burr_; }
  const Trajectory& trajectory() const { return trajectory_; }
  /// Of the scene's trajectory.
  std::uint64_t scene_ticks() const {
    return ticks_in(trajectory_.duration_s(), scene_.haptics.rate_hz);
  }
  const SimulationState& state() const { return state_; }
  const Workpiece& workpiece() const { return state_.workpiece().solid; }
  /// Of the last tick; before the first one with zeros.
  const TickResult& last() const { return last_; }
  /// Calls `visit(FeltContact)` for what the last tick's force came from, body by body.
  template <class Visit>
  void for_each_contact(const Visit& visit) const {
    if (last_.contact.contacts == 0) return;
    for (std::size_t body = 0; body < state_.bodies.size(); ++body) {
      if (scratch_.bodies[body].result.contacts == 0) continue;
      for (const Contact& contact : scratch_.bodies[body].contact.contacts) {
        if (contact.weight != 0.0f) visit(felt(contact, body));
      }
    }
  }
  const EditLog& edits() const { return edits_; }

  std::uint64_t volume_hash() const { return workpiece().hash(); }
  std::uint64_t force_hash() const { return force_hash_; }

  /// Whether save and restore can: not with [loose_pieces].
  bool can_be_saved() const { return !finder_; }
  /// All of it, for a run of the same scene.
  std::vector<std::byte> saved() const;
  /// A tick after it gives the same bits as one after `saved`. InputError, and nothing is changed,
  /// where the bytes are not of such a run.
  void restore(std::span<const std::byte> bytes);

 private:
  const TickResult& tick_with(Device& device);
  void look_for_pieces(std::uint64_t tick);
  FeltContact felt(const Contact& contact, std::size_t body) const noexcept;

  Scene scene_;
  Burr burr_;
  Trajectory trajectory_;
  SimulationState state_;
  TickScratch scratch_;
  TickContext context_;
  TickResult last_;
  EditLog edits_;
  std::uint64_t start_hash_ = 0;  // of what it began with
  std::uint64_t force_hash_ = 0;
  std::optional<ScriptedDevice> scripted_;  // one of the two, or none with a plug-in
  std::optional<SimulatedDevice> simulated_;
  std::optional<LooseFinder> finder_;  // with [loose_pieces] only
  LooseSchedule loose_;
  std::deque<LooseAnswer> answers_;
};

}  // namespace sulcus
