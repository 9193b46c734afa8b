#include "engine/surface/colour_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>

namespace sulcus {
namespace {

using Steps = std::array<Eigen::Vector3f, 5>;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace

double ColourScale::part(double value) const {
  const double along = kind == Kind::kDecades
                           ? std::log(std::max(value, low) / low) / std::log(high / low)
                           : (value - low) / (high - low);
  return std::clamp(along, 0.0, 1.0);
}

Eigen::Vector3f ColourScale::colour_at(double part) const {
  static const Steps kDarker{
      Eigen::Vector3f(0.96f, 0.90f, 0.30f), Eigen::Vector3f(0.90f, 0.47f, 0.10f),
      Eigen::Vector3f(0.62f, 0.10f, 0.15f), Eigen::Vector3f(0.25f, 0.02f, 0.25f),
      Eigen::Vector3f(0.03f, 0.01f, 0.12f)};
  static const Steps kBlueToOrange{
      Eigen::Vector3f(0.01f, 0.10f, 0.45f), Eigen::Vector3f(0.20f, 0.47f, 0.80f),
      Eigen::Vector3f(0.92f, 0.92f, 0.90f), Eigen::Vector3f(0.95f, 0.45f, 0.08f),
      Eigen::Vector3f(0.50f, 0.10f, 0.00f)};
  const Steps& steps = kind == Kind::kAroundZero ? kBlueToOrange : kDarker;
  const float at = static_cast<float>(part) * static_cast<float>(steps.size() - 1);
  const auto first = std::min(static_cast<std::size_t>(at), steps.size() - 2);
  return steps[first] + (at - static_cast<float>(first)) * (steps[first + 1] - steps[first]);
}

std::vector<ColourScale::Mark> ColourScale::marks() const {
  std::vector<double> values{low, 0.5 * (low + high), high};
  if (kind == Kind::kDecades) {
    values = {low};
    for (double v = 10.0 * low; v < 0.99 * high; v *= 10.0) values.push_back(v);
    values.push_back(high);
  }
  std::vector<Mark> marks;
  marks.reserve(values.size());
  for (const double value : values) marks.push_back({part(value), number(value / unit)});
  if (!beyond_low.empty()) marks.front().words += ' ' + beyond_low;
  if (!beyond_high.empty()) marks.back().words += ' ' + beyond_high;
  if (!end_low.empty()) marks.front().words = end_low;
  if (!end_high.empty()) marks.back().words = end_high;
  return marks;
}

double round_number_above(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= value * (1.0 - 1e-9)) return step * power;
  }
  return 10.0 * power;
}

}  // namespace sulcus
