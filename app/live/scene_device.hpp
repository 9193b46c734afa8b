#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/playback/scene_trajectory.hpp"
#include "app/session/plugin_device.hpp"
#include "engine/scene/scene.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/device/device.hpp"
#include "haptics/device/simulated_device.hpp"

namespace sulcus {

/// Opens the plug-in that a scene names; the scene then says the limits of the device, so that it
/// replays without the plug-in. Null where it names none. `folders`: in which it is looked for.
/// InputError as PluginDevice and parse_scene.
std::unique_ptr<PluginDevice> open_plugin(const std::vector<std::string>& folders,
                                          bool at_real_pace, const Trajectory& trajectory,
                                          Scene& scene);

/// The device of a scene: its plug-in, the poses of a recording, a simulated hand, or the
/// trajectory itself.
class SceneDevice {
 public:
  /// `ticks`: that there may be at most. All but `plugin` outlive it.
  SceneDevice(const Scene& scene, const Trajectory& trajectory, std::uint64_t ticks,
              std::unique_ptr<PluginDevice> plugin);
  SceneDevice(const SceneDevice&) = delete;  // it knows where its device is
  SceneDevice& operator=(const SceneDevice&) = delete;

  Device& device() { return *device_; }
  /// Null where it is none.
  PluginDevice* plugin() { return plugin_.get(); }
  /// After the last tick: says how it went. Throws where the plug-in's device ended the run.
  void end();

 private:
  std::unique_ptr<PluginDevice> plugin_;
  PlayedBack played_back_;
  std::optional<ScriptedDevice> script_;
  std::optional<PlaybackDevice> playback_;
  std::optional<SimulatedDevice> simulated_;
  Device* device_ = nullptr;
};

}  // namespace sulcus
