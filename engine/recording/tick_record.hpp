#pragma once

#include <cstdint>

#include "engine/core/fault.hpp"
#include "engine/recording/sealed_row.hpp"

namespace sulcus {

/// One row of /ticks, in the order and types of the file. Plain, without padding: each field lies
/// at a multiple of its size.
struct TickRecord {
  std::uint64_t tick = 0;
  double time_s = 0.0;
  double device_position_m[3]{};
  double device_orientation[4]{1, 0, 0, 0};  // w, x, y, z; world from tool
  double tool_position_m[3]{};
  double tool_orientation[4]{1, 0, 0, 0};
  double force_N[3]{};  // sent to the device
  double torque_Nm[3]{};
  double contact_force_N[3]{};
  double contact_torque_Nm[3]{};
  std::uint32_t contacts = 0;
  std::uint32_t tested = 0;
  std::uint32_t leaves = 0;
  std::uint32_t removed = 0;  // voxels cut of the workpiece; those of loose pieces are not counted
  float step_us = 0.0f;       // compute time of the tick; no part of the result
  float late_us = 0.0f;       // how late it woke; no part of the result
  std::uint64_t faults = 0;   // bits of Fault
  std::uint64_t edits_end = 0;  // rows of /edits up to and with this tick
  std::uint64_t check = 0;      // XXH3-64 of the bytes before it
};
static_assert(sizeof(TickRecord) == 8 + 8 + 26 * 8 + 6 * 4 + 8 + 8 + 8);

/// One row of /cutting, of the tick of the same number: what the work of cutting can be computed
/// from again, with the tool's poses in /ticks. World axes, torque about the burr's reference
/// point.
struct CuttingRecord {
  std::uint64_t tick = 0;
  double tangential_force_N[3]{};  // the part of the contact force along the surface
  double tangential_torque_Nm[3]{};
  double spindle_rad_per_s = 0.0;  // during the tick, about the axis from tip to shank
  double work_J = 0.0;             // of the tangential force, up to and with this tick
  std::uint64_t check = 0;         // XXH3-64 of the bytes before it
};
static_assert(sizeof(CuttingRecord) == 8 + 8 * 8 + 8);

/// One row of /port, of the tick of the same number: what the hand was to feel, and what its loop
/// made of it. World axes, torque about the burr's reference point.
struct PortRecord {
  std::uint64_t tick = 0;
  double asked_force_N[3]{};  // of the coupling, else of the contact; before the device's limits
  double asked_torque_Nm[3]{};
  double absorbed_J = 0.0;        // by the simulation since the contact began; below 0: given out
  double given_out_J = 0.0;       // by all contacts up to now
  double dissipated_J = 0.0;      // by the passivity controller
  std::uint64_t evaluations = 0;  // of the contact in this tick
  std::uint64_t check = 0;        // XXH3-64 of the bytes before it
};
static_assert(sizeof(PortRecord) == 8 + 9 * 8 + 8 + 8);

/// One row of /fill_ends, of the tick of the same number: what /ticks would say beside `edits_end`.
struct FillEndRow {
  std::uint64_t tick = 0;
  std::uint64_t fills_end = 0;  // rows of /fills up to and with this tick
  std::uint64_t check = 0;      // XXH3-64 of the bytes before it
};
static_assert(sizeof(FillEndRow) == 24);

/// One row of /pieces: a piece that was cut loose and has left the workpiece.
struct PieceRow {
  std::uint64_t piece = 0;             // numbered from 0, in the order of the rows
  std::uint64_t tick = 0;              // in which its last voxel left
  std::uint64_t first_loose_edit = 0;  // number of its first among the edits of cause `loose`
  std::uint64_t voxels = 0;            // which follow one another there
  std::uint64_t check = 0;             // XXH3-64 of the bytes before it
};

/// One row of /piece_poses: how far a piece has moved, world now from world where it was. Every
/// tenth tick while it moves, the last when it has come to rest.
struct PiecePoseRow {
  std::uint64_t tick = 0;
  std::uint64_t piece = 0;
  double position_m[3]{};
  double orientation[4]{1, 0, 0, 0};  // w, x, y, z
  std::uint64_t check = 0;
};

/// One row of /pedal: from this tick on it asks for this share of the burr's speed.
struct PedalRow {
  std::uint64_t tick = 0;
  double share = 1.0;       // 0 to 1
  std::uint64_t check = 0;  // XXH3-64 of the bytes before it
};
static_assert(sizeof(PedalRow) == 24);

/// One row of /taken_answers: in which tick the haptic thread took what had come loose after
/// another. A replay takes it then, and never what has no row.
struct TakenAnswerRow {
  std::uint64_t asked = 0;  // ticks
  std::uint64_t taken = 0;
  std::uint64_t check = 0;
};

}  // namespace sulcus
