#include "tools/sulcus_lab/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sulcus::lab {

namespace {

/// Time of a value in ticks, from the middle of the series.
double tick_from_middle(std::size_t i, std::size_t count) {
  return static_cast<double>(i) - 0.5 * (static_cast<double>(count) - 1.0);
}

/// Root mean square about the line through the mean with a slope a tick.
double rms_about(std::span<const double> values, double slope) {
  if (values.empty()) return 0.0;
  const double middle = mean(values);
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double off = values[i] - middle - slope * tick_from_middle(i, values.size());
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

double mean(std::span<const double> values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double rms(std::span<const double> values) { return rms_about(values, 0.0); }

double detrended_rms(std::span<const double> values) {
  const double middle = mean(values);
  double along = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double tick = tick_from_middle(i, values.size());
    along += tick * (values[i] - middle);
    spread += tick * tick;
  }
  return rms_about(values, spread > 0.0 ? along / spread : 0.0);
}

double peak_to_peak(std::span<const double> values) {
  if (values.empty()) return 0.0;
  const auto [least, most] = std::ranges::minmax(values);
  return most - least;
}

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
