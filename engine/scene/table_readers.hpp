#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/assessment_table.hpp"
#include "engine/scene/scene.hpp"
#include "engine/scene/scene_table.hpp"

namespace sulcus {

// What scene_file.cpp reads a scene's larger tables with. All throw InputError as TomlTable.

/// [workpiece], which must be there.
WorkpieceSettings read_workpiece(SceneTable& root);

/// [[body]], of the tissues of the scene.
std::vector<BodySettings> read_bodies(SceneTable& root, const std::vector<TissueSettings>& tissues);

/// [burr]; `usual`: what it is where the table does not say; `saturates`: the law of [cutting]
/// does.
BurrSettings read_burr(SceneTable& table, bool saturates, BurrSettings usual);

/// What the hand can choose from: [burr] and every [[spare_burr]], none where there are no spare
/// ones. `scene`: the whole of it, read from `file`; the others as of read_burr.
std::vector<BurrChoice> read_burrs(SceneTable& root, const toml::table& scene,
                                   const std::string& file, bool saturates,
                                   const BurrSettings& usual);

/// [goal].
GoalSettings read_goal(SceneTable& table);

/// [assessment].
AssessmentSettings read_assessment(SceneTable& table);

/// Text of assets/tissues.toml, built into the program.
std::string_view tissue_table_toml();

/// [[tissue]], or tissue = ["NAME", ...]; the first of assets/tissues.toml where a scene has
/// neither. With [coupling] tissues are stiffer by default.
std::vector<TissueSettings> read_tissues(SceneTable& root, const WorkpieceSettings& workpiece);

/// [device] of a scene whose ticks come `rate_hz` a second.
DeviceSettings read_device(SceneTable& table, double rate_hz);

/// [coupling] of a scene; what it does not say comes from the device, where there is one.
CouplingSettings read_coupling(SceneTable& table, const std::optional<DeviceSettings>& device);

/// [stream].
StreamSettings read_stream(SceneTable& table);

}  // namespace sulcus
