#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/pose.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/contact/contact.hpp"

namespace sulcus {

/// Where the tool's pose comes from and the wrench goes to. Called by the haptic thread once a
/// tick: `pose`, then `apply`. Neither blocks nor allocates nor throws.
class Device {
 public:
  virtual ~Device() = default;
  /// Pose of the burr's tip, world from tool, at the start of a tick; none when the device does not
  /// answer.
  virtual std::optional<Pose> pose(std::uint64_t tick) noexcept = 0;
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

/// Plays back the poses of a recording, from tick `first` on: a replay is the same tick with this
/// device. Outside of them it does not answer.
class PlaybackDevice final : public Device {
 public:
  explicit PlaybackDevice(std::span<const std::optional<Pose>> poses, std::uint64_t first = 0)
      : poses_(poses), first_(first) {}
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    const std::uint64_t row = tick - first_;  // before the first: beyond the last
    return row < poses_.size() ? poses_[row] : std::nullopt;
  }
  void apply(const Wrench&) noexcept override {}

 private:
  std::span<const std::optional<Pose>> poses_;
  std::uint64_t first_;
};

}  // namespace sulcus
