#pragma once

#include <string>
#include <vector>

#include "tools/sulcus_lab/normals/normals_measurement.hpp"

namespace sulcus::lab {

/// What was measured on one shape.
struct ShapeResult {
  std::string shape;
  std::vector<NormalsRow> rows;
};

/// The neighbourhood that the paper settles on, which charts mark.
inline constexpr int kMarkedNeighbourhood = 6;

/// Speed against accuracy, a panel for each shape or, where it has zones, for each of them: time of
/// a normal along, mean error up, both logarithmic, a line per method through its neighbourhoods.
/// False where gnuplot cannot be run; so do the others.
bool draw_speed_accuracy(const std::vector<ShapeResult>& results, const std::string& file_png);

/// The same for one shape as a whole, with its neighbourhoods written beside the points.
bool draw_speed_accuracy_of(const ShapeResult& result, const std::string& file_png);

}  // namespace sulcus::lab
