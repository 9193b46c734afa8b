#include "app/inspect/section_plot.hpp"

#include <array>
#include <cstddef>
#include <vector>

#include "engine/surface/colour_scale.hpp"

namespace sulcus {

void put_frame(std::FILE* gnuplot, const PlotFrame& frame, int width, int height) {
  std::fprintf(gnuplot,
               "set lmargin at screen %.8f\nset rmargin at screen %.8f\n"
               "set bmargin at screen %.8f\nset tmargin at screen %.8f\n",
               frame.left / width, (frame.left + frame.width) / width, frame.bottom / height,
               (frame.bottom + frame.height) / height);
}

void put_values(std::FILE* gnuplot, const PlaneValues& plane) {
  for (int row = 0; row < plane.rows; ++row) {
    for (int column = 0; column < plane.columns; ++column) {
      std::fprintf(gnuplot, "%.6g %.6g %.6g\n", plane.x0 + column * plane.step_x,
                   plane.y0 + row * plane.step_y, plane.at(column, row));
    }
    std::fputs("\n", gnuplot);
  }
  std::fputs("e\n", gnuplot);
}

void put_contours(std::FILE* gnuplot, const PlaneValues& plane, std::span<const double> levels) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(plane.columns) * static_cast<std::size_t>(plane.rows));
  for (int row = 0; row < plane.rows; ++row) {
    for (int column = 0; column < plane.columns; ++column) values.push_back(plane.at(column, row));
  }
  std::fputs("0 1e9\n0 1e9\n\n", gnuplot);  // so that it is never empty
  // Marching squares by halves: a line crosses a triangle on two of its sides or on none.
  struct Corner {
    double x, y, value;
  };
  const auto corner = [&](int column, int row) {
    return Corner{plane.x0 + column * plane.step_x, plane.y0 + row * plane.step_y,
                  values[static_cast<std::size_t>(row) * static_cast<std::size_t>(plane.columns) +
                         static_cast<std::size_t>(column)]};
  };
  const auto put_line = [&](const std::array<Corner, 3>& triangle, double level) {
    int ends = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Corner &a = triangle[i], &b = triangle[(i + 1) % 3];
      if ((a.value < level) == (b.value < level)) continue;
      const double t = (level - a.value) / (b.value - a.value);
      std::fprintf(gnuplot, "%.6g %.6g\n", a.x + t * (b.x - a.x), a.y + t * (b.y - a.y));
      ++ends;
    }
    if (ends > 0) std::fputs("\n", gnuplot);
  };
  for (int row = 0; row + 1 < plane.rows; ++row) {
    for (int column = 0; column + 1 < plane.columns; ++column) {
      const Corner a = corner(column, row), b = corner(column + 1, row);
      const Corner c = corner(column + 1, row + 1), d = corner(column, row + 1);
      for (const double level : levels) {
        put_line({a, b, c}, level);
        put_line({a, c, d}, level);
      }
    }
  }
  std::fputs("e\n", gnuplot);
}

void put_scale_bar(std::FILE* gnuplot, int number, const PlotFrame& frame, double width_mm,
                   double pixels_per_mm, int width, int height) {
  const double mm = round_number_above(0.15 * width_mm);
  const double bottom = frame.bottom - 16.0, thick = 5.0;
  std::fprintf(gnuplot,
               "set object %d rectangle from screen %.8f, %.8f to screen %.8f, %.8f fillstyle "
               "solid noborder fillcolor rgb '%s'\n"
               "set label %d '%g mm' at screen %.8f, %.8f left textcolor rgb '#444444'\n",
               number, frame.left / width, bottom / height,
               (frame.left + mm * pixels_per_mm) / width, (bottom + thick) / height,
               kScaleBarColour, number, mm, (frame.left + mm * pixels_per_mm + 8.0) / width,
               (bottom + 2.0) / height);
}

}  // namespace sulcus
