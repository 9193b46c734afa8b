#pragma once

#include <span>

#include "engine/recording/tick_record.hpp"
#include "haptics/device/device.hpp"
#include "haptics/simulation_state.hpp"
#include "haptics/tick_context.hpp"
#include "haptics/tick_scratch.hpp"

namespace sulcus {

/// One haptic cycle: moves the tool, evaluates the contact, cuts, sends the force. Returns its
/// record, but for what only the thread around it knows (times, edits_end, check). The voxels it
/// removed are in `scratch.edits`, first those of loose pieces, which leave at its start: `loose`,
/// VoxelGrid::linear, with [loose_pieces] only, at most TickScratch::kMaxLoose. No clock, thread,
/// lock, allocation or exception inside: the same state and device give the same bits.
TickRecord tick(const TickContext& context, Device& device, SimulationState& state,
                TickScratch& scratch, std::span<const std::uint32_t> loose = {}) noexcept;

/// Evaluates the contact where the tool is, for nothing but to have touched what the next tick
/// will. Changes nothing but the scratch.
void rehearse(const TickContext& context, const SimulationState& state,
              TickScratch& scratch) noexcept;

}  // namespace sulcus
