#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "app/inspect/section_plot.hpp"
#include "app/inspect/suggested_run.hpp"
#include "app/inspect/volume_facts.hpp"
#include "app/report/gnuplot.hpp"
#include "engine/core/units.hpp"
#include "engine/core/user_text.hpp"

namespace sulcus {

namespace {

constexpr int kVolumeWidth = 1500, kVolumeHeight = 1000;
constexpr double kSide = 40.0, kGap = 40.0;                   // pixels
constexpr double kSectionsTop = 60.0, kSectionsHigh = 540.0;  // from the top; of the tallest
constexpr double kHistogramHigh = 230.0, kHistogramBottom = 60.0;
constexpr int kMostPoints = 640;  // of a section along an axis; more are not seen
constexpr const char* kSolidColour = "#ff7f0e";
constexpr const char* kEnamelColour = "#17becf";

/// Across `normal` at voxel `at`; columns run along `u`, rows along `v`.
struct ShownPlane {
  int u, v, normal, at;
};

PlaneValues plane_of(const MedicalVolume& volume, const ShownPlane& section) {
  const int columns = volume.sizes[section.u], rows = volume.sizes[section.v];
  const int every_u = (columns + kMostPoints - 1) / kMostPoints;
  const int every_v = (rows + kMostPoints - 1) / kMostPoints;
  const Eigen::Vector3d mm = volume.spacing_m / kMillimetre;
  PlaneValues plane;
  plane.columns = columns / every_u;
  plane.rows = rows / every_v;
  plane.step_x = mm[section.u] * every_u;
  plane.step_y = mm[section.v] * every_v;
  // Voxels are boxes: the first one's middle is half of it from the edge.
  plane.x0 = 0.5 * plane.step_x;
  plane.y0 = 0.5 * plane.step_y;
  plane.at = [&volume, section, every_u, every_v](int column, int row) {
    Eigen::Vector3i p = Eigen::Vector3i::Zero();
    p[section.u] = column * every_u;
    p[section.v] = row * every_v;
    p[section.normal] = section.at;
    return static_cast<double>(volume.at(p.x(), p.y(), p.z()));
  };
  return plane;
}

void put_histogram(std::FILE* gnuplot, const VolumeFacts& facts) {
  std::fputs("$bins << EOD\n", gnuplot);
  double most = 1.0;
  if (facts.labels.empty()) {
    for (std::size_t i = 0; i < facts.histogram.counts.size(); ++i) {
      const auto n = static_cast<double>(facts.histogram.counts[i]);
      most = std::max(most, n);
      std::fprintf(gnuplot, "%.8g %.8g %.8g\n",
                   facts.histogram.edge(i) + 0.5 * facts.histogram.width, std::max(n, 0.5),
                   facts.histogram.width);
    }
  } else {
    for (const LabelCount& label : facts.labels) {
      const auto n = static_cast<double>(label.voxels);
      most = std::max(most, n);
      std::fprintf(gnuplot, "%d %.8g 0.6\n", label.value, n);
    }
  }
  std::fputs("EOD\n", gnuplot);
  const PlotFrame frame{90.0, kHistogramBottom, kVolumeWidth - 90.0 - kSide, kHistogramHigh};
  put_frame(gnuplot, frame, kVolumeWidth, kVolumeHeight);
  std::fprintf(gnuplot,
               "unset object\nunset label\nset border 3 lc rgb '#444444'\nset xtics nomirror "
               "out\nset ytics nomirror out\n"
               "set logscale y\nset format y '10^{%%L}'\nset termoption enhanced\n"
               "set autoscale x\nset yrange [0.5:%.8g]\nset xlabel '%s' noenhanced\n"
               "set ylabel 'voxels'\nset style fill solid noborder\n",
               2.5 * most, facts.labels.empty() ? "grey value" : "value");
  int number = 1;
  const auto mark = [&](double value, const char* colour, const char* text, double height) {
    std::fprintf(gnuplot,
                 "set arrow %d from first %.8g, graph 0 to first %.8g, graph 1 nohead lw 2 lc rgb "
                 "'%s'\nset label %d '%s %s ' at first %.8g, graph %g right textcolor rgb '%s'\n",
                 number, value, value, colour, number, text, short_number(value).c_str(), value,
                 height, colour);
    ++number;
  };
  if (facts.solid_above) mark(*facts.solid_above, kSolidColour, "solid from", 0.95);
  if (facts.enamel_above) mark(*facts.enamel_above, kEnamelColour, "enamel from", 0.85);
  std::fputs("plot $bins using 1:2:3 with boxes lc rgb '#8a96a3'\n", gnuplot);
}

}  // namespace

bool draw_volume(const MedicalVolume& volume, const VolumeFacts& facts,
                 const std::string& file_png) {
  Eigen::Vector3i middle = volume.sizes / 2;
  if (facts.solid) middle = (facts.solid->box_index.min() + facts.solid->box_index.max()) / 2;
  const std::array<ShownPlane, 3> sections{
      {{0, 1, 2, middle.z()}, {0, 2, 1, middle.y()}, {1, 2, 0, middle.x()}}};
  const Eigen::Vector3d size_mm =
      volume.sizes.cast<double>().cwiseProduct(volume.spacing_m) / kMillimetre;
  const double pixels_per_mm =
      std::min((kVolumeWidth - 2.0 * kSide - 2.0 * kGap) / (2.0 * size_mm.x() + size_mm.y()),
               kSectionsHigh / std::max(size_mm.y(), size_mm.z()));
  double low = 0.0, high = 1.0;
  if (facts.labels.empty()) {
    low = facts.histogram.quantile(0.005);
    high = facts.histogram.quantile(0.998);
  } else {
    low = facts.labels.front().value;
    high = facts.labels.back().value;
  }
  if (!(high > low)) high = low + 1.0;
  return draw_with_gnuplot(file_png, kVolumeWidth, kVolumeHeight, [&](std::FILE* gnuplot) {
    std::fprintf(gnuplot, "set multiplot title %s\nset key off\nunset colorbox\n",
                 for_gnuplot(std::filesystem::path(volume.file).filename().string()).c_str());
    std::fprintf(gnuplot, "set palette gray\nset cbrange [%.8g:%.8g]\n", low, high);
    double left = 0.5 * (kVolumeWidth - (2.0 * size_mm.x() + size_mm.y()) * pixels_per_mm) - kGap;
    for (const ShownPlane& section : sections) {
      const PlaneValues plane = plane_of(volume, section);
      const PlotFrame frame{left, kVolumeHeight - kSectionsTop - plane.height() * pixels_per_mm,
                            plane.width() * pixels_per_mm, plane.height() * pixels_per_mm};
      put_frame(gnuplot, frame, kVolumeWidth, kVolumeHeight);
      put_scale_bar(gnuplot, 1, frame, size_mm.maxCoeff(), pixels_per_mm, kVolumeWidth,
                    kVolumeHeight);
      const double at_mm = (section.at + 0.5) * volume.spacing_m[section.normal] / kMillimetre;
      std::fprintf(gnuplot,
                   "set title '%c right, %c up, at %c = %.2f mm' offset 0, -0.5\nunset tics\n"
                   "set border 15 lc rgb '#bbbbbb'\nset xrange [0:%.8g]\nset yrange [0:%.8g]\n"
                   "plot '-' using 1:2:3 with image, '-' with lines lw 1.6 lc rgb '%s'",
                   "xyz"[section.u], "xyz"[section.v], "xyz"[section.normal], at_mm, plane.width(),
                   plane.height(), kSolidColour);
      if (facts.enamel_above) {
        std::fprintf(gnuplot, ", '-' with lines lw 1.2 lc rgb '%s'", kEnamelColour);
      }
      std::fputs("\n", gnuplot);
      put_values(gnuplot, plane);
      put_contours(gnuplot, plane, std::array{facts.outline()});
      if (facts.enamel_above) put_contours(gnuplot, plane, std::array{*facts.enamel_above});
      std::fputs("unset title\n", gnuplot);
      left += frame.width + kGap;
    }
    put_histogram(gnuplot, facts);
    std::fputs("unset multiplot\n", gnuplot);
  });
}

}  // namespace sulcus
