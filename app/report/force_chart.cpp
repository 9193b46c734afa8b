#include "app/report/force_chart.hpp"

#include <cstdio>

#include "app/report/gnuplot.hpp"
#include "engine/core/user_text.hpp"

namespace sulcus {

bool draw_force_chart(const RunStatistics& statistics, const std::string& title,
                      const std::string& file_png) {
  return draw_with_gnuplot(file_png, 1200, 900, [&](std::FILE* gnuplot) {
    std::fputs("$data << EOD\n", gnuplot);
    for (const ChartPoint& p : statistics.chart.points()) {
      std::fprintf(gnuplot, "%llu %g %g %u %g\n", static_cast<unsigned long long>(p.tick),
                   static_cast<double>(p.force_N), static_cast<double>(p.torque_mNm), p.contacts,
                   static_cast<double>(p.tick_us));
    }
    if (statistics.ticks == 0) std::fputs("0 0 0 0 0\n", gnuplot);
    std::fprintf(
        gnuplot,
        "EOD\n"
        "set multiplot layout 4,1 title %s\n"
        "set grid lc rgb '#dddddd'\nset key off\nset lmargin 9\nset yrange [0:*]\n"
        "set ylabel 'force, N'\nplot $data using 1:2 with lines lw 1 lc rgb '#1f4e9c'\n"
        "set ylabel 'torque, mN m'\nplot $data using 1:3 with lines lw 1 lc rgb '#1f4e9c'\n"
        "set ylabel 'voxels in contact'\n"
        "plot $data using 1:4 with lines lw 1 lc rgb '#555555'\n"
        "set ylabel 'tick, us'\nset xlabel 'tick'\n"
        "plot $data using 1:5 with lines lw 1 lc rgb '#b5651d'\n"
        "unset multiplot\n",
        for_gnuplot(title).c_str());
  });
}

}  // namespace sulcus
