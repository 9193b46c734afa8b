#include "tools/sulcus_lab/normals/cost_chart.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

#include "engine/core/user_text.hpp"
#include "tools/sulcus_lab/chart.hpp"
#include "tools/sulcus_lab/log_slope.hpp"

namespace sulcus::lab {

std::vector<CostRow> costs_of(const ShapeResult& result) {
  std::vector<CostRow> costs;
  for (const NormalsRow& row : result.rows) {
    if (row.zone != "all") continue;
    costs.push_back({row.method, row.neighbourhood, readouts(row.method, row.neighbourhood),
                     row.ns_per_normal});
  }
  return costs;
}

CostGrowth growth_of(Method method, const std::vector<CostRow>& costs) {
  std::vector<std::pair<double, double>> times, reads;
  for (const CostRow& cost : costs) {
    if (cost.method != method) continue;
    const double edge = 2.0 * cost.neighbourhood + 1.0;
    times.emplace_back(edge, cost.ns_per_normal);
    reads.emplace_back(edge, cost.readouts);
  }
  return {log_slope(times), log_slope(reads)};
}

bool draw_cost(const std::vector<CostRow>& costs, const std::string& shape,
               const std::string& file_png) {
  std::string text, time_plot = "plot ", reads_plot = "plot ";
  for (const MethodInfo& info : all_methods()) {
    std::string block;
    for (const CostRow& cost : costs) {
      if (cost.method != info.method) continue;
      block += std::to_string(2 * cost.neighbourhood + 1) + " " +
               number_for_gnuplot(cost.ns_per_normal) + " " + number_for_gnuplot(cost.readouts) +
               "\n";
    }
    if (block.empty()) continue;
    const std::string name = std::string("$").append(info.name);
    text += name + " << EOD\n" + block + "EOD\n";
    const CostGrowth growth = growth_of(info.method, costs);
    const std::string line = " with linespoints " + line_style(info.method) + " ps 0.9 ";
    char powers[64] = "";
    if (std::isfinite(growth.time)) {
      std::snprintf(powers, sizeof powers, ":  n^%.1f,  n^%.0f", growth.time, growth.readouts);
    }
    time_plot += name + " using 1:2" + line + "notitle, ";
    reads_plot +=
        name + " using 1:3" + line + "title " + for_gnuplot(std::string(info.name) + powers) + ", ";
  }
  text +=
      "set logscale xy\nset border 3 lc rgb '#666666'\nset tics nomirror tc rgb '#222222'\n"
      "set grid xtics ytics lc rgb '#d8d8d8' lw 1\n"
      "set xtics (3, 5, 7, 9, 11, 13, 17, 25)\nset xrange [2.7:28]\n"
      "set xlabel 'n = 2 NS + 1' tc rgb '#222222'\n"
      "set multiplot layout 1,2\nset key off\n"
      "set lmargin at screen 0.06\nset rmargin at screen 0.38\n"
      "set title " +
      for_gnuplot("Time of one normal on the " + spaced_name(shape) + ", one thread") +
      " tc rgb '#111111'\n"
      "set ytics ('10 ns' 10, '100 ns' 100, '1 us' 1e3, '10 us' 1e4, '100 us' 1e5,"
      " '1 ms' 1e6)\n" +
      time_plot +
      "NaN notitle\n"
      "set lmargin at screen 0.44\nset rmargin at screen 0.76\n"
      "set key at screen 0.77,0.85 left top Left reverse samplen 2 spacing 1.5"
      " font 'sans,11' tc rgb '#111111' title 'growth of time, of places read' left\n"
      "set title 'Places read for one normal' tc rgb '#111111'\n"
      "set ytics (10, 100, 1000, 10000)\n" +
      reads_plot + "NaN notitle\nunset multiplot\n";
  return draw_chart(text, 1400, 560, file_png);
}

}  // namespace sulcus::lab
