#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "app/session/feed.hpp"
#include "engine/core/pose.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/graphics/rendered_body.hpp"
#include "engine/surface/drawn_surface.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/level_changes.hpp"

namespace sulcus {

/// A run that is still going on, as it was some time ago: keeps its edits, and where the burr was
/// every 20 ticks, and takes a drawing (a GlScene) back and on again. What was cut loose stays
/// where it lies now. Used by one thread.
class RewindFilm {
 public:
  /// The bodies before the first tick.
  explicit RewindFilm(std::span<const RenderedBody> bodies);

  /// A tick and its edits, after the drawing has been brought to the present.
  void add(const TickReport& report, std::span<const Edit> edits);
  /// From wherever it is to a time, at the earliest that of the first tick. The state becomes that
  /// of a picture of then, without what is not known of it.
  template <class Drawing>
  void look_back(double time_s, Drawing& drawing, FrameState& state) {
    if (moments_.empty()) return;
    const Moment& moment = moment_at(time_s);
    go_to(moment.edits_end, drawing);
    describe(moment, state);
  }
  /// To the present; before more edits are drawn.
  template <class Drawing>
  void come_back(Drawing& drawing) {
    go_to(edits_.size(), drawing);
  }

 private:
  struct Moment {
    double time_s;
    std::uint64_t tick;
    std::size_t edits_end;
    Pose tool, device;
  };
  /// Edits as a drawing takes them, by body.
  struct Change {
    std::vector<std::vector<std::uint32_t>> voxels;  // that go, or come back
    std::vector<std::vector<VoxelLevel>> levels;
  };

  const Moment& moment_at(double time_s) const;
  static void describe(const Moment& moment, FrameState& state);
  Change change_to(std::size_t edits_end) const;
  template <class Drawing>
  void go_to(std::size_t edits_end, Drawing& drawing) {
    const std::size_t drawn = drawn_.value_or(edits_.size());
    if (edits_end == drawn) return;
    const Change change = change_to(edits_end);
    for (std::size_t body = 0; body < change.voxels.size(); ++body) {
      if (edits_end < drawn) {
        if (!change.voxels[body].empty()) drawing.restore(body, change.voxels[body]);
        if (!change.levels[body].empty()) drawing.set_levels(body, change.levels[body]);
      } else {
        if (!change.levels[body].empty()) drawing.set_levels(body, change.levels[body]);
        if (!change.voxels[body].empty()) drawing.remove(body, change.voxels[body]);
      }
    }
    drawn_ = edits_end;
    if (edits_end == edits_.size()) drawn_.reset();
  }

  std::vector<LevelChanges> levels_;  // by body
  std::vector<Edit> edits_;
  std::vector<FillLevel> before_;  // beside them: the level that each voxel had
  std::vector<Moment> moments_;
  std::optional<std::size_t> drawn_;  // edits that are drawn; none: all
};

}  // namespace sulcus
