#include "tools/sulcus_lab/ticks/ticks_charts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "engine/core/user_text.hpp"
#include "tools/sulcus_lab/chart.hpp"
#include "tools/sulcus_lab/log_slope.hpp"

namespace sulcus::lab {

namespace {

constexpr TickCache kCaches[] = {TickCache::kFresh, TickCache::kKept, TickCache::kCutting};

/// A line of its method's colour; dash and mark tell where the normals came from.
std::string style_of(const TickSetting& setting) {
  struct Look {
    const char* dash;
    int mark;
  };
  constexpr Look kLooks[] = {{"solid", 7}, {"'_'", 5}, {"'.'", 9}};
  const Look& look = kLooks[static_cast<std::size_t>(setting.cache)];
  return "lw 2.5 lc rgb '" + colour_of(method_named(std::string(method_name(setting)))) + "' dt " +
         look.dash + " pt " + std::to_string(look.mark) + " ps 1.1";
}

std::vector<NormalMethod> methods_in(std::span<const TickRow> rows) {
  std::vector<NormalMethod> methods;
  for (const TickRow& row : rows) {
    if (std::find(methods.begin(), methods.end(), row.setting.method) == methods.end()) {
      methods.push_back(row.setting.method);
    }
  }
  return methods;
}

std::string with_slope(const std::string& name, double slope) {
  char text[96];
  std::snprintf(text, sizeof text, std::isfinite(slope) ? "%s:  n^{%.2f}" : "%s", name.c_str(),
                slope);
  return text;
}

/// A curve over the contacts: its points, and the same by contact.
struct Curve {
  std::string name, style, title;
};

const char* kTicksFrame =
    "set border 3 lc rgb '#666666'\nset tics nomirror tc rgb '#222222'\n"
    "set grid xtics ytics lc rgb '#c8c8c8' lw 1\n";

}  // namespace

bool draw_ticks(std::span<const TickRow> rows, std::span<const TickPlace> places,
                const std::string& file_png) {
  std::string text;
  std::vector<Curve> curves;
  for (const NormalMethod method : methods_in(rows)) {
    for (const TickCache cache : kCaches) {
      const TickSetting setting{method, cache};
      std::string points;
      for (const TickRow& row : rows) {
        if (row.setting.method != method || row.setting.cache != cache) continue;
        points += point_for_gnuplot(row.summary.contacts, row.summary.us_mean);
      }
      if (points.empty()) continue;
      const std::string name =
          std::string(method_name(setting)) + "_" + std::string(cache_name(setting));
      text += block_for_gnuplot(name, points);
      curves.push_back({name, " with linespoints " + style_of(setting),
                        with_slope(spaced_name(name), growth_exponent(rows, setting))});
    }
  }
  std::string pca, fresh, kept;
  std::vector<std::pair<double, double>> pca_points, fresh_points, kept_points;
  const auto add = [](std::string& block_points, std::vector<std::pair<double, double>>& list,
                      double x, double y) {
    block_points += point_for_gnuplot(x, y);
    list.emplace_back(x, y);
  };
  for (const TickPlace& place : places) {
    if (std::isfinite(place.pca_ns)) {
      add(pca, pca_points, place.contacts, 1e-3 * place.pca_ns * place.contacts);
    }
    add(fresh, fresh_points, place.contacts, place.fresh.us);
    add(kept, kept_points, place.contacts, place.kept.us);
  }
  text += block_for_gnuplot("pca", pca) + block_for_gnuplot("floor_fresh", fresh) +
          block_for_gnuplot("floor_kept", kept);
  if (!pca.empty()) {
    curves.push_back(
        {"pca", " with linespoints lw 1.8 lc rgb '" + colour_of(Method::kPca) + "' pt 13 ps 1.1",
         with_slope("PCL PCA, the normals alone", log_slope(pca_points))});
  }
  curves.push_back({"floor_fresh", " with lines lw 2 lc rgb '#777777' dt solid",
                    with_slope("floor, fresh: bytes read", log_slope(fresh_points))});
  curves.push_back({"floor_kept", " with lines lw 2 lc rgb '#777777' dt '_'",
                    with_slope("floor, kept", log_slope(kept_points))});

  std::string times = "plot ", costs = "plot ";
  for (const Curve& curve : curves) {
    times += "$" + curve.name + " using 1:2" + curve.style + " notitle, ";
    costs += "$" + curve.name + " using 1:(1e3*$2/$1)" + curve.style + " title " +
             for_gnuplot(curve.title) + ", ";
  }
  double fewest = 1e9, greatest = 0.0;
  for (const TickRow& row : rows) {
    fewest = std::min(fewest, row.summary.contacts);
    greatest = std::max(greatest, row.summary.contacts);
  }
  text += kTicksFrame;
  text += "set xrange [" + number_for_gnuplot(fewest / 1.3) + ":" +
          number_for_gnuplot(greatest * 1.3) + "]\n";
  text +=
      "set termoption enhanced\nset logscale xy\n"
      "set xtics ('100' 100, '350' 350, '1,200' 1200, '4,000' 4e3, '10,000' 1e4, '30,000' 3e4,"
      " '100,000' 1e5)\n"
      "set xlabel 'voxels in contact, n' tc rgb '#222222'\n"
      "set multiplot layout 1,2\nset key off\n"
      "set lmargin at screen 0.055\nset rmargin at screen 0.405\n"
      "set title 'Time of a tick, one thread' font 'sans,13' tc rgb '#111111'\n"
      "set ytics ('0.1 us' 0.1, '1 us' 1, '10 us' 10, '100 us' 100, '1 ms' 1e3, '10 ms' 1e4,"
      " '100 ms' 1e5, '1 s' 1e6)\n" +
      times +
      "1000 with lines lw 1.5 lc rgb '#222222' notitle, 250 with lines lw 1.5 lc rgb '#222222' dt"
      " '-' notitle\n"
      "set title 'The same for each contact' font 'sans,13' tc rgb '#111111'\n"
      "set lmargin at screen 0.455\nset rmargin at screen 0.785\n"
      "set key at screen 0.795,0.90 left top Left reverse samplen 3 spacing 1.5"
      " font 'sans,11' tc rgb '#111111'\n"
      "set ytics ('1 ns' 1, '2' 2, '5' 5, '10 ns' 10, '20' 20, '50' 50, '100 ns' 100, '200' 200,"
      " '500' 500, '1 us' 1e3, '2' 2e3, '5' 5e3, '10 us' 1e4, '20' 2e4)\n" +
      costs +
      "NaN with lines lw 1.5 lc rgb '#222222' title 'a tick at 1 kHz: 1 ms', "
      "NaN with lines lw 1.5 lc rgb '#222222' dt '-' title 'a quarter of it'\n"
      "unset multiplot\n";
  return draw_chart(text, 1600, 640, file_png);
}

bool draw_tick_stages(std::span<const TickRow> rows, const std::string& file_png) {
  constexpr const char* kColours[kStageCount] = {"#56b4e9", "#0072b2", "#e69f00", "#009e73",
                                                 "#cc79a7"};
  const std::vector<NormalMethod> methods = methods_in(rows);
  std::string text = kTicksFrame;
  text +=
      "set grid noxtics\nset boxwidth 0.86\nset style fill solid 1 noborder\n"
      "set yrange [0:*]\nset xtics rotate by 90 right font 'sans,9' scale 0\n"
      "set ylabel 'ns for each contact' tc rgb '#222222'\n"
      "set key outside right top Left reverse invert samplen 1 spacing 1.4\n"
      "set bmargin 6\n"
      "set multiplot layout " +
      std::to_string(methods.size()) + ",1\n";
  for (const NormalMethod method : methods) {
    const std::string name(kNormalMethodNames[static_cast<std::size_t>(method)]);
    std::string points, tics, labels;
    int bar = 0, group = -1, label = 0, last = 0, begin = 0;
    const auto close_group = [&](int next) {
      if (group >= 0) {
        labels += "set label " + std::to_string(++label) + " " + for_gnuplot(std::to_string(last)) +
                  " at first " + number_for_gnuplot(0.5 * (begin + bar - 1)) +
                  ", graph -0.24 center font 'sans,11' tc rgb '#111111'\n";
        ++bar;  // a gap
      }
      begin = bar;
      group = next;
    };
    for (const TickRow& row : rows) {
      if (row.setting.method != method) continue;
      if (row.wanted != group) close_group(row.wanted);
      last = row.wanted;
      tics.append(tics.empty() ? "'" : ", '").append(cache_name(row.setting));
      tics.append("' ").append(std::to_string(bar));
      points += std::to_string(bar);
      double sum = 0.0;
      for (const StageTimes& stage : row.stages) {
        sum += 1e3 * stage.us_mean / row.summary.contacts;
        points.append(" ").append(number_for_gnuplot(sum));
      }
      points += "\n";
      ++bar;
    }
    close_group(-1);
    text += block_for_gnuplot(name, points) + labels + "set xtics (" + tics +
            ")\nset xrange [-1:" + std::to_string(bar - 1) + "]\nset title " +
            for_gnuplot("Where the time of a tick goes, " + spaced_name(name) +
                        ": stages, by voxels in contact") +
            " font 'sans,13' tc rgb '#111111'\nplot ";
    for (int s = kStageCount; s-- > 0;) {  // the tallest first, the others before it
      text += "$" + name + " using 1:" + std::to_string(s + 2) + " with boxes lc rgb '" +
              kColours[s] + "' title " + for_gnuplot(spaced_name(kStageNames[s])) +
              (s > 0 ? ", " : "\n");
    }
    text += "unset label\n";
  }
  text += "unset multiplot\n";
  return draw_chart(text, 1400, 440 * static_cast<int>(methods.size()), file_png);
}

bool draw_tick_sweeps(std::span<const SweepRow> cells, std::span<const SweepRow> bodies,
                      const std::string& file_png) {
  std::string text = kTicksFrame;
  text +=
      "set logscale x 2\nset yrange [0:1.6]\nset multiplot layout 1,2\n"
      "set ylabel 'time of a tick, to the first' tc rgb '#222222'\n"
      "set key bottom right Left reverse samplen 3 spacing 1.3 font 'sans,10'\n";
  const auto panel = [&](const std::string& name, std::span<const SweepRow> rows, double limit,
                         const std::string& title, const std::string& axis) {
    std::string plot = "plot " + number_for_gnuplot(limit) +
                       " with lines lw 1.5 lc rgb '#222222' dt '-' title 'at most " +
                       number_for_gnuplot(limit) + "'";
    std::string tics;
    std::vector<const SweepRow*> firsts;
    for (const SweepRow& row : rows) {
      if (row.size == rows.front().size) firsts.push_back(&row);
    }
    for (std::size_t f = 0; f < firsts.size(); ++f) {
      const SweepRow& first = *firsts[f];
      std::string points;
      tics.clear();
      for (const SweepRow& row : rows) {
        if (row.wanted != first.wanted || row.setting.method != first.setting.method ||
            row.setting.cache != first.setting.cache) {
          continue;
        }
        points += point_for_gnuplot(row.size, row.summary.us_mean / first.summary.us_mean);
        tics.append(tics.empty() ? "" : ", ").append(std::to_string(row.size));
      }
      const std::string id = name + std::to_string(f);
      text += block_for_gnuplot(id, points);
      char label[96];
      std::snprintf(label, sizeof label, "%s, %s, %d contacts: %.0f us",
                    spaced_name(std::string(method_name(first.setting))).c_str(),
                    std::string(cache_name(first.setting)).c_str(), first.wanted,
                    first.summary.us_mean);
      plot += ", $" + id + " with linespoints " + style_of(first.setting) + " title " +
              for_gnuplot(label);
    }
    text += "set title " + for_gnuplot(title) + " font 'sans,13' tc rgb '#111111'\n" +
            "set xlabel " + for_gnuplot(axis) + " tc rgb '#222222'\nset xrange [" +
            number_for_gnuplot(rows.front().size / 1.2) + ":" +
            number_for_gnuplot(rows.back().size * 1.2) + "]\nset xtics (" + tics + ")\n" + plot +
            "\n";
  };
  if (!cells.empty()) {
    panel("cells", cells, 1.3, "The same contacts in larger grids", "cells along each axis");
  }
  if (!bodies.empty()) panel("bodies", bodies, 1.1, "One of several bodies touched", "bodies");
  text += "unset multiplot\n";
  return draw_chart(text, 1400, 560, file_png);
}

}  // namespace sulcus::lab
