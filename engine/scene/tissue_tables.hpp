#pragma once

#include <string_view>
#include <vector>

#include "engine/scene/scene.hpp"
#include "engine/scene/scene_table.hpp"

namespace sulcus {

/// Text of assets/tissues.toml, built into the program.
std::string_view tissue_table_toml();

/// [[tissue]], or tissue = ["NAME", ...]; the first of assets/tissues.toml where a scene has
/// neither. With [coupling] tissues are stiffer by default. InputError as TomlTable.
std::vector<TissueSettings> read_tissues(SceneTable& root, const WorkpieceSettings& workpiece);

}  // namespace sulcus
