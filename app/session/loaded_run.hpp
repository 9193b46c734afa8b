#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/session/session.hpp"
#include "app/session/simulation.hpp"
#include "engine/cache/load_cache.hpp"
#include "engine/scene/scene.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/volume/input_geometry.hpp"

namespace sulcus {

/// A scene with all that it names read and made: what a run begins with.
struct LoadedRun {
  std::unique_ptr<Simulation> simulation;
  std::optional<VoxelModel> goal;  // what its file holds, where the scene names one
  ImportNotes notes;               // of the workpiece's file
  // Of the files of bodies and of the goal, each with its table ahead.
  std::vector<std::string> warnings_beside;
  std::vector<PartUse> loading;  // what that took
  // What reaches beyond its grid and is cut flat there: its name and grid.
  std::vector<std::pair<std::string, const WorkpieceSettings*>> clipped;
};

/// `start`: the tool's, which has to be outside of everything. InputError where anything that the
/// scene names cannot be used. `scene` and `cache` outlive the call; the settings named in
/// `clipped` are the scene's.
LoadedRun load_run(const Scene& scene, const Pose& start, LoadCache& cache);

/// What a user should know of how a run was loaded goes to the log.
void log_loading(const Scene& scene, const LoadedRun& run, const LoadCache& cache);

}  // namespace sulcus
