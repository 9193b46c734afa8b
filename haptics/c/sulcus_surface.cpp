#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/surface/drawn_surface.hpp"
#include "haptics/c/simulation_handle.hpp"

// A vertex is handed out where it is.
static_assert(sizeof(SulcusVertex) == sizeof(sulcus::DrawnVertex));
static_assert(offsetof(SulcusVertex, normal) == offsetof(sulcus::DrawnVertex, normal));
static_assert(offsetof(SulcusVertex, colour_cut) == offsetof(sulcus::DrawnVertex, colour_cut));

struct SulcusSurface {
  std::atomic_flag taken = ATOMIC_FLAG_INIT;
  sulcus::DrawnSurface surface;
  sulcus::DrawnSurface::Scratch scratch = {};
  sulcus::DrawnMesh mesh = {};
  std::vector<int> changed = {};  // that are still to be meshed, the last first
  bool is_behind = true;          // edits came since the list was made

  explicit SulcusSurface(sulcus::DrawnSurface made) : surface(std::move(made)) {}
};

using namespace sulcus;  // NOLINT: what follows is C

namespace {

template <class Call>
int with_surface(SulcusSurface* surface, const Call& call) noexcept {
  if (!surface) return SULCUS_NULL;
  const Turn turn(surface->taken);
  if (!turn.is_ours()) return SULCUS_BUSY;
  return guarded([&] { return call(*surface); });
}

/// What is to be meshed besides what already was.
void add_changed(SulcusSurface& of) {
  const std::vector<int> more = of.surface.take_changed();
  of.changed.insert(of.changed.end(), more.begin(), more.end());
  std::ranges::sort(of.changed, std::greater<>());
  of.changed.erase(std::unique(of.changed.begin(), of.changed.end()), of.changed.end());
  of.is_behind = false;
}

}  // namespace

int sulcus_surface_open(const SulcusSimulation* simulation, SulcusSurface** surface) {
  if (!surface) return SULCUS_NULL;
  return with_run(simulation, [&](SceneRun& run) -> int {
    std::vector<TissueLook> looks;
    for (const TissueSettings& t : run.scene().tissues) looks.push_back({t.name, t.colour});
    auto made =
        std::make_unique<SulcusSurface>(DrawnSurface(run.workpiece().model(), std::move(looks)));
    *surface = made.release();
    return SULCUS_DONE;
  });
}

int sulcus_surface_apply(SulcusSurface* surface, const SulcusEdit* edits, size_t count) {
  if (!edits && count > 0) return SULCUS_NULL;
  return with_surface(surface, [&](SulcusSurface& to) -> int {
    const std::uint64_t cells = to.surface.model().grid.cell_count();
    std::vector<std::uint32_t> gone;
    std::vector<VoxelLevel> levels;
    for (const SulcusEdit& edit : std::span(edits, count)) {
      if (edit.body != 0) continue;
      if (edit.voxel >= cells) return SULCUS_BAD_VALUE;
      levels.push_back({edit.voxel, edit.level});
      if (edit.level == 0) gone.push_back(edit.voxel);
    }
    to.is_behind = true;
    if (to.surface.model().fills) {
      to.surface.set_levels(levels);
    } else {
      to.surface.remove(gone);
    }
    return SULCUS_DONE;
  });
}

int sulcus_surface_next(SulcusSurface* surface, SulcusBrick* brick) {
  if (!brick) return SULCUS_NULL;
  return with_surface(surface, [&](SulcusSurface& of) -> int {
    if (of.is_behind) add_changed(of);
    *brick = {-1, 0, 0, nullptr, nullptr};
    if (of.changed.empty()) return SULCUS_DONE;
    const int number = of.changed.back();
    of.changed.pop_back();
    of.surface.mesh(number, of.scratch, of.mesh);
    brick->number = number;
    brick->vertex_count = static_cast<uint32_t>(of.mesh.vertices.size());
    brick->index_count = static_cast<uint32_t>(of.mesh.indices.size());
    brick->vertices = reinterpret_cast<const SulcusVertex*>(of.mesh.vertices.data());
    brick->indices = of.mesh.indices.data();
    return SULCUS_DONE;
  });
}

int sulcus_surface_free(SulcusSurface** surface) {
  if (!surface) return SULCUS_NULL;
  if (!*surface) return SULCUS_DONE;
  if (!Turn((*surface)->taken).is_ours()) return SULCUS_BUSY;
  delete std::exchange(*surface, nullptr);
  return SULCUS_DONE;
}
