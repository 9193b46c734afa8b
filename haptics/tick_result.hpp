#pragma once

#include <cstdint>

#include "engine/core/pose.hpp"
#include "haptics/contact/contact.hpp"

namespace sulcus {

/// What one tick has done. World axes, torques about the burr's reference point. What adds up over
/// ticks is in the state.
struct TickResult {
  std::uint64_t tick = 0;          // its number, from 0
  Pose device;                     // world from tool, as it was read; the last one where none came
  Pose tool;                       // where the tool is now
  ContactResult contact;           // with all bodies, there
  Wrench commanded;                // before any limit: the coupling's, else the contact's
  Wrench sent;                     // to the device
  double spindle_rad_per_s = 0.0;  // during the tick, about the axis from tip to shank
  std::uint64_t evaluations = 0;   // of the contact
  std::uint32_t removed = 0;       // voxels cut of the workpiece, without those of loose pieces
  std::uint32_t faults = 0;        // bits of Fault, of all that was done
};

}  // namespace sulcus
