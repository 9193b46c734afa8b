#pragma once

#include <span>
#include <utility>
#include <vector>

namespace sulcus::lab {

// Of samples: 0 of none.

double mean(const std::vector<float>& values);
/// The value that a part (0 to 1) of the values does not exceed.
double quantile(std::vector<float> values, double part);

// Of values measured one a tick, in their own unit: 0 of none.

double mean(std::span<const double> values);
/// Root mean square about the mean.
double rms(std::span<const double> values);
/// The same about the straight line that fits best.
double detrended_rms(std::span<const double> values);
double peak_to_peak(std::span<const double> values);

/// Exponent p of c x^p that fits points (x, y) best, by least squares of the logarithms. Points
/// whose y is not positive and finite are left out; NaN with fewer than two.
double log_slope(const std::vector<std::pair<double, double>>& points);

}  // namespace sulcus::lab
