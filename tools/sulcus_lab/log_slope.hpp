#pragma once

#include <utility>
#include <vector>

namespace sulcus::lab {

/// Exponent p of c x^p that fits points (x, y) best, by least squares of the logarithms. Points
/// whose y is not positive and finite are left out; NaN with fewer than two.
double log_slope(const std::vector<std::pair<double, double>>& points);

}  // namespace sulcus::lab
