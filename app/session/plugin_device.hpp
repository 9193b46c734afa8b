#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "engine/scene/scene.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/device/device.hpp"
#include "haptics/device/device_placement.hpp"
#include "haptics/device/force_fade.hpp"
#include "haptics/device/sulcus_device.h"

namespace sulcus {

/// A device that a plug-in drives. What it reads is checked before the tick has it: one that cannot
/// be a pose comes through as one that is not finite, which ends the run; an answer that took too
/// long counts as none; and as long as the burr's head is inside a tooth, where it would feel
/// nothing, the device is not there yet. A replay needs no plug-in: the poses that it has are those
/// which came through.
///
/// What is written never steps by more than limit_output lets it, whatever ends a run: the ticks'
/// own forces keep to that; where they are cut off, or no more of them come, a ForceFade takes the
/// rest. Its steps are in no record.
///
/// It lies in the scene where [device] places it, and may have a pedal, a clutch and a choice of
/// burr (SulcusControls).
///
/// Made, begun and ended by the main thread; pose, pedal, burr, apply, fade, release and is_gone
/// are the haptic thread's; the rest is told at each.
class PluginDevice final : public Device {
 public:
  static constexpr std::uint64_t kSlowest_ns = 20'000'000;  // of a read that counts, at real pace
  static constexpr int kHanging_s = 2;                      // in a call: the program ends
  static constexpr double kFarthest_m = 10.0;               // from the origin

  /// Loads and opens the plug-in that the scene names. `trajectory` outlives this. InputError as
  /// load_plugin; also where it lives in real time and the run does not, where it cannot be opened,
  /// with its own word on it, or gives limits that cannot be.
  PluginDevice(const Scene& scene, const Trajectory& trajectory,
               const std::vector<std::string>& folders, bool at_real_pace);
  ~PluginDevice() override;
  PluginDevice(const PluginDevice&) = delete;  // the plug-in knows where it is
  PluginDevice& operator=(const PluginDevice&) = delete;

  /// For messages, by the scene's name for it.
  const std::string& title() const { return title_; }
  /// It lives in real time: nothing but the device says when it is over.
  bool is_live() const { return (plugin_.flags & SULCUS_DEVICE_REAL_TIME) != 0; }
  /// What it calls itself.
  std::string own_name() const;
  /// What turns the scene into one that says the limits of the device: the plug-in's, or less where
  /// the scene asks for less. As of --set.
  std::vector<std::string> limits_as_overrides() const;

  /// Before the first tick. `is_free`: of the burr's head at a pose, asked for in ticks until it is
  /// for the first time. From here on a call that does not return ends the program, status 1.
  void begin(std::function<bool(const Pose&)> is_free);

  std::optional<Pose> pose(std::uint64_t tick) noexcept override;
  double pedal() noexcept override { return pedal_; }
  bool has_pedal() const noexcept override { return has_controls_; }
  std::uint32_t burr() noexcept override { return burr_; }
  void apply(const Wrench& wrench) noexcept override;
  bool fade() noexcept override;
  void release() noexcept override;
  bool is_gone() const noexcept override { return end_ != End::kNone; }

  // Of any thread, as a key or a button of the window asks.
  void hold_clutch(bool held) noexcept { clutch_ = held; }
  void recentre() noexcept { recentre_ = true; }
  /// After a part of the run that another follows: what is written goes up from zero again, and its
  /// poses count once the burr's head is outside of all teeth. `is_free` as of begin.
  void go_on(std::function<bool(const Pose&)> is_free);

  /// The longest read or write of all, ms.
  double longest_call_ms() const { return 1e-6 * static_cast<double>(longest_ns_); }
  /// After the last tick: closes it. Returns what there is to say, a line each. Throws
  /// std::runtime_error where the device ended the run, with why.
  std::vector<std::string> end();

 private:
  enum class Write : std::uint8_t { kTick, kLast };
  enum class End : std::uint8_t { kNone, kOver, kGone, kNoPose };
  struct Host : SulcusDeviceHost {
    const Trajectory* path;
  };

  static void at_trajectory(const SulcusDeviceHost* host, double time_s, SulcusPose* pose) noexcept;
  template <class Call>
  void watched(const char* name, const Call& call) noexcept;
  template <class Call>
  int timed(const char* name, const Call& call) noexcept;
  void fail(End end, int code) noexcept;
  bool read_controls(std::uint64_t tick) noexcept;
  void write(const Wrench& wrench, Write which) noexcept;
  void watch(const std::stop_token& stop) const;
  void close() noexcept;

  PluginSettings asked_;  // what the scene says
  bool at_real_pace_;
  const SulcusDevicePlugin& plugin_;
  std::unique_ptr<Host> host_;
  SulcusDeviceLimits limits_{};
  void* device_ = nullptr;
  bool open_ = false;
  std::string title_;

  std::atomic<bool> clutch_{false}, recentre_{false};

  // The haptic thread's, until it has ended.
  std::function<bool(const Pose&)> is_free_;
  PlacedDevice placed_;
  bool has_controls_;
  double pedal_ = 1.0;
  std::uint32_t burr_ = kSameBurr;
  std::size_t spare_burrs_;         // of the scene
  std::uint32_t no_such_burr_ = 0;  // first that was asked for; 0: none
  OutputLimits steps_;              // of what is written
  Wrench written_;                  // last
  std::optional<ForceFade> fade_;   // once there is to be no more force
  bool is_held_ = false;
  std::uint64_t tick_ = 0, took_ns_ = 0, longest_ns_ = 0;
  std::uint64_t slow_ticks_ = 0, inside_ticks_ = 0, silent_ticks_ = 0;
  End end_ = End::kNone;
  std::uint64_t end_tick_ = 0;
  int end_code_ = 0;
  SulcusPose end_pose_{};

  // What the watcher sees: the number of calls so far, and which lasts.
  std::atomic<std::uint64_t> calls_{0};
  std::atomic<const char*> call_{nullptr};
  std::jthread watcher_;  // last: it ends before what it looks at
};

}  // namespace sulcus
