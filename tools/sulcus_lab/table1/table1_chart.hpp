#pragma once

#include <string>

#include "tools/sulcus_lab/table1/table1_experiment.hpp"

namespace sulcus::lab {

/// Figs. 5 and 6 of [Kim and Park 2019] redrawn: magnitudes of force and torque over the ticks, the
/// reference in red over ours in blue, the analytic normals dashed where they are known, in narrow
/// panels below each the difference, and the voxels in contact. False, and no file, where gnuplot
/// cannot be run.
bool draw_table1_chart(const Table1Run& run, const std::string& title, const std::string& file_png);

}  // namespace sulcus::lab
