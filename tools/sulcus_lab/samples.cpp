#include "tools/sulcus_lab/samples.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sulcus::lab {

double mean(const std::vector<float>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double quantile(std::vector<float> values, double part) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + std::lround(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace sulcus::lab
