#pragma once

#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"

namespace sulcus {

/// What a tick reads and never changes. The referred objects outlive it.
struct TickContext {
  const Scene& scene;
  const Burr& burr;
};

}  // namespace sulcus
