#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/recording/tick_record.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What a run's marks need of its ticks: added up tick by tick, in their order, so that a run that
/// goes on from these comes to the same bits as one that was never parted.
struct RunMeasures {
  std::uint64_t ticks = 0;
  std::uint64_t ticks_in_contact = 0;
  double peak_force_N = 0.0;            // magnitude, while in contact
  double force_in_contact_sum_N = 0.0;  // of the magnitudes, tick by tick
  // Ticks in which a device was not sent what was asked for, and those with a fault each.
  std::uint64_t limited_ticks = 0, buzz_ticks = 0, silent_ticks = 0, jumped_ticks = 0,
                long_step_ticks = 0, inside_ticks = 0;

  /// `port`: the row of the same tick, null where the scene has neither device nor coupling.
  void add(const TickRecord& row, const PortRecord* port);
  double mean_force_in_contact_N() const {
    return ticks_in_contact > 0 ? force_in_contact_sum_N / static_cast<double>(ticks_in_contact)
                                : 0.0;
  }
};

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
