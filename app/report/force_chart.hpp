#pragma once

#include <string>

#include "app/session/run_statistics.hpp"

namespace sulcus {

/// Draws force, torque and contacts over the ticks, as figs. 5 and 6 of [Kim and Park 2019], with
/// gnuplot. False, and no file, where gnuplot cannot be run.
bool draw_force_chart(const RunStatistics& statistics, const std::string& title,
                      const std::string& file_png);

}  // namespace sulcus
