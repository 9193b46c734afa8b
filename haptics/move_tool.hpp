#pragma once

#include "engine/volume/workpiece.hpp"
#include "haptics/simulation_state.hpp"
#include "haptics/tick_context.hpp"
#include "haptics/tick_scratch.hpp"

namespace sulcus {

/// Speed of the spindle in the tick that comes.
double spindle_speed_now(const TickContext& context, const SimulationState& state) noexcept;

/// Contact of the burr at a pose with the bodies that it is near, and what it drags along on the
/// way from where the tool was. Changes no state.
ContactResult contact_with_bodies(const TickContext& context, const Workpiece& workpiece,
                                  const SimulationState& state, const Pose& tool, Asked asked,
                                  TickScratch& scratch) noexcept;

/// What a tick did with the tool.
struct MovedTool {
  ContactResult contact;  // where it is now
  Wrench asked;           // what the hand is to feel: the coupling's springs, else the contact
  int evaluations = 0;    // of the contact
};

/// Takes the tool to the device's pose; with a coupling towards where its springs and the contact
/// balance; with a load on along the load until the contact holds it.
MovedTool move_tool(const TickContext& context, const Workpiece& workpiece,
                    const DeviceReading& device, SimulationState& state,
                    TickScratch& scratch) noexcept;

}  // namespace sulcus
