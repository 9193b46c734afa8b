#pragma once

#include <vector>

namespace sulcus::lab {

double mean(const std::vector<float>& values);
/// The value that a part (0 to 1) of the values does not exceed; 0 of none.
double quantile(std::vector<float> values, double part);

}  // namespace sulcus::lab
