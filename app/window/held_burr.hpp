#pragma once

#include "engine/core/pose.hpp"
#include "engine/graphics/camera.hpp"
#include "engine/graphics/window_input.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The burr under the mouse. While the left button is held it is moved in the plane of the picture,
/// away from the eye with shift, tilted about its tip with control. Let go, it is lifted off the
/// tooth, where it does not cut, and pressed again it is set down where it was.
class HeldBurr {
 public:
  explicit HeldBurr(const Pose& start) : pose_(start), down_(start) {}

  /// Whether it has a new pose. `tool`: where the burr is, which the tooth may hold back from the
  /// hand; `tooth`: as it is now; `height` of the picture, pixels.
  bool follow(const WindowInput& input, const View& view, int height, const Pose& tool,
              const VoxelModel& tooth, const Burr& burr);
  /// At first, when nobody holds it yet, as where it is let go.
  bool begin(const Pose& tool, const VoxelModel& tooth, const Burr& burr) {
    return lift(tool, tooth, burr);
  }
  const Pose& pose() const { return pose_; }
  bool is_lifted() const { return lifted_; }

 private:
  bool set_down();
  bool lift(const Pose& tool, const VoxelModel& tooth, const Burr& burr);
  bool drag(const WindowInput& input, const View& view, int height);

  Pose pose_;
  Pose down_;  // to which it comes back
  bool held_ = false, lifted_ = false;
};

}  // namespace sulcus
