#pragma once

#include <span>
#include <string>

#include "tools/sulcus_lab/normals/normals_measurement.hpp"

namespace sulcus::lab {

/// Pictures of the error on a shape as in figs. 9 and 10 of [Kim and Park 2019]: seen obliquely
/// from above, the voxels coloured by the angle between estimate and truth, a row per method, a
/// column per neighbourhood up to 6. False where gnuplot cannot be run.
bool draw_error_tiles(const TruthShape& shape, std::span<const MethodRun> runs,
                      const std::string& file_png);

}  // namespace sulcus::lab
