#pragma once

#include <span>
#include <string>

#include "tools/sulcus_lab/normals/normals_measurement.hpp"

namespace sulcus::lab {

/// The errors on a shape as figs. 9 and 10 of [Kim and Park 2019] show them: seen obliquely from
/// above, for each pixel of a tile of 160 x 160, row by row from below, the angle between estimate
/// and truth in degrees, a column METHOD_NS for each run up to NS 6; nan beside the shape. False,
/// and no file, where no run is so small.
bool write_error_tiles(const TruthShape& shape, std::span<const MethodRun> runs,
                       const std::string& file_csv);

}  // namespace sulcus::lab
