#include "haptics/device/device_placement.hpp"

namespace sulcus {

PlacedDevice::PlacedDevice(const DevicePlacement& placement, const Eigen::Vector3d& start)
    : rotation_(rotation_xyz(placement.rotation)),
      scale_(placement.scale),
      offset_(placement.position_m),
      start_(start),
      is_placed_(!placement.position_m.isZero(0.0) || !placement.rotation.isZero(0.0) ||
                 placement.scale != 1.0),
      recentres_(placement.recentre) {}

Pose PlacedDevice::to_scene(const Pose& device, bool clutch) noexcept {
  const bool let_go = clutched_ && !clutch;
  clutched_ = clutch && has_tip_;
  if (!is_placed_ && !recentres_ && !clutched_ && !let_go) {
    tip_ = device.position;
    has_tip_ = true;
    return device;
  }
  is_placed_ = true;
  const Eigen::Vector3d turned = scale_ * (rotation_ * device.position);
  if (recentres_) {
    offset_ = start_ - turned;
    tip_ = start_;  // also where the clutch is held: it goes on from there
  } else if (clutched_ || let_go) {
    offset_ = tip_ - turned;
  }
  recentres_ = false;
  if (!clutched_ && !let_go) tip_ = turned + offset_;
  has_tip_ = true;
  return {tip_, (rotation_ * device.orientation).normalized()};
}

Wrench PlacedDevice::to_device(const Wrench& scene) const noexcept {
  if (!is_placed_) return scene;
  const Eigen::Quaterniond back = rotation_.conjugate();
  return {back * scene.force_N, back * scene.torque_Nm};
}

}  // namespace sulcus
