#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace sulcus {

/// What may be wrong in a tick: bits of TickRecord::faults.
enum Fault : std::uint32_t {
  kFaultNotFinite = 1u << 0,
  kFaultContactsFull = 1u << 1,
  kFaultCutStateFull = 1u << 2,
  kFaultRowsDropped = 1u << 3,
  kFaultDeviceSilent = 1u << 4,
  kFaultDeviceJumped = 1u << 5,
  kFaultBuzz = 1u << 6,
  kFaultPoseBridged = 1u << 7,
  kFaultStepTooLong = 1u << 8,
  kFaultToolInside = 1u << 9,
};

/// One of them is set in a row whose pose is not the device's, but its last one.
inline constexpr std::uint32_t kFaultsWithoutPose = kFaultDeviceSilent | kFaultPoseBridged;

struct FaultInfo {
  Fault bit;
  std::string_view name;  // in summary.json
  std::string_view text;  // in `sulcus help recording`
};

/// Every fault, by its bit.
inline constexpr std::array<FaultInfo, 10> kFaults{{
    {kFaultNotFinite, "not_finite", "a force or pose not finite: zero force, the run ends"},
    {kFaultContactsFull, "contacts_full", "haptics.max_contacts exceeded: the deepest count"},
    {kFaultCutStateFull, "cut_state_full",
     "cutting.max_cut_voxels exceeded: work on the voxels beyond is lost as heat"},
    {kFaultRowsDropped, "rows_dropped", "rows before this one are missing"},
    {kFaultDeviceSilent, "device_silent",
     "no pose from the device, or its clutch held, for more than 20 ms: tool and spindle stand"},
    {kFaultDeviceJumped, "device_jumped",
     "its pose jumped: neither cut nor friction, the force fades in"},
    {kFaultBuzz, "buzz", "the force buzzes"},
    {kFaultPoseBridged, "pose_bridged", "no pose for a little while: the last one stands"},
    {kFaultStepTooLong, "step_too_long", "a step too long for what it met"},
    {kFaultToolInside, "tool_inside", "the middle of the burr's head inside a solid"},
}};

}  // namespace sulcus
