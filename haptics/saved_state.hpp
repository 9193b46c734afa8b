#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "haptics/simulation_state.hpp"

namespace sulcus {

/// Appends all of a state but the bodies' voxels, which follow from their edits, to `bytes`.
/// So do cached normals, which are found again. Time goes with the number of part-cut voxels. Takes
/// memory only where `bytes` has too little.
void save_state(const SimulationState& state, std::vector<std::byte>& bytes);

/// The reverse, into a state that its scene made (initial_state), the bodies'
/// voxels being as they were then: a tick after it gives the same bits. What the scene no longer
/// names is skipped, and what it has that was not saved stays as it is. False where the bytes
/// are not of a state of these bodies: then `state` is to be thrown away.
bool load_state(std::span<const std::byte> bytes, SimulationState& state);

}  // namespace sulcus
