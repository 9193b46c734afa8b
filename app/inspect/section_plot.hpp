#pragma once

#include <cstdio>
#include <functional>
#include <span>
#include <string>

namespace sulcus {

/// Where something is drawn, pixels from the picture's lower left corner.
struct PlotFrame {
  double left = 0.0, bottom = 0.0, width = 0.0, height = 0.0;
};

/// Values on a plane: columns x rows points `step` apart, the first at (x0, y0), millimetres.
struct PlaneValues {
  int columns = 0, rows = 0;
  double x0 = 0.0, y0 = 0.0, step_x = 1.0, step_y = 1.0;
  std::function<double(int column, int row)> at;

  double width() const { return columns * step_x; }
  double height() const { return rows * step_y; }
};

/// Frames in gnuplot's words: margins at exact pixels of a picture of that size.
void put_frame(std::FILE* gnuplot, const PlotFrame& frame, int width, int height);

// Data for a plot command that was written before, which reads '-' for each of them in turn.

/// The values themselves: x, y, value.
void put_values(std::FILE* gnuplot, const PlaneValues& plane);
/// Lines on which the values are one of `levels`, linear between the points.
void put_contours(std::FILE* gnuplot, const PlaneValues& plane, std::span<const double> levels);

/// A bar of a round length, about a fifth of `width_mm`, below a frame's left end, with its length
/// beside it; `pixels_per_mm` is the scale of what is drawn.
void put_scale_bar(std::FILE* gnuplot, int number, const PlotFrame& frame, double width_mm,
                   double pixels_per_mm, int width, int height);

/// The colour of scale bars, which nothing else has.
inline constexpr const char* kScaleBarColour = "#202428";

}  // namespace sulcus
