#include "tools/sulcus_lab/normals/normals_charts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/user_text.hpp"
#include "tools/sulcus_lab/chart.hpp"

namespace sulcus::lab {

namespace {

// Decades and their thirds, so that a narrow panel has a few labels too.
constexpr const char* kAxes =
    "set logscale xy\n"
    "set grid xtics ytics lc rgb '#d8d8d8' lw 1\n"
    "set border 3 lc rgb '#666666'\n"
    "set tics nomirror tc rgb '#222222'\n"
    "set xtics ('10 ns' 10, '30' 30, '100 ns' 100, '300' 300, '1 us' 1e3, '3' 3e3,"
    " '10 us' 1e4, '30' 3e4, '100 us' 1e5, '300' 3e5, '1 ms' 1e6)\n"
    "set ytics ('<0.01' 0.01, '0.02' 0.02, '0.05' 0.05, '0.1' 0.1, '0.2' 0.2, '0.5' 0.5, '1' 1,"
    " '2' 2, '3' 3, '5' 5, '10' 10, '15' 15, '20' 20, '30' 30, '45' 45, '90' 90)\n";

struct Panel {
  std::string title;
  std::vector<NormalsRow> rows;  // of one zone
};

std::string panel_title(const std::string& shape, const std::string& zone) {
  if (zone == "all") return spaced_name(shape);
  if (zone == "near") return spaced_name(shape) + ", 2 to 10 voxels from an edge";
  if (zone == "edge") return spaced_name(shape) + ", under 2 voxels from an edge";
  if (zone.starts_with(shape + "_")) {
    return spaced_name(shape) + ", " + zone.substr(shape.size() + 1) +
           (zone.ends_with("_1") ? " voxel thick" : " voxels thick");
  }
  return spaced_name(shape) + ", " + spaced_name(zone);
}

std::vector<NormalsRow> rows_of(const ShapeResult& result, const std::string& zone) {
  std::vector<NormalsRow> rows = result.rows;
  std::erase_if(rows, [&](const NormalsRow& row) { return row.zone != zone; });
  return rows;
}

/// A panel for each zone, or for the whole where there are none.
std::vector<Panel> panels_of(const std::vector<ShapeResult>& results) {
  std::vector<Panel> panels;
  for (const ShapeResult& result : results) {
    std::vector<std::string> zones;
    for (const NormalsRow& row : result.rows) {
      if (row.zone == "all" || std::find(zones.begin(), zones.end(), row.zone) != zones.end()) {
        continue;
      }
      zones.push_back(row.zone);
    }
    // Upright faces are no test: every method is exact on them.
    if (zones.empty() || result.shape == "cube") zones = {"all"};
    for (const std::string& zone : zones) {
      panels.push_back({panel_title(result.shape, zone), rows_of(result, zone)});
    }
  }
  return panels;
}

std::vector<Method> methods_in(const std::vector<NormalsRow>& rows) {
  std::vector<Method> methods;
  for (const MethodInfo& info : all_methods()) {
    if (std::any_of(rows.begin(), rows.end(),
                    [&](const NormalsRow& row) { return row.method == info.method; })) {
      methods.push_back(info.method);
    }
  }
  return methods;
}

std::string block_name(std::size_t panel, Method method) {
  return "$p" + std::to_string(panel) + "_" + std::string(info_of(method).name);
}

/// A logarithm has no place for zero, and what is under a hundredth of a degree is as good.
double drawn_error(const NormalsRow& row) { return std::max(row.mean_deg, 0.01); }

/// Data blocks of a panel: neighbourhood, time, error.
std::string data_of(const Panel& panel, std::size_t index) {
  std::string text;
  for (const Method method : methods_in(panel.rows)) {
    text += block_name(index, method) + " << EOD\n";
    for (const NormalsRow& row : panel.rows) {
      if (row.method != method) continue;
      text += std::to_string(row.neighbourhood) + " " + number_for_gnuplot(row.ns_per_normal) +
              " " + number_for_gnuplot(drawn_error(row)) + "\n";
    }
    text += "EOD\n";
  }
  return text;
}

/// Ours last, so that they lie on top.
std::vector<Method> drawing_order(const std::vector<NormalsRow>& rows) {
  std::vector<Method> methods = methods_in(rows);
  std::reverse(methods.begin(), methods.end());
  return methods;
}

std::string plot_of(const Panel& panel, std::size_t index, double scale) {
  std::string text = "plot ";
  const std::string marked = "($1==" + std::to_string(kMarkedNeighbourhood) + " ? $3 : NaN)";
  for (const Method method : drawing_order(panel.rows)) {
    const std::string block = block_name(index, method), style = line_style(method);
    text += block + " using 2:3 with linespoints " + style + " ps " +
            number_for_gnuplot(0.55 * scale) + " notitle, ";
    text += block + " using 2:" + marked + " with points " + style + " ps " +
            number_for_gnuplot(1.9 * scale) + " notitle, ";
  }
  return text + "NaN notitle\n";
}

/// One entry per method, without data.
std::string legend_plot(const std::vector<Method>& methods) {
  std::string text = "plot ";
  for (const Method method : methods) {
    text += "NaN with linespoints " + line_style(method) + " ps 1.5 title '" +
            std::string(info_of(method).name) + "', ";
  }
  return text + "NaN notitle\n";
}

struct Range {
  double least = std::numeric_limits<double>::infinity();
  double greatest = 0.0;

  void add(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  /// As gnuplot's, with some room; its own choice where there is nothing.
  std::string text(double room) const {
    if (greatest == 0.0) return "[*:*]";
    return std::string("[") + number_for_gnuplot(least / room) + ":" +
           number_for_gnuplot(greatest * room) + "]";
  }
};

Range time_range(const std::vector<Panel>& panels) {
  Range range;
  for (const Panel& panel : panels) {
    for (const NormalsRow& row : panel.rows) range.add(row.ns_per_normal);
  }
  return range;
}

Range error_range(const Panel& panel) {
  Range range;
  for (const NormalsRow& row : panel.rows) range.add(drawn_error(row));
  return range;
}

}  // namespace

bool draw_speed_accuracy(const std::vector<ShapeResult>& results, const std::string& file_png) {
  const std::vector<Panel> panels = panels_of(results);
  const std::size_t cells = panels.size() + 1;  // the legend has one
  const std::size_t columns = std::min<std::size_t>(cells, cells <= 4 ? 2 : cells <= 9 ? 3 : 4);
  const std::size_t lines = (cells + columns - 1) / columns;
  std::string text;
  for (std::size_t p = 0; p < panels.size(); ++p) text += data_of(panels[p], p);
  text += "set multiplot layout " + std::to_string(lines) + "," + std::to_string(columns) +
          " title \"Mean error of a contact normal, degrees, against its time on one thread" +
          (columns > 2 ? "; " : "\\n") +
          "NS rises from left to right, large marks: NS = " + std::to_string(kMarkedNeighbourhood) +
          "\" font 'sans,14'\n";
  text += kAxes;
  text += "set key off\nset lmargin 6\nset rmargin 1.5\nset tmargin 2.4\nset bmargin 2.4\n";
  text += "set xrange " + time_range(panels).text(1.4) + "\n";
  std::vector<NormalsRow> all;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    text += "set title " + for_gnuplot(panels[p].title) +
            " font 'sans,11' tc rgb '#111111' offset 0,-0.4\n";
    text += "set yrange " + error_range(panels[p]).text(1.3) + "\n" + plot_of(panels[p], p, 0.9);
    all.insert(all.end(), panels[p].rows.begin(), panels[p].rows.end());
  }
  text +=
      "unset title\nunset border\nunset tics\nunset grid\nunset logscale\nset xrange [0:1]\n"
      "set yrange [0:1]\nset key center center Left reverse samplen 5 spacing 1.4 font 'sans,13'"
      " tc rgb '#111111'\n" +
      legend_plot(methods_in(all)) + "unset multiplot\n";
  return draw_chart(text, static_cast<int>(420 * columns), static_cast<int>(330 * lines + 60),
                    file_png);
}

bool draw_speed_accuracy_of(const ShapeResult& result, const std::string& file_png) {
  const Panel panel{panel_title(result.shape, "all"), rows_of(result, "all")};
  std::string text = data_of(panel, 0);
  text += kAxes;
  text += "set title " +
          for_gnuplot("Contact normals on the " + panel.title +
                      ": accuracy against speed, large marks NS = " +
                      std::to_string(kMarkedNeighbourhood)) +
          " font 'sans,14' tc rgb '#111111'\n";
  text +=
      "set xlabel 'time of one normal, one thread' tc rgb '#222222'\n"
      "set ylabel 'mean error, degrees' tc rgb '#222222'\n"
      "set key outside right center Left reverse samplen 3 spacing 1.4 font 'sans,12' tc rgb "
      "'#111111'\n";
  text += "set xrange " + time_range({panel}).text(1.3) + "\n";
  text += "set yrange " + error_range(panel).text(1.2) + "\n";
  std::string plot = plot_of(panel, 0, 1.0);
  plot.erase(plot.rfind("NaN notitle"));
  for (const Method method : {Method::kLdm, Method::kLdmFast}) {
    const std::vector<Method> methods = methods_in(panel.rows);
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) continue;
    plot += block_name(0, method) +
            " using 2:3:1 with labels offset 0,-1.1 font 'sans,9' tc rgb '" + colour_of(method) +
            "' notitle, ";
  }
  text += plot + legend_plot(methods_in(panel.rows)).substr(5);
  return draw_chart(text, 1000, 640, file_png);
}

}  // namespace sulcus::lab
