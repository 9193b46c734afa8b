#pragma once

#include <vector>

#include "engine/scene/scene.hpp"
#include "engine/scene/scene_table.hpp"

namespace sulcus {

// The tables that name solids. All throw InputError as TomlTable.

/// [workpiece], which must be there.
WorkpieceSettings read_workpiece(SceneTable& root);

/// [[body]], of the tissues of the scene.
std::vector<BodySettings> read_bodies(SceneTable& root, const std::vector<TissueSettings>& tissues);

/// [goal].
GoalSettings read_goal(SceneTable& table);

}  // namespace sulcus
