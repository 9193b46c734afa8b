#pragma once

#include "haptics/simulation_state.hpp"
#include "haptics/tick_context.hpp"
#include "haptics/tick_result.hpp"
#include "haptics/tick_scratch.hpp"

namespace sulcus {

/// Speed of the spindle in the tick that comes.
double spindle_speed_now(const TickContext& context, const SimulationState& state) noexcept;

/// World.
Eigen::Vector3d middle_of_head(const Burr& burr, const Pose& tool) noexcept;

/// How the tool has come to a pose: along the surfaces, with friction and cutting, or not, as after
/// a jump or while the device is silent.
enum class Motion { kSlides, kNone };

/// Contact of the burr at a pose with the bodies that it is near. Where it slides there from where
/// the tool was, no further than kLongestStep_m, with the tangential forces of cutting. Changes no
/// state.
ContactResult contact_with_bodies(const TickContext& context, const SimulationState& state,
                                  const Pose& tool, Motion motion, Outputs outputs,
                                  TickScratch& scratch) noexcept;

/// Takes the tool to the device's pose; with a coupling towards where its springs and the contact
/// balance; with a load on along the load until the contact holds it. While the device is silent it
/// stays where it is. Sets the result's contact, commanded wrench and evaluations, and adds faults
/// of a step that was too long for what it met: kFaultStepTooLong where the tool was to go further
/// along a surface than a coupling can in a tick, or without one went more than a voxel deeper, or
/// its surface more than a voxel further into what it cuts, or its middle through solid;
/// kFaultToolInside where that is in solid afterwards.
void move_tool(const TickContext& context, const DeviceReading& device, SimulationState& state,
               TickScratch& scratch, TickResult& result) noexcept;

}  // namespace sulcus
