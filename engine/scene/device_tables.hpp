#pragma once

#include "engine/scene/scene.hpp"
#include "engine/scene/scene_table.hpp"

namespace sulcus {

/// [device] of a scene whose ticks come `rate_hz` a second. InputError as TomlTable.
DeviceSettings read_device(SceneTable& table, double rate_hz);

/// [coupling] of a scene; what it does not say comes from the device, where there is one.
CouplingSettings read_coupling(SceneTable& table, const std::optional<DeviceSettings>& device);

}  // namespace sulcus
