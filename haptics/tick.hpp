#pragma once

#include <span>

#include "haptics/device/device.hpp"
#include "haptics/simulation_state.hpp"
#include "haptics/tick_context.hpp"
#include "haptics/tick_result.hpp"
#include "haptics/tick_scratch.hpp"

namespace sulcus {

/// One haptic cycle: reads the device's pose, moves the tool, evaluates the contact, cuts, sends
/// the force. The voxels it removed are in `scratch.edits`, first those of loose pieces, which
/// leave at its start: `loose`, VoxelGrid::linear, with [loose_pieces] only, at most
/// TickScratch::kMaxLoose. No clock, thread, lock, allocation or exception inside: the same state
/// and device give the same bits.
TickResult tick(const TickContext& context, Device& device, SimulationState& state,
                TickScratch& scratch, std::span<const std::uint32_t> loose = {}) noexcept;

/// Evaluates the contact where the tool is, so that what the next tick will read is in the caches.
/// Changes nothing but the scratch.
void warm_caches(const TickContext& context, const SimulationState& state,
                 TickScratch& scratch) noexcept;

}  // namespace sulcus
