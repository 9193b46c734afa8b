#pragma once

#include "engine/recording/tick_record.hpp"
#include "haptics/simulation_state.hpp"
#include "haptics/tick_result.hpp"

namespace sulcus {

// A tick as the rows of a recording. What only the thread around it knows (times, edits_end) and
// the check are still to be set.

TickRecord tick_row(const TickResult& result, double rate_hz);
/// `after`: the state right after the tick.
CuttingRecord cutting_row(const TickResult& result, const SimulationState& after);
PortRecord port_row(const TickResult& result, const SimulationState& after);

}  // namespace sulcus
