#pragma once

#include "engine/cache/load_cache.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"

namespace sulcus {

/// Reads or generates a scene's burr; with a cache its field may come from there, the same bits.
/// InputError as make_burr, read_mesh and, of a mesh's shells, check_shells.
Burr load_burr(const Scene& scene, LoadCache* cache = nullptr);

}  // namespace sulcus
