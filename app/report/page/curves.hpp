#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sulcus {

/// A quantity over a run, by its rows; not finite where it has none.
struct Curve {
  std::string name, unit, colour;
  std::vector<double> values{};
};

/// What the axes of several curves share, so that they can be compared.
struct CurveAxes {
  double end_s = 0.0, low = 0.0, high = 1.0;
};

/// Where the axis ends that a curve needs: at round numbers.
CurveAxes axes_of(const Curve& curve, std::span<const double> times_s);
CurveAxes joined(const CurveAxes& a, const CurveAxes& b);

/// As an SVG in a <figure>, with ticks at 1, 2 or 5 times a power of ten on both axes. Of the rows
/// that fall on a pixel the largest is drawn. `times_s`: of the rows, rising. The SVG says in
/// data-left, data-right and data-end where 0 s and the axis' end are, for a page to mark a time.
std::string curve_figure(const Curve& curve, std::span<const double> times_s,
                         const CurveAxes& axes);
/// With axes of its own.
std::string curve_figure(const Curve& curve, std::span<const double> times_s);

/// The step of an axis that is so long, with at most so many of them: 1, 2 or 5 times a power of
/// ten.
double round_step(double length, int most);

/// With as many digits as a person reads: 2,390; 14.3; 4.05; 0.012.
std::string plain_number(double value);

}  // namespace sulcus
