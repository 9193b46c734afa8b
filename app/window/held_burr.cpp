#include "app/window/held_burr.hpp"

#include "app/window/burr_lift.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

bool HeldBurr::follow(const WindowInput& input, const View& view, int height, const Pose& tool,
                      const VoxelModel& tooth, const Burr& burr) {
  const bool pressed = input.left && !held_, let_go = !input.left && held_;
  held_ = input.left;
  bool moved = false;
  if (pressed) moved = set_down();
  if (let_go) moved = lift(tool, tooth, burr);
  return drag(input, view, height) || moved;
}

bool HeldBurr::set_down() {
  if (!lifted_) return false;
  lifted_ = false;
  pose_ = down_;
  return true;
}

/// From where the burr is: the hand may be deeper, on the far side of a wall.
bool HeldBurr::lift(const Pose& tool, const VoxelModel& tooth, const Burr& burr) {
  constexpr double kGap_m = 0.4 * kMillimetre;
  if (room_round(tooth, burr, tool, kGap_m) >= kGap_m &&
      room_round(tooth, burr, pose_, kGap_m) >= kGap_m) {
    return false;
  }
  down_ = tool;
  pose_ = drawn_back(tooth, burr, tool, kGap_m).value_or(tool);
  lifted_ = true;
  return true;
}

bool HeldBurr::drag(const WindowInput& input, const View& view, int height) {
  if (!input.left || input.drag.isZero()) return false;
  const Eigen::Vector3d right = view.right_world.cast<double>(), up = view.up_world.cast<double>(),
                        back = view.back_world.cast<double>();
  if (input.control) {
    constexpr double kTilt = 1.0;  // rad for half a height
    pose_.orientation = Eigen::AngleAxisd(kTilt * input.drag.x(), back) *
                        Eigen::AngleAxisd(-kTilt * input.drag.y(), right) * pose_.orientation;
    pose_.orientation.normalize();
    return true;
  }
  const double half_m = 0.5 * height * view.metres_per_pixel;
  pose_.position += half_m * input.drag.x() * right;
  pose_.position += half_m * input.drag.y() * (input.shift ? Eigen::Vector3d(-back) : up);
  return true;
}

}  // namespace sulcus
