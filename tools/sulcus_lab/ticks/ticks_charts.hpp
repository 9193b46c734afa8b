#pragma once

#include <span>
#include <string>

#include "tools/sulcus_lab/ticks/ticks_rows.hpp"

namespace sulcus::lab {

/// Time of a tick, and of one contact in it, against the contacts: a line for each method and
/// cache with its fitted exponent, a millisecond, a quarter of one, PCA, and the floor.
bool draw_ticks(std::span<const TickRow> rows, std::span<const TickPlace> places,
                const std::string& file_png);

/// Where the time of a tick goes: bars of the stages, for each method, cache and number.
bool draw_tick_stages(std::span<const TickRow> rows, const std::string& file_png);

/// Time of a tick, as a multiple of that of the smallest, against the cells and the bodies, with
/// what it may be.
bool draw_tick_sweeps(std::span<const SweepRow> cells, std::span<const SweepRow> bodies,
                      const std::string& file_png);

}  // namespace sulcus::lab
