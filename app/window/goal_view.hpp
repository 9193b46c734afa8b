#pragma once

#include <cstdint>
#include <future>
#include <optional>

#include "engine/graphics/gl_scene.hpp"
#include "engine/graphics/panels.hpp"
#include "engine/outcome/voxel_set.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"
#include "engine/volume/voxel_values.hpp"

namespace sulcus {

/// What a window shows of a scene's [goal]: a ghost of the planned cavity, and the tooth coloured
/// by how far it is from that. The colours follow what is cut about twice a second: they are
/// reckoned beside the window, on oneTBB, and only while they are asked for. Nothing is kept of a
/// scene without a goal. Main thread.
class GoalView {
 public:
  /// `start`: the tooth before all cutting; `from_file`: as target_of_goal.
  GoalView(const Scene& scene, const VoxelModel& start, const VoxelModel* from_file);

  bool has_goal() const { return target_.has_value(); }
  /// Brings a drawing to what the controls ask for, before it draws.
  void show(GlScene& drawing, const PictureControls& controls);

 private:
  void show_colours(GlScene& drawing, bool asked);

  std::optional<VoxelSet> target_;
  std::optional<VoxelModel> start_;
  bool ghost_shown_ = false, coloured_ = false;
  std::uint64_t next_look_ns_ = 0;
  std::optional<std::uint64_t> solid_reckoned_;  // voxels of the tooth that was last reckoned with
  std::future<VoxelValues> reckoned_;
};

/// What was solid in `start` and is not any more.
VoxelSet removed_since(const VoxelModel& start, const VoxelModel& now);

}  // namespace sulcus
