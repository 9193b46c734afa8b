#include "tools/sulcus_lab/log_slope.hpp"

#include <cmath>
#include <limits>

namespace sulcus::lab {

double log_slope(const std::vector<std::pair<double, double>>& points) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [a, b] : points) {
    if (!std::isfinite(b) || b <= 0.0) continue;
    const double u = std::log(a), v = std::log(b);
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  return n < 2 ? std::numeric_limits<double>::quiet_NaN() : (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace sulcus::lab
