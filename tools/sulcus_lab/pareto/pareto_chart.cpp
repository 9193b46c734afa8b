#include "tools/sulcus_lab/pareto/pareto_chart.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/user_text.hpp"
#include "tools/sulcus_lab/chart.hpp"

namespace sulcus::lab {

namespace {

std::string name_of(NormalMethod method) {
  return std::string(kNormalMethodNames[static_cast<std::size_t>(method)]);
}

std::string point(const ParetoRow& row) {
  return number_for_gnuplot(row.tick_us) + " " + number_for_gnuplot(row.whole_pct);
}

/// Data blocks: a method's rows with the first field, and those with the others.
std::string data_of(const std::vector<ParetoRow>& rows, NormalMethod method) {
  std::string first, others;
  for (const ParetoRow& row : rows) {
    if (row.setting.method == method)
      (row.setting.field == 0 ? first : others) += point(row) + "\n";
  }
  const std::string name = name_of(method);
  return block_for_gnuplot(name, first) + block_for_gnuplot("others_" + name, others);
}

/// Least and greatest of a column.
std::pair<double, double> range_of(const std::vector<ParetoRow>& rows, double ParetoRow::*column) {
  const auto [least, greatest] = std::minmax_element(
      rows.begin(), rows.end(),
      [&](const ParetoRow& a, const ParetoRow& b) { return a.*column < b.*column; });
  return {*least.*column, *greatest.*column};
}

std::vector<ParetoRow> front_of(const std::vector<ParetoRow>& rows) {
  std::vector<ParetoRow> front = rows;
  std::erase_if(front, [](const ParetoRow& row) { return !row.on_front; });
  std::sort(front.begin(), front.end(),
            [](const ParetoRow& a, const ParetoRow& b) { return a.tick_us < b.tick_us; });
  return front;
}

}  // namespace

bool draw_pareto(const std::vector<ParetoRow>& rows, std::span<const std::string> fields,
                 const std::string& file_png) {
  const std::vector<ParetoRow> front = front_of(rows);
  const auto [fastest, slowest] = range_of(rows, &ParetoRow::tick_us);
  const auto [least, worst] = range_of(rows, &ParetoRow::whole_pct);
  // Names lie before the front, where no mark can be.
  const std::string ranges = "set xrange [" + number_for_gnuplot(fastest / 3.0) + ":" +
                             number_for_gnuplot(slowest * 1.3) + "]\nset yrange [" +
                             number_for_gnuplot(least / 1.5) + ":" +
                             number_for_gnuplot(worst * 1.2) + "]\n";
  std::string text, others;
  for (const std::string& field : fields.subspan(1)) {
    others.append(others.empty() ? "" : ", ").append(field);
  }
  for (std::size_t m = 0; m < kNormalMethodNames.size(); ++m) {
    text += data_of(rows, static_cast<NormalMethod>(m));
  }
  // A staircase: what is better than a mark is below it and to its left.
  text += "$front << EOD\n";
  if (!front.empty()) {
    text +=
        number_for_gnuplot(front.front().tick_us) + " " + number_for_gnuplot(1.2 * worst) + "\n";
    for (const ParetoRow& row : front) text += point(row) + "\n";
    text +=
        number_for_gnuplot(1.3 * slowest) + " " + number_for_gnuplot(front.back().whole_pct) + "\n";
  }
  text += "EOD\n$names << EOD\n";
  for (const ParetoRow& row : front) {
    // Once for the fields of a setting that differ little: at the best of them.
    const bool again = std::any_of(front.begin(), front.end(), [&](const ParetoRow& other) {
      return other.setting.method == row.setting.method &&
             other.setting.neighbourhood == row.setting.neighbourhood &&
             other.whole_pct < row.whole_pct;
    });
    if (again) continue;
    text +=
        point(row) + " " +
        for_gnuplot(name_of(row.setting.method) + " " + std::to_string(row.setting.neighbourhood)) +
        "\n";
  }
  text +=
      "EOD\nset logscale xy\nset border 3 lc rgb '#666666'\nset tics nomirror tc rgb '#222222'\n"
      "set grid xtics ytics lc rgb '#d8d8d8' lw 1\n"
      "set xtics ('10 us' 10, '20' 20, '50' 50, '100 us' 100, '200' 200, '500' 500, '1 ms' 1e3,"
      " '2' 2e3, '5' 5e3, '10 ms' 1e4, '20' 2e4, '50' 5e4, '100 ms' 1e5)\n"
      "set ytics ('0.1' 0.1, '0.2' 0.2, '0.5' 0.5, '0.7' 0.7, '1 %%' 1, '1.5' 1.5, '2' 2, '3' 3,"
      " '5' 5, '7' 7, '10 %%' 10, '15' 15, '20' 20, '30' 30)\n"
      "set xlabel 'time of a tick, one thread' tc rgb '#222222'\n"
      "set ylabel 'error of the net force, RMS' tc rgb '#222222'\n"
      "set title " +
      for_gnuplot(
          "Force and time of a tick on the molar, a burr of 20 voxels' radius pressed in by 4") +
      " font 'sans,13' tc rgb '#111111'\nset label 1 " +
      for_gnuplot("Lines: NS rising, a distance field of " + fields.front() +
                  " samples across. Small marks: " + others + ".") +
      " at graph 0.5,1.02 center font 'sans,10' tc rgb '#444444'\nset title offset 0,0.8\n"
      "set key outside right top Left reverse samplen 2 spacing 1.4 font 'sans,12' tc rgb "
      "'#111111'\n";
  std::string plot = "plot ", legend;
  for (std::size_t m = kNormalMethodNames.size(); m-- > 0;) {  // ours last, on top
    const std::string name = name_of(static_cast<NormalMethod>(m));
    const std::string style = line_style(method_named(name));
    plot += "$others_" + name + " with points " + style + " ps 0.6 notitle, $" + name +
            " with linespoints " + style + " ps 1.3 notitle, ";
    legend = ", NaN with linespoints " + style + " ps 1.3 title '" + name + "'" + legend;
  }
  plot +=
      "$front with steps lw 1.6 lc rgb '#111111' notitle, "
      "$names with labels right rotate by 25 offset -0.8,-0.3 font 'sans,10' tc rgb '#111111'"
      " notitle" +
      legend + ", NaN with lines lw 1.6 lc rgb '#111111' title 'the front'\n";
  return draw_chart(text + ranges + plot, 1200, 760, file_png);
}

}  // namespace sulcus::lab
