#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "engine/core/stop.hpp"
#include "haptics/device/device.hpp"

namespace sulcus {

/// A device in a run that has parts: the burr can be changed, and time be taken back, without the
/// hand letting go of it. A part ends as it would with a device that falls silent: no poses, so
/// that tool and spindle stand and the force falls to zero; the next one begins like that, and the
/// force comes back on the ramp of a device that answers again (read_pose, limit_output). What the
/// window says comes from its thread, the rest is the haptic thread's.
class LiveDevice final : public Device {
 public:
  /// `inner` outlives it. `feels`: there is a hand that a jump of the force would hurt; `switched`:
  /// set_pedal may be called; `burrs`: that there are to choose from, another one is not asked for.
  LiveDevice(Device& inner, double rate_hz, bool feels, bool switched, std::size_t burrs)
      : inner_(inner),
        burrs_(burrs),
        away_ticks_(feels ? static_cast<std::uint64_t>(kAway_s * rate_hz) : 0),
        feels_(feels),
        switched_(switched) {}

  // Of the window's thread.
  /// The spindle's switch and speed: times the device's own pedal.
  void set_pedal(double share) noexcept { pedal_ = share; }
  /// The hand has let go: tool and spindle stand, and nothing is felt, until it is taken up again.
  void let_go(bool let_go) noexcept { let_go_ = let_go; }
  /// Ends the part once the force has fallen to zero.
  void end_part() noexcept { ends_ = true; }

  // Of whoever runs the parts, between them.
  /// `again`: another came before it. `burr`: that is in, of those to choose from.
  void begin_part(bool again, std::uint32_t burr) noexcept {
    ends_ = false;
    has_ = burr;
    wanted_ = kSameBurr;
    left_ = again ? away_ticks_ : 0;
  }
  /// The burr that the device asked for, by which the part ended; kSameBurr: it asked for none.
  std::uint32_t wanted_burr() const noexcept { return wanted_; }
  /// Whether the part ended so that another may follow.
  bool goes_on() const noexcept { return ends_ && !inner_.is_gone() && !stop_requested(); }
  /// No part follows. The device is let go of, where that has not been done.
  void finish() noexcept {
    if (!released_) inner_.release();
    released_ = true;
  }

  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    const std::optional<Pose> pose = inner_.pose(tick);
    // It asks when it says another one than before, and not again for what was refused or taken
    // back by a key.
    const std::uint32_t says = inner_.burr();
    if (says < burrs_ && says != said_ && !ends_) {
      said_ = says;
      if (says != has_) {
        wanted_ = says;
        ends_ = true;
      }
    }
    if (left_ > 0) {
      --left_;
      return {};
    }
    if (let_go_ || (ends_ && feels_)) return {};
    return pose;
  }
  double pedal() noexcept override { return inner_.pedal() * pedal_; }
  bool has_pedal() const noexcept override { return switched_ || inner_.has_pedal(); }
  void apply(const Wrench& wrench) noexcept override {
    inner_.apply(left_ > 0 ? Wrench{} : wrench);
  }
  /// Whether or not another part follows: what ended this one may have cut the fall of the force
  /// off.
  bool fade() noexcept override { return inner_.fade(); }
  void release() noexcept override {
    if (released_) return;
    if (goes_on()) {
      inner_.apply({});  // what a fall that was cut off has left
      return;
    }
    finish();
  }
  bool is_gone() const noexcept override { return ends_ || inner_.is_gone(); }

 private:
  // Longer than a silence is bridged and the force needs to fall.
  static constexpr double kAway_s = 0.1;

  Device& inner_;
  std::size_t burrs_;
  std::uint64_t away_ticks_, left_ = 0;
  bool feels_, switched_, released_ = false;
  std::uint32_t said_ = 0;  // by the device, last: it begins with the scene's
  std::uint32_t has_ = 0;
  std::atomic<std::uint32_t> wanted_{kSameBurr};
  std::atomic<double> pedal_{1.0};
  std::atomic<bool> let_go_{false}, ends_{false};
};

}  // namespace sulcus
