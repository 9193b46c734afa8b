#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/pose.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/device/pedal.hpp"

namespace sulcus {

/// Of Device::burr: the one that it has.
inline constexpr std::uint32_t kSameBurr = ~std::uint32_t{0};

/// Where the tool's pose comes from and the wrench goes to. Called by the haptic thread once a
/// tick: `pose`, `pedal`, then `apply`; `burr` after `pose`, where a run may change it. None of
/// them blocks, allocates or throws.
class Device {
 public:
  virtual ~Device() = default;
  /// Pose of the burr's tip, world from tool, at the start of a tick; none when the device does not
  /// answer.
  virtual std::optional<Pose> pose(std::uint64_t tick) noexcept = 0;
  /// What share of the burr's speed is asked for in that tick, 0 to 1: a foot pedal, or a switch.
  virtual double pedal() noexcept { return 1.0; }
  /// Whether it may ever be another: a recording then keeps it. Of any thread.
  virtual bool has_pedal() const noexcept { return false; }
  /// Which of the scene's burrs the hand wants to hold (Scene::burrs), or kSameBurr.
  virtual std::uint32_t burr() noexcept { return kSameBurr; }
  /// Force and torque of that tick for the hand.
  virtual void apply(const Wrench& wrench) noexcept = 0;
  /// No more ticks come. Called by the same thread a tick's time apart, until it is false: where
  /// there is a hand, takes off a part of the force.
  virtual bool fade() noexcept { return false; }
  /// After it: nothing is to be felt any more. Called once, by the same thread.
  virtual void release() noexcept {}
  /// It will give no pose any more: the run ends once the force has faded.
  virtual bool is_gone() const noexcept { return false; }
};

/// Follows a trajectory exactly, whatever the force: the paper's experiments.
class ScriptedDevice final : public Device {
 public:
  ScriptedDevice(const Trajectory& trajectory, double rate_hz)
      : trajectory_(trajectory), dt_s_(1.0 / rate_hz) {}
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    return trajectory_.pose_at(static_cast<double>(tick) * dt_s_);
  }
  void apply(const Wrench&) noexcept override {}

 private:
  const Trajectory& trajectory_;
  double dt_s_;
};

/// Plays back the poses of a recording, from tick `first` on, and its pedal, whose changes count
/// ticks from 0: a replay is the same tick with this device. Outside of them it does not answer.
class PlaybackDevice final : public Device {
 public:
  explicit PlaybackDevice(std::span<const std::optional<Pose>> poses, std::uint64_t first = 0,
                          std::span<const PedalChange> pedal = {})
      : poses_(poses), pedal_(pedal), first_(first) {}
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    tick_ = tick;
    const std::uint64_t row = tick - first_;  // before the first: beyond the last
    return row < poses_.size() ? poses_[row] : std::nullopt;
  }
  double pedal() noexcept override { return pedal_at(pedal_, tick_); }
  bool has_pedal() const noexcept override { return !pedal_.empty(); }
  void apply(const Wrench&) noexcept override {}

 private:
  std::span<const std::optional<Pose>> poses_;
  std::span<const PedalChange> pedal_;
  std::uint64_t first_, tick_ = 0;
};

}  // namespace sulcus
