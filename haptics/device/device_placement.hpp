#pragma once

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "haptics/contact/contact.hpp"

namespace sulcus {

/// How a device's workspace lies in the scene, and how it is moved there by hand. A device that is
/// placed nowhere is as if this was not there, to the bit. Of one thread.
class PlacedDevice {
 public:
  /// `start`: m, scene: where recentring brings the tip.
  PlacedDevice(const DevicePlacement& placement, const Eigen::Vector3d& start);

  /// The tool's pose in the scene for one of the device, m. While `clutch` is held the tip stays
  /// where it is, and goes on from there after it; the direction is the hand's all the time.
  Pose to_scene(const Pose& device, bool clutch) noexcept;
  /// The next pose comes to the start.
  void recentre() noexcept { recentres_ = true; }
  /// Turned into the device's axes. Torques stay about the burr's reference point.
  Wrench to_device(const Wrench& scene) const noexcept;

 private:
  Eigen::Quaterniond rotation_;
  double scale_;
  Eigen::Vector3d offset_, start_;
  Eigen::Vector3d tip_ = Eigen::Vector3d::Zero();  // in the scene, last
  bool is_placed_, recentres_, has_tip_ = false, clutched_ = false;
};

}  // namespace sulcus
