#pragma once

#include <string>

#include "app/session/run_statistics.hpp"

namespace sulcus {

/// Draws force and torque by their components and magnitude, contacts and the time of a tick over
/// the time, as figs. 5 and 6 of [Kim and Park 2019], and the speed of a spindle that `sags`, with
/// gnuplot. Ticks that a busy machine has stretched beyond twice the 99th percentile are cut off,
/// and the longest is said. False, and no file, where gnuplot cannot be run. @throws as
/// draw_with_gnuplot.
bool draw_force_chart(const RunStatistics& statistics, const std::string& title, bool sags,
                      const std::string& file_png);

}  // namespace sulcus
