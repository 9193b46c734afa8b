#pragma once

#include <span>

namespace sulcus::lab {

// Of values measured one a tick, in their own unit; 0 of none.

double mean(std::span<const double> values);
/// Root mean square about the mean.
double rms(std::span<const double> values);
/// The same about the straight line that fits best.
double detrended_rms(std::span<const double> values);
double peak_to_peak(std::span<const double> values);

}  // namespace sulcus::lab
