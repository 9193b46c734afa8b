#include "app/report/force_chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>

#include "app/report/gnuplot.hpp"
#include "engine/core/user_text.hpp"

namespace sulcus {

namespace {

double length(const std::array<float, 3>& v) {
  return std::hypot(static_cast<double>(v[0]), static_cast<double>(v[1]),
                    static_cast<double>(v[2]));
}

void put_vector(std::FILE* gnuplot, const std::array<float, 3>& v) {
  std::fprintf(gnuplot, " %g %g %g %g", static_cast<double>(v[0]), static_cast<double>(v[1]),
               static_cast<double>(v[2]), length(v));
}

/// Time, force x y z and magnitude, torque x y z and magnitude, contacts, us of a tick, krpm.
void put_data(std::FILE* gnuplot, std::span<const ChartPoint> points) {
  std::fputs("$data << EOD\n", gnuplot);
  for (const ChartPoint& p : points) {
    std::fprintf(gnuplot, "%.9g", p.time_s);
    put_vector(gnuplot, p.force_N);
    put_vector(gnuplot, p.torque_mNm);
    std::fprintf(gnuplot, " %u %g %g\n", p.contacts, static_cast<double>(p.tick_us),
                 static_cast<double>(p.spindle_krpm));
  }
  if (points.empty()) std::fputs("0 0 0 0 0 0 0 0 0 0 0 0\n", gnuplot);
  std::fputs("EOD\n", gnuplot);
}

/// x, y, z and the magnitude, which the four columns from `column` on hold.
void plot_vector(std::FILE* gnuplot, const char* label, int column) {
  std::fprintf(gnuplot,
               "set autoscale y\nset ylabel '%s'\nset key outside right center samplen 1\n"
               "plot $data using 1:%d with lines lw 2 lc rgb '#b0b0b0' title 'all', "
               "'' using 1:%d with lines lw 1 lc rgb '#c0392b' title 'x', "
               "'' using 1:%d with lines lw 1 lc rgb '#2e8b57' title 'y', "
               "'' using 1:%d with lines lw 1 lc rgb '#1f4e9c' title 'z'\n"
               "set key off\nset yrange [0:*]\n",
               label, column + 3, column, column + 1, column + 2);
}

}  // namespace

bool draw_force_chart(const RunStatistics& statistics, const std::string& title, bool sags,
                      const std::string& file_png) {
  const std::vector<ChartPoint>& points = statistics.chart.points();
  const double begin_s = points.empty() ? 0.0 : points.front().time_s;
  const double end_s = points.empty() ? 1.0 : points.back().time_s;
  const double usual_us = 2.0 * statistics.tick_us.quantile(0.99);
  const bool cut_off = statistics.tick_us.largest() > usual_us && usual_us > 0.0;
  return draw_with_gnuplot(file_png, 1200, 900, [&](std::FILE* gnuplot) {
    put_data(gnuplot, points);
    std::fprintf(gnuplot,
                 "set multiplot layout %d,1 title %s\nset grid lc rgb '#dddddd'\n"
                 "set lmargin 9\nset rmargin 9\nset xrange [%.9g:%.9g]\n",
                 sags ? 5 : 4, for_gnuplot(title).c_str(), begin_s,
                 std::max(end_s, begin_s + 1e-3));
    plot_vector(gnuplot, "force, N", 2);
    plot_vector(gnuplot, "torque, mN m", 6);
    std::fputs(
        "set ylabel 'voxels in contact'\n"
        "plot $data using 1:10 with lines lw 1 lc rgb '#555555'\n",
        gnuplot);
    if (sags) {
      std::fputs(
          "set ylabel 'speed, krpm'\n"
          "plot $data using 1:12 with lines lw 1 lc rgb '#6b4aa0'\n",
          gnuplot);
    }
    if (cut_off) {
      std::fprintf(gnuplot,
                   "set yrange [0:%.6g]\nset label 1 'longest %.0f us' at graph 0.995, 0.9 right "
                   "textcolor rgb '#b5651d'\n",
                   usual_us, statistics.tick_us.largest());
    }
    std::fputs(
        "set ylabel 'tick, us'\nset xlabel 'time, s'\n"
        "plot $data using 1:11 with lines lw 1 lc rgb '#b5651d'\n"
        "unset multiplot\n",
        gnuplot);
  });
}

}  // namespace sulcus
