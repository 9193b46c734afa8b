#include "app/report/page/curves.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>

#include "app/terminal/terminal.hpp"
#include "engine/core/user_text.hpp"
#include "engine/surface/colour_scale.hpp"

namespace sulcus {

namespace {

// Units of the drawing.
constexpr double kWide = 900.0, kTall = 170.0;
constexpr double kLeft = 56.0, kRight = 890.0, kTop = 10.0, kBottom = 146.0;
constexpr int kMostTimes = 10, kMostValues = 5;

/// Thousands apart.
std::string grouped(const std::string& digits) {
  const std::size_t begin = digits.starts_with('-') ? 1 : 0;
  const std::size_t end = std::min(digits.find('.'), digits.size());
  std::string apart;
  for (std::size_t at = 0; at < digits.size(); ++at) {
    if (at > begin && at < end && (end - at) % 3 == 0) apart += ',';
    apart += digits[at];
  }
  return apart;
}

/// A number on an axis whose ticks are `step` apart.
std::string tick_text(double value, double step) {
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return grouped(formatted("%.*f", decimals, std::abs(value) < 0.5 * step ? 0.0 : value));
}

struct Frame {
  CurveAxes axes;
  double x(double time_s) const { return kLeft + time_s / axes.end_s * (kRight - kLeft); }
  double y(double value) const {
    return kBottom - (value - axes.low) / (axes.high - axes.low) * (kBottom - kTop);
  }
};

void draw_grid(const Frame& frame, std::ostream& svg) {
  const double value_step = round_step(frame.axes.high - frame.axes.low, kMostValues);
  const auto first = std::lround(std::ceil(frame.axes.low / value_step - 1e-6));
  const auto last = std::lround(std::floor(frame.axes.high / value_step + 1e-6));
  for (long n = first; n <= last; ++n) {
    const double value = static_cast<double>(n) * value_step;
    svg << "<path class=\"grid\" d=\"M" << kLeft << ' ' << frame.y(value) << 'H' << kRight
        << "\"/><text x=\"" << kLeft - 6 << "\" y=\"" << frame.y(value) + 4
        << "\" text-anchor=\"end\">" << tick_text(value, value_step) << "</text>";
  }
  const double time_step = round_step(frame.axes.end_s, kMostTimes);
  for (long n = 0; static_cast<double>(n) * time_step <= frame.axes.end_s * (1.0 + 1e-9); ++n) {
    const double time_s = static_cast<double>(n) * time_step;
    svg << "<path class=\"grid\" d=\"M" << frame.x(time_s) << ' ' << kTop << 'V' << kBottom + 4
        << "\"/><text x=\"" << frame.x(time_s) << "\" y=\"" << kBottom + 18
        << "\" text-anchor=\"middle\">" << tick_text(time_s, time_step) << (n == 0 ? " s" : "")
        << "</text>";
  }
}

void draw_line(const Curve& curve, std::span<const double> times_s, const Frame& frame,
               std::ostream& svg) {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  std::vector<double> largest(static_cast<std::size_t>(kRight - kLeft) + 1, kNone);
  for (std::size_t row = 0; row < std::min(times_s.size(), curve.values.size()); ++row) {
    if (!std::isfinite(curve.values[row])) continue;
    const double along = std::clamp(frame.x(times_s[row]) - kLeft, 0.0, kRight - kLeft);
    double& there = largest[static_cast<std::size_t>(std::lround(along))];
    there = std::max(there, curve.values[row]);
  }
  svg << "<polyline fill=\"none\" stroke=\"" << curve.colour << "\" points=\"";
  for (std::size_t column = 0; column < largest.size(); ++column) {
    if (largest[column] == kNone) continue;
    svg << kLeft + static_cast<double>(column) << ',' << frame.y(largest[column]) << ' ';
  }
  svg << "\"/>";
}

}  // namespace

double round_step(double length, int most) {
  return round_number_above(std::max(length, 1e-12) / most);
}

CurveAxes axes_of(const Curve& curve, std::span<const double> times_s) {
  CurveAxes axes{
      .end_s = times_s.empty() ? 1.0 : std::max(times_s.back(), 1e-3), .low = 0.0, .high = 0.0};
  for (const double value : curve.values) {
    if (!std::isfinite(value)) continue;
    axes.low = std::min(axes.low, value);
    axes.high = std::max(axes.high, value);
  }
  if (axes.high <= axes.low) axes.high = axes.low + 1.0;
  const double step = round_step(axes.high - axes.low, kMostValues);
  axes.low = step * std::floor(axes.low / step + 1e-9);
  axes.high = step * std::ceil(axes.high / step - 1e-9);
  return axes;
}

CurveAxes joined(const CurveAxes& a, const CurveAxes& b) {
  return {.end_s = std::max(a.end_s, b.end_s),
          .low = std::min(a.low, b.low),
          .high = std::max(a.high, b.high)};
}

std::string curve_figure(const Curve& curve, std::span<const double> times_s,
                         const CurveAxes& axes) {
  const Frame frame{axes};
  std::ostringstream svg;
  svg.precision(6);
  svg << "<figure class=\"curve\"><figcaption>" << for_html(curve.name) << ", "
      << for_html(curve.unit) << "</figcaption><svg viewBox=\"0 0 " << kWide << ' ' << kTall
      << "\" role=\"img\" data-left=\"" << kLeft << "\" data-right=\"" << kRight << "\" data-end=\""
      << axes.end_s << "\"><title>" << for_html(curve.name) << "</title>";
  draw_grid(frame, svg);
  draw_line(curve, times_s, frame, svg);
  svg << "<path class=\"now\" d=\"M0 " << kTop << 'V' << kBottom << "\"/></svg></figure>\n";
  return svg.str();
}

std::string curve_figure(const Curve& curve, std::span<const double> times_s) {
  return curve_figure(curve, times_s, axes_of(curve, times_s));
}

std::string plain_number(double value) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  int decimals = 2;
  if (size >= 99.5) {
    decimals = 0;
  } else if (size >= 9.95) {
    decimals = 1;
  } else if (size > 0.0 && size < 0.0995) {
    decimals = 3;
  }
  return grouped(formatted("%.*f", decimals, value == 0.0 ? 0.0 : value));
}

}  // namespace sulcus
