#pragma once

#include <string>
#include <vector>

#include "engine/recording/run_measures.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What came before the first tick of a run that goes on from another: with it the whole is marked,
/// from the first tooth on, by the recording of the last part alone. Where that other one went on
/// from a third, this begins with the third.
struct EarlierRun {
  std::string recording;     // which was gone on from, as it was named
  std::string scene_sha256;  // of its scene
  VoxelModel start;          // the workpiece before the first tick of all
  std::vector<Edit> edits;   // since then, of all bodies, in their order
  RunMeasures measures;      // of the ticks since then
};

}  // namespace sulcus
