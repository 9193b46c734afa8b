#include "app/live/scene_device.hpp"

#include <exception>
#include <utility>

#include <spdlog/spdlog.h>

#include "engine/scene/scene_file.hpp"

namespace sulcus {

std::unique_ptr<PluginDevice> open_plugin(const std::vector<std::string>& folders,
                                          bool at_real_pace, const Trajectory& trajectory,
                                          Scene& scene) {
  if (!scene.device || !scene.device->plugin) return nullptr;
  auto device = std::make_unique<PluginDevice>(scene, trajectory, folders, at_real_pace);
  scene = parse_scene(scene.text, scene.file, device->limits_as_overrides(), scene.limits);
  return device;
}

SceneDevice::SceneDevice(const Scene& scene, const Trajectory& trajectory, std::uint64_t ticks,
                         std::unique_ptr<PluginDevice> plugin)
    : plugin_(std::move(plugin)) {
  if (plugin_) {
    device_ = plugin_.get();
    spdlog::info("{}: {}", plugin_->title(), plugin_->own_name());
    return;
  }
  played_back_ = played_back(scene, trajectory, ticks);
  if (!played_back_.poses.empty()) {
    device_ = &playback_.emplace(played_back_.poses, 0, played_back_.pedal);
  } else if (scene.device && !scene.device->played_back) {
    device_ = &simulated_.emplace(*scene.device, trajectory, scene.haptics.rate_hz,
                                  scene.burr.reference_m);
  } else {
    device_ = &script_.emplace(trajectory, scene.haptics.rate_hz);
  }
}

void SceneDevice::end() {
  if (!plugin_) return;
  try {
    for (const std::string& line : plugin_->end()) spdlog::warn("{}", line);
  } catch (const std::exception& why) {  // the terminal gets it from where it is caught
    spdlog::info("{}", why.what());
    throw;
  }
  spdlog::info("{}: its longest call took {:.3f} ms", plugin_->title(), plugin_->longest_call_ms());
}

}  // namespace sulcus
