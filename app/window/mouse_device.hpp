#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "app/session/feed.hpp"
#include "haptics/device/device.hpp"

namespace sulcus {

/// A hand that holds the burr by a mouse: it goes smoothly to the last pose it was given. Moved by
/// one thread, read by the haptic one.
class MouseDevice final : public Device {
 public:
  MouseDevice(const Pose& start, double rate_hz)
      : now_(start), wanted_(start), part_(std::min(1.0, 1.0 / (kLag_s * rate_hz))) {}

  void go_to(const Pose& pose) { targets_.enqueue(pose); }

  std::optional<Pose> pose(std::uint64_t) noexcept override {
    while (targets_.try_dequeue(wanted_)) {
    }
    now_.position += part_ * (wanted_.position - now_.position);
    // Straight between the two, and no longer than 1 again: slerp calls the maths library.
    Eigen::Vector4d wanted = wanted_.orientation.coeffs();
    if (wanted.dot(now_.orientation.coeffs()) < 0.0) wanted = -wanted;
    now_.orientation.coeffs() += part_ * (wanted - now_.orientation.coeffs());
    now_.orientation.normalize();
    return now_;
  }
  void apply(const Wrench&) noexcept override {}

 private:
  // A mouse is read at some 30 Hz: between two readings the hand moves on.
  static constexpr double kLag_s = 0.05;

  Queue<Pose> targets_{64};
  Pose now_, wanted_;
  double part_;  // of the way that is left, a tick
};

}  // namespace sulcus
