#pragma once

#include <span>
#include <vector>

#include "app/session/tick_rows.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/edits.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/saved_state.hpp"
#include "haptics/start_place.hpp"
#include "haptics/tick.hpp"

namespace sulcus {

/// A scene ready to tick: burr, state and the memory of a tick, wired together. Used by
/// one thread.
class Simulation {
 public:
  /// `start`: the workpiece; `others`: the bodies beside it, in the scene's order; `first`: as
  /// initial_state takes it.
  Simulation(const Scene& scene, VoxelModel start, std::vector<VoxelModel> others, Burr burr,
             StageClock clock = StageClock{}, const Pose& first = {});
  Simulation(const Simulation&) = delete;  // the context refers into it
  Simulation& operator=(const Simulation&) = delete;

  /// One tick. Its rows and edits stay valid until the next.
  TickRecord step(Device& device, std::span<const std::uint32_t> loose = {}) noexcept {
    last_ = tick(context_, device, state_, scratch_, loose);
    return tick_row(last_, scene_.haptics.rate_hz);
  }
  // For going through a recording, on and back.
  /// An edit that another run made.
  void apply(const Edit& edit) { apply_edit(edit, state_.bodies[edit.body].solid); }
  /// `before`: the level that its voxel had.
  void take_back(const Edit& edit, FillLevel before) {
    take_back_edit(edit, before, state_.bodies[edit.body].solid);
  }
  bool is_solid(const Edit& edit) const noexcept {
    return state_.bodies[edit.body].solid.solid(cell(edit));
  }
  /// As sulcus::load_state.
  bool load_state(std::span<const std::byte> bytes) { return sulcus::load_state(bytes, state_); }

  /// Whether the middle of the burr's head is outside of all bodies: within one it feels nothing.
  bool is_free(const Pose& tool) const noexcept;
  /// As sulcus::warm_caches.
  void warm_caches() noexcept { sulcus::warm_caches(context_, state_, scratch_); }
  std::span<const Edit> edits() const { return scratch_.edits; }
  /// What the last evaluation of the last tick found on a body, 0 the workpiece; what an earlier
  /// tick left behind where the last record has no contacts.
  const Contacts& contacts(std::size_t number) const {
    return scratch_.bodies.at(number).contact.contacts;
  }
  CuttingRecord cutting() const { return cutting_row(last_, state_); }
  PortRecord port() const { return port_row(last_, state_); }
  std::uint64_t stage_ns(Stage stage) const noexcept { return scratch_.stage_ns(stage); }
  void reset_clocks() noexcept { scratch_.reset_clocks(); }

  const Scene& scene() const { return scene_; }
  const Burr& burr() const { return burr_; }
  const Workpiece& workpiece() const { return state_.workpiece().solid; }
  const SimulationState& state() const { return state_; }

  /// Copies of the bodies besides the workpiece, as they are now.
  std::vector<VoxelModel> other_bodies() const;

  /// With the normals that are kept, of all bodies.
  std::size_t contact_bytes() const;
  /// Of the bodies besides the workpiece.
  std::size_t others_bytes() const;
  /// 0 without [cutting].
  std::size_t cutting_bytes() const;

 private:
  Cell cell(const Edit& edit) const noexcept {
    return state_.bodies[edit.body].solid.grid().cell_of_linear(edit.voxel);
  }

  Scene scene_;
  Burr burr_;
  SimulationState state_;
  TickScratch scratch_;
  TickResult last_;
  TickContext context_;
};

}  // namespace sulcus
