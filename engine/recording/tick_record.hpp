#pragma once

#include <cstdint>

namespace sulcus {

/// Bits of `TickRecord::faults`.
enum Fault : std::uint32_t {
  kFaultNotFinite = 1u << 0,     // a force or pose was not finite: zero force, and the run stops
  kFaultContactsFull = 1u << 1,  // haptics.max_contacts exceeded: the deepest were kept
  kFaultCutStateFull = 1u << 2,  // cutting.max_cut_voxels exceeded: energy kept in the pool
  kFaultRowsDropped = 1u << 3,   // the recorder fell behind before this row
};

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
  std::uint32_t removed = 0;
  float step_us = 0.0f;  // compute time of the tick; no part of the result
  float late_us = 0.0f;  // how late it woke; no part of the result
  std::uint64_t faults = 0;
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

/// Sets `check`.
void seal(TickRecord& record);
void seal(CuttingRecord& record);
/// Whether `check` fits the row.
bool is_sealed(const TickRecord& record);
bool is_sealed(const CuttingRecord& record);

}  // namespace sulcus
