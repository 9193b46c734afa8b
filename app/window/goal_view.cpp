#include "app/window/goal_view.hpp"

#include <chrono>
#include <utility>

#include "app/pictures/goal_section.hpp"
#include "app/playback/film_colours.hpp"
#include "engine/core/realtime.hpp"
#include "engine/outcome/goal.hpp"

namespace sulcus {

VoxelSet removed_since(const VoxelModel& start, const VoxelModel& now) {
  VoxelSet removed(start.grid);
  for (std::uint32_t leaf = 0; leaf < start.grid.leaf_count(); ++leaf) {
    const LeafBits gone = without(start.leaves[leaf], now.leaves[leaf]);
    if (any(gone)) removed.insert(leaf, gone);
  }
  return removed;
}

GoalView::GoalView(const Scene& scene, const VoxelModel& start, const VoxelModel* from_file) {
  if (!scene.goal) return;
  target_ = target_of_goal(scene, start, from_file);
  start_ = start;
}

void GoalView::show(GlScene& drawing, const PictureControls& controls) {
  if (!target_) return;
  if (controls.plan != ghost_shown_) {
    ghost_shown_ = controls.plan;
    if (ghost_shown_) {
      drawing.set_ghost(model_of(*target_));
    } else {
      drawing.take_ghost_away();
    }
  }
  show_colours(drawing, controls.by_plan);
}

void GoalView::show_colours(GlScene& drawing, bool asked) {
  const bool is_ready =
      reckoned_.valid() && reckoned_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  if (is_ready) {
    VoxelValues values = reckoned_.get();
    if (asked) drawing.colour_by_values(0, goal_scale(), std::move(values));
    coloured_ = coloured_ || asked;
  }
  if (!asked) {
    if (coloured_) drawing.colour_by_tissue(0);
    coloured_ = false;
    solid_reckoned_.reset();
    return;
  }
  constexpr std::uint64_t kPause_ns = 500'000'000;
  const std::uint64_t now_ns = steady_ns();
  if (reckoned_.valid() || now_ns < next_look_ns_) return;
  next_look_ns_ = now_ns + kPause_ns;
  const VoxelModel& tooth = drawing.surface().model();
  const std::uint64_t solid = tooth.solid_count();
  if (solid_reckoned_ == solid) return;
  solid_reckoned_ = solid;
  reckoned_ = std::async(std::launch::async, [this, tooth] {
    return goal_distances(tooth, removed_since(*start_, tooth), *target_);
  });
}

}  // namespace sulcus
