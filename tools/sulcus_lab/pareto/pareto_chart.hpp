#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/sulcus_lab/pareto/pareto_measurement.hpp"

namespace sulcus::lab {

/// Error of the net force against the time of a tick: every row a mark in its method's colour,
/// those with the first field joined; the front a staircase with its settings named. `fields`: how
/// each burr's field is called, one at least. `rows` are
/// not empty. False where gnuplot did not draw it.
bool draw_pareto(const std::vector<ParetoRow>& rows, std::span<const std::string> fields,
                 const std::string& file_png);

}  // namespace sulcus::lab
