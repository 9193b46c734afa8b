#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "app/inspect/burr_facts.hpp"
#include "app/inspect/section_plot.hpp"
#include "app/report/gnuplot.hpp"
#include "engine/core/units.hpp"
#include "engine/core/user_text.hpp"

namespace sulcus {

namespace {

constexpr int kBurrWidth = 1100, kBurrHeight = 1000;
constexpr double kTop = 70.0, kBottom = 60.0;
// Nothing else in the picture is quite black: the zero line can be found by its colour.
constexpr const char* kCuttingColour = "#000000";
constexpr const char* kShankColour = "#6a3d9a";

/// A rectangle of the plane through the axis, millimetres.
struct PlaneWindow {
  double left, bottom, width, height;
};

PlaneValues plane_of(const Burr& burr, const PlaneWindow& window, double step_mm) {
  PlaneValues plane;
  plane.columns = std::max(2, static_cast<int>(std::lround(window.width / step_mm)));
  plane.rows = std::max(2, static_cast<int>(std::lround(window.height / step_mm)));
  plane.step_x = window.width / plane.columns;
  plane.step_y = window.height / plane.rows;
  plane.x0 = window.left + 0.5 * plane.step_x;
  plane.y0 = window.bottom + 0.5 * plane.step_y;
  plane.at = [&burr, plane](int column, int row) {
    const Eigen::Vector3d p_tool =
        Eigen::Vector3d(plane.x0 + column * plane.step_x, plane.y0 + row * plane.step_y, 0.0) *
        kMillimetre;
    const DistanceField& field = burr.field;
    return static_cast<double>(field.sample(field.field_from_tool(p_tool).cast<float>())) /
           kMillimetre;
  };
  return plane;
}

/// Where the plane cuts the mesh: a segment a line pair, millimetres.
void put_outline(std::FILE* gnuplot, const TriangleMesh& mesh) {
  std::fputs("$outline << EOD\n", gnuplot);
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = mesh.positions[triangle[i]].cast<double>() / kMillimetre;
    }
    int ends = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d &a = p[i], &b = p[(i + 1) % 3];
      if ((a.z() >= 0.0) == (b.z() >= 0.0)) continue;
      const Eigen::Vector3d q = a + (b - a) * (a.z() / (a.z() - b.z()));
      std::fprintf(gnuplot, "%.6g %.6g\n", q.x(), q.y());
      ++ends;
    }
    if (ends > 0) std::fputs("\n", gnuplot);
  }
  std::fputs("0 -1000\n0 -1000\nEOD\n", gnuplot);  // so that it is never empty
}

/// Lines on the field: of its zero alone, or every 0.1 mm too.
enum class Lines : std::uint8_t { kSurface, kEqualDistance };

void put_window(std::FILE* gnuplot, const Burr& burr, const PlaneWindow& window,
                const PlotFrame& frame, double step_mm, Lines lines) {
  const PlaneValues plane = plane_of(burr, window, step_mm);
  put_frame(gnuplot, frame, kBurrWidth, kBurrHeight);
  const double head = burr.head_length_m / kMillimetre;
  std::fprintf(
      gnuplot, "set xrange [%.8g:%.8g]\nset yrange [%.8g:%.8g]\nplot '-' using 1:2:3 with image",
      window.left, window.left + window.width, window.bottom, window.bottom + window.height);
  if (lines == Lines::kEqualDistance)
    std::fputs(", '-' with lines lw 0.7 lc rgb '#8a8a8a'", gnuplot);
  std::fprintf(gnuplot,
               ", '-' using ($2 <= %.6g ? $1 : NaN):2 with lines lw 4 lc rgb '%s'"
               ", '-' using ($2 > %.6g ? $1 : NaN):2 with lines lw 4 lc rgb '%s'"
               ", $outline using 1:2 with lines lw 1 lc rgb '#ffffff'\n",
               head, kCuttingColour, head, kShankColour);
  put_values(gnuplot, plane);
  if (lines == Lines::kEqualDistance) {
    constexpr double kStep_mm = 0.1;
    std::vector<double> steps;
    for (int i = -10; i <= 10; ++i) {
      if (i != 0) steps.push_back(i * kStep_mm);
    }
    put_contours(gnuplot, plane, steps);
  }
  constexpr std::array kZero{0.0};
  put_contours(gnuplot, plane, kZero);
  put_contours(gnuplot, plane, kZero);
}

}  // namespace

bool draw_burr(const Burr& burr, const BurrFacts& facts, const BurrSettings& settings,
               const std::string& file_png) {
  const FieldGrid& grid = burr.field.grid();
  const Eigen::Vector3d box_mm =
      (grid.samples - Eigen::Vector3i::Ones()).cast<double>() * grid.spacing_m / kMillimetre;
  const Eigen::Vector3d low_mm = grid.origin_tool / kMillimetre;
  const double high = kBurrHeight - kTop - kBottom;
  const double diameter = facts.diameter_m / kMillimetre;
  const double head = burr.head_length_m / kMillimetre;

  const PlaneWindow all{low_mm.x(), low_mm.y(), box_mm.x(), box_mm.y()};
  const double all_scale = std::min(high / all.height, 330.0 / all.width);
  const PlotFrame all_frame{70.0, kBottom, all.width * all_scale, all.height * all_scale};

  const double room = 0.28 * diameter;
  const PlaneWindow close{-0.5 * diameter - 1.6 * room, -room, diameter + 3.2 * room,
                          head + 2.0 * room};
  const double left = all_frame.left + all_frame.width + 70.0;
  const double scale =
      std::min((kBurrWidth - left - 130.0) / close.width, (high - 50.0) / close.height);
  const PlotFrame frame{left, kBottom, close.width * scale, close.height * scale};
  const double radius = 0.5 * diameter;

  return draw_with_gnuplot(file_png, kBurrWidth, kBurrHeight, [&](std::FILE* gnuplot) {
    std::fprintf(gnuplot,
                 "set multiplot\nset label 9 %s at screen 0.5, 0.975 center textcolor rgb "
                 "'#444444'\nset key off\nunset colorbox\nunset tics\n"
                 "set border 15 lc rgb '#bbbbbb'\n"
                 "set palette defined (-1 '#08306b', -0.5 '#6baed6', 0 '#f7f4ee', 0.5 '#fdae6b', "
                 "1 '#a63603')\nset cbrange [%.6g:%.6g]\n",
                 for_gnuplot(burr_title(settings, facts)).c_str(), -radius, radius);
    put_outline(gnuplot, burr.mesh_tool);
    put_scale_bar(gnuplot, 1, all_frame, all.width * 2.0, all_scale, kBurrWidth, kBurrHeight);
    put_window(gnuplot, burr, all, all_frame, all.height / 700.0, Lines::kSurface);

    put_scale_bar(gnuplot, 1, frame, close.width, scale, kBurrWidth, kBurrHeight);
    std::fprintf(gnuplot,
                 "set arrow 1 from %.6g, %.6g to %.6g, %.6g heads size screen 0.008, 20 lc rgb "
                 "'#444444' front\nset label 2 '%.2f mm' at %.6g, %.6g center textcolor rgb "
                 "'#444444' front\n",
                 -radius, -0.45 * room, radius, -0.45 * room, diameter, 0.0, -0.7 * room);
    std::fprintf(gnuplot,
                 "set arrow 2 from %.6g, 0 to %.6g, %.6g heads size screen 0.008, 20 lc rgb "
                 "'#444444' front\nset label 3 '%.2f mm' at %.6g, %.6g center rotate by 90 "
                 "textcolor rgb '#444444' front\n",
                 radius + 0.7 * room, radius + 0.7 * room, head, head, radius + 1.0 * room,
                 0.5 * head);
    std::fprintf(gnuplot,
                 "set label 4 'black: what cuts' at screen %.6f, %.6f left textcolor rgb "
                 "'#444444'\nset label 5 'violet: neck and shank' at screen %.6f, %.6f left "
                 "textcolor rgb '%s'\n",
                 frame.left / kBurrWidth, (frame.bottom + frame.height + 32.0) / kBurrHeight,
                 (frame.left + 180.0) / kBurrWidth,
                 (frame.bottom + frame.height + 32.0) / kBurrHeight, kShankColour);
    const Eigen::Vector3i& n = grid.samples;
    std::fprintf(gnuplot,
                 "set label 6 'field of %d x %d x %d points, %.3g um apart; error at most %.3g um' "
                 "at screen %.6f, %.6f left textcolor rgb '#444444'\n",
                 n.x(), n.y(), n.z(), grid.spacing_m * 1e6, facts.field_error_m * 1e6,
                 frame.left / kBurrWidth, (frame.bottom + frame.height + 12.0) / kBurrHeight);
    std::fprintf(gnuplot,
                 "set colorbox user origin %.6f, %.6f size %.6f, %.6f noborder\n"
                 "set cblabel 'distance, mm' textcolor rgb '#444444'\n"
                 "set cbtics textcolor rgb '#444444'\n",
                 (frame.left + frame.width + 20.0) / kBurrWidth, frame.bottom / kBurrHeight,
                 16.0 / kBurrWidth, std::min(frame.height, 500.0) / kBurrHeight);
    put_window(gnuplot, burr, close, frame, std::max(close.width, close.height) / 420.0,
               Lines::kEqualDistance);
    std::fputs("unset multiplot\n", gnuplot);
  });
}

}  // namespace sulcus
