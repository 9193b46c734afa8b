#pragma once

#include <atomic>
#include <memory>

#include "haptics/c/handle.hpp"
#include "haptics/c/scene_run.hpp"

/// What the handle of C is.
struct SulcusSimulation {
  mutable std::atomic_flag taken = ATOMIC_FLAG_INIT;
  std::unique_ptr<sulcus::SceneRun> run;  // null: closed
};

namespace sulcus {

/// Calls `call(run) -> code` where there is a handle, it is nobody else's now, and it is open.
template <class Call>
int with_run(const SulcusSimulation* simulation, const Call& call, char* error = nullptr,
             std::size_t error_size = 0) noexcept {
  if (!simulation) return SULCUS_NULL;
  const Turn turn(simulation->taken);
  if (!turn.is_ours()) return SULCUS_BUSY;
  if (!simulation->run) return SULCUS_CLOSED;
  return guarded([&] { return call(*simulation->run); }, error, error_size);
}

}  // namespace sulcus
