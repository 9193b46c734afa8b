#include "tools/sulcus_lab/table1/table1_chart.hpp"

#include <cmath>
#include <cstdio>

#include "engine/core/user_text.hpp"
#include "tools/sulcus_lab/chart.hpp"
#include "tools/sulcus_lab/table1/table1_rows.hpp"

namespace sulcus::lab {

namespace {

constexpr int kWidth = 1500, kHeight = 1150;

/// The next of 1, 2 and 5 times a power of ten.
double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (value <= step * power) return step * power;
  }
  return 10.0 * power;
}

std::string three_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

/// One panel between two heights of the picture, in parts of it from below.
std::string panel(double bottom, double top, const std::string& label, const std::string& plot) {
  return "set bmargin at screen " + number_for_gnuplot(bottom) + "\nset tmargin at screen " +
         number_for_gnuplot(top) + "\nset ylabel " + for_gnuplot(label) +
         " offset 1,0 tc rgb '#222222'\n" + plot + "\n";
}

/// The same for differences: from -limit to limit, so that the sign is seen, with three tics.
std::string difference_panel(double bottom, double top, double largest, const std::string& rmse,
                             const std::string& unit, const std::string& columns) {
  const double limit = largest > 0.0 ? round_up(largest) : 1.0;
  const std::string y = number_for_gnuplot(limit);
  // Its key stands above it, in the gap.
  return "set key on at screen 0.98," + number_for_gnuplot(top + 0.015) +
         " right top samplen 0\nset yrange [-" + y + ":" + y + "]\nset ytics (-" + y + ", 0, " + y +
         ")\n" +
         panel(bottom, top, "ldm - exact",
               "plot $data using 1:" + columns + " with lines lw 1 lc rgb '#333333' title " +
                   for_gnuplot("RMSE " + rmse + " " + unit)) +
         "set key off\nset yrange [0:*]\nset ytics autofreq\n";
}

/// Magnitudes of force or torque: ours under the reference, and the truth, dashed, where known.
std::string curves(bool has_truth, int column) {
  const auto curve = [&](int n, const std::string& look, const char* name) {
    return " using 1:" + std::to_string(column + 2 * n) + " with lines " + look + " title '" +
           name + "'";
  };
  std::string plot = "plot $data";
  plot += curve(0, "lw 4 lc rgb '" + colour_of(Method::kLdm) + "'", "ldm");
  plot += ", ''" + curve(1, "lw 1.2 lc rgb '#ff2020'", "exact, offline");
  if (has_truth) plot += ", ''" + curve(2, "lw 1 dt (6,6) lc rgb '#000000'", "analytic normals");
  return plot;
}

}  // namespace

bool draw_table1_chart(const Table1Run& run, const std::string& title,
                       const std::string& file_png) {
  std::string text = "$data << EOD\n";
  for (const ComparedTick& tick : run.compared) {
    text += std::to_string(tick.tick);
    for (const Wrench& wrench : {tick.ours, tick.exact, tick.truth}) {
      text.append(" ").append(number_for_gnuplot(wrench.force_N.norm()));
      text.append(" ").append(number_for_gnuplot(1e3 * wrench.torque_Nm.norm()));
    }
    text.append(" ").append(std::to_string(tick.contacts)).append("\n");
  }
  const WrenchErrors errors =
      wrench_errors(run.compared, &ComparedTick::ours, &ComparedTick::exact);
  text.append("EOD\nset multiplot title ").append(for_gnuplot(title));
  text.append(
      " tc rgb '#111111'\n"
      "set border 3 lc rgb '#666666'\nset tics nomirror tc rgb '#222222'\n"
      "set grid xtics ytics lt 1 lw 1 lc rgb '#dddddd'\n"
      "set lmargin at screen 0.07\nset rmargin at screen 0.98\nset format x ''\n"
      "set yrange [0:*]\nset key right top horizontal samplen 3 tc rgb '#111111'\n");
  text.append("set xrange [0:").append(std::to_string(run.contacts.size())).append("]\n");
  text += panel(0.705, 0.945, "force, N", curves(run.has_truth, 2));
  text += difference_panel(0.605, 0.685, errors.force_max_N, three_digits(errors.force_rmse_N), "N",
                           "($2-$4)");
  text += panel(0.345, 0.580, "torque, mN m", curves(run.has_truth, 3));
  text += difference_panel(0.245, 0.325, errors.torque_max_mNm,
                           three_digits(errors.torque_rmse_mNm), "mN m", "($3-$5)");
  text += "set format x '%.0f'\nset xlabel 'tick' tc rgb '#222222'\n";
  text += panel(0.055, 0.220, "voxels in contact",
                "plot $data using 1:8 with lines lw 1 lc rgb '#333333' notitle");
  text += "unset multiplot\n";
  return draw_chart(text, kWidth, kHeight, file_png);
}

}  // namespace sulcus::lab
