#pragma once

#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"

namespace sulcus {

/// Reads or generates a scene's burr. InputError as make_burr and read_mesh.
Burr load_burr(const Scene& scene);

}  // namespace sulcus
