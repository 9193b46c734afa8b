#include "tools/sulcus_lab/stability/stability_charts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "engine/core/user_text.hpp"
#include "tools/sulcus_lab/chart.hpp"
#include "tools/sulcus_lab/stability/chart_text.hpp"

namespace sulcus::lab {

namespace {

using namespace chart_text;  // NOLINT(google-build-using-namespace): the words of these pictures

/// Tics of a logarithmic axis that any reader can read off: 1, 2 and 5 of each decade, over more
/// than two of them 1 and 3.
std::string plain_log_tics(const char* axis, double low, double high) {
  const bool wide = high > 100.0 * low;
  std::string tics;
  for (int decade = -4; decade <= 6; ++decade) {
    for (const double step : {1.0, 2.0, 3.0, 5.0}) {
      if (step == (wide ? 2.0 : 3.0) || (wide && step == 5.0)) continue;
      const double value = step * std::pow(10.0, decade);
      if (value < 0.99 * low || value > 1.01 * high) continue;
      const std::string text = number_for_gnuplot(value);
      tics += (tics.empty() ? "'" : ", '") + text + "' " + text;
    }
  }
  return std::string("set ") + axis + "tics (" + tics + ")\n";
}

/// What lies between two bounds of a logarithmic axis; 0 and no end at the bounds.
class LogSpan {
 public:
  void take(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return;
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  bool empty() const { return low_ > high_; }
  double low() const { return empty() ? 0.1 : low_ / 1.5; }
  double high() const { return empty() ? 10.0 : high_ * 1.5; }
  /// NaN stays.
  double inside(double value) const {
    return std::isnan(value) ? value : std::clamp(value, low(), high());
  }

 private:
  double low_ = std::numeric_limits<double>::infinity(), high_ = 0.0;
};

}  // namespace

bool draw_frontier(std::span<const FrontierPoint> points, const std::string& file_png) {
  if (points.empty()) return false;
  LogSpan contacts, stiffness;
  std::vector<ContactMethod> methods;
  for (const FrontierPoint& p : points) {
    contacts.take(p.contacts);
    stiffness.take(p.felt_hold_N_per_mm);
    stiffness.take(p.felt_buzz_N_per_mm);
    place_in(methods, p.method);
  }
  std::sort(methods.begin(), methods.end());

  std::string text = kFrame;
  std::vector<std::string> titles;
  std::string behind;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::vector<FrontierPoint> line;
    std::copy_if(points.begin(), points.end(), std::back_inserter(line),
                 [&](const FrontierPoint& p) { return p.method == methods[m]; });
    std::sort(line.begin(), line.end(), [](const FrontierPoint& a, const FrontierPoint& b) {
      return a.contacts < b.contacts;
    });
    for (FrontierPoint& p : line) {
      p.felt_hold_N_per_mm = stiffness.inside(p.felt_hold_N_per_mm);
      p.felt_buzz_N_per_mm = stiffness.inside(p.felt_buzz_N_per_mm);
    }
    std::string hold, buzz, fill;
    bool exists = false, everywhere = true;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const FrontierPoint& p = line[i];
      hold += point_for_gnuplot(p.contacts, p.felt_hold_N_per_mm);
      buzz += point_for_gnuplot(p.contacts, p.felt_buzz_N_per_mm);
      const bool usable = p.felt_hold_N_per_mm < p.felt_buzz_N_per_mm;
      exists = exists || usable;
      everywhere = everywhere && usable;
      const auto fill_at = [&](double x, double low, double high) {
        fill += number_for_gnuplot(x) + " " + number_for_gnuplot(low) + " " +
                number_for_gnuplot(high) + "\n";
      };
      if (usable) fill_at(p.contacts, p.felt_hold_N_per_mm, p.felt_buzz_N_per_mm);
      if (i + 1 == line.size()) break;
      // Where the two lines cross on the way to the next, as they are drawn: straight in the
      // logarithms.
      const FrontierPoint& q = line[i + 1];
      const double here = std::log(p.felt_buzz_N_per_mm / p.felt_hold_N_per_mm);
      const double there = std::log(q.felt_buzz_N_per_mm / q.felt_hold_N_per_mm);
      const bool usable_there = there > 0.0;
      if (usable == usable_there || std::isnan(here) || std::isnan(there)) {
        if (!usable_there && !fill.empty() && usable) fill += "\n";
        continue;
      }
      const double t = here / (here - there);
      const double x = std::exp((1.0 - t) * std::log(p.contacts) + t * std::log(q.contacts));
      const double y =
          std::exp((1.0 - t) * std::log(p.felt_hold_N_per_mm) + t * std::log(q.felt_hold_N_per_mm));
      fill_at(x, y, y);
      if (usable) fill += "\n";  // the next piece is one of its own
    }
    const std::string id = std::to_string(m);
    text += block_for_gnuplot("hold" + id, hold) + block_for_gnuplot("buzz" + id, buzz) +
            block_for_gnuplot("fill" + id, fill);
    titles.push_back(title_of(methods[m]) + (!exists      ? ": nowhere"
                                             : everywhere ? ": everywhere"
                                                          : ": where filled"));
    behind += "$buzz" + id + " using 1:2 with lines lw 1 lc rgb '#cccccc' dt '-' notitle, $hold" +
              id + " using 1:2 with lines lw 1 lc rgb '#cccccc' notitle, ";
  }

  const int columns = methods.size() < 3 ? static_cast<int>(methods.size()) : 3;
  const int rows = (static_cast<int>(methods.size()) + columns - 1) / columns;
  const int width = columns * 460 + 40, height = 90 + rows * 380;
  const auto across = [&](double pixels) { return pixels / width; };
  const auto up = [&](double pixels_from_top) { return 1.0 - pixels_from_top / height; };
  text +=
      "set multiplot\nset label 1 'Where a method can be used: stiff enough to hold the push, and "
      "not "
      "yet buzzing' at screen " +
      number_for_gnuplot(across(70)) + "," + number_for_gnuplot(up(26)) +
      " left font 'sans,14' tc rgb '#111111'\n" +
      key_across(across(70), across(width - 30), up(42),
                 "NaN with linespoints lw 2.5 lc rgb '#333333' pt 7 ps 0.9 title 'the least that "
                 "holds', NaN with linespoints lw 2.5 lc rgb '#333333' dt '-' pt 6 ps 0.9 title "
                 "'the largest before buzz', NaN with boxes fs solid 0.3 noborder lc rgb '#333333' "
                 "title 'can be used', NaN with lines lw 1 lc rgb '#bbbbbb' title 'other "
                 "methods'") +
      "unset label 1\nset logscale xy\n" + range("x", contacts.low(), contacts.high()) +
      range("y", stiffness.low(), stiffness.high()) +
      plain_log_tics("y", stiffness.low(), stiffness.high()) +
      plain_log_tics("x", contacts.low(), contacts.high());
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const int column = static_cast<int>(m) % columns, row = static_cast<int>(m) / columns;
    const double left = 75 + 460 * column, top = 110 + 380 * row;
    const Look& look = look_of(methods[m]);
    const std::string id = std::to_string(m);
    const std::string line = " lw 2.5 lc rgb '" + std::string(look.colour) + "' ";
    text += margins(across(left), across(left + 370), up(top + 280), up(top)) + "set label 2 " +
            for_gnuplot(titles[m]) + " at screen " + number_for_gnuplot(across(left)) + "," +
            number_for_gnuplot(up(top - 13)) + " left font 'sans,12' tc rgb '#111111'\n" +
            "set xlabel 'voxels in contact' offset 0,0.4 tc rgb '#222222'\n" +
            (column == 0 ? "set ylabel 'felt stiffness, N/mm' offset 1,0 tc rgb '#222222'\n"
                         : "unset ylabel\n");
    text += "plot " + behind;
    text += "$fill" + id + " using 1:2:3 with filledcurves fs transparent solid 0.18 noborder" +
            " lc rgb '" + look.colour + "' notitle, ";
    text += "$buzz" + id + " using 1:2 with linespoints dt '-' pt 6 ps 0.9" + line + "notitle, ";
    text += "$hold" + id + " using 1:2 with linespoints dt solid pt 7 ps 0.9" + line + "notitle";
    text += "\n";
  }
  return draw_chart(text + "unset multiplot\n", width, height, file_png);
}

bool draw_damping(std::span<const DampingPoint> points, const std::string& file_png) {
  if (points.empty()) return false;
  LogSpan stiffness;
  std::vector<std::string> labels;
  double most = 0.0;
  for (const DampingPoint& p : points) {
    stiffness.take(p.largest_stable_N_per_mm);
    place_in(labels, p.label);
    most = std::max(most, p.damping_N_s_per_m);
  }
  std::string text = kFrame, plot;
  for (std::size_t l = 0; l < labels.size(); ++l) {
    std::vector<std::pair<double, double>> line;
    for (const DampingPoint& p : points) {
      if (p.label == labels[l]) line.emplace_back(p.damping_N_s_per_m, p.largest_stable_N_per_mm);
    }
    std::sort(line.begin(), line.end());
    std::string inside, edge;
    for (const auto& [damping, largest] : line) {
      const double y = stiffness.inside(largest);
      inside += point_for_gnuplot(damping, y);
      if (y != largest) edge += point_for_gnuplot(damping, y);
    }
    const auto method =
        std::find(kContactMethodNames.begin(), kContactMethodNames.end(), labels[l]);
    Look look{kLabelColours[l % std::size(kLabelColours)], 2.2, 5 + 2 * static_cast<int>(l % 5)};
    if (method != kContactMethodNames.end()) {
      look = kMethodLooks[method - kContactMethodNames.begin()];
    }
    const std::string id = std::to_string(l);
    const std::string colour = std::string(" lc rgb '") + look.colour + "'";
    text += block_for_gnuplot("line" + id, inside) + block_for_gnuplot("edge" + id, edge);
    plot +=
        (plot.empty() ? "plot $line" : ", $line") + id + " using 1:2 with linespoints lw " +
        number_for_gnuplot(look.width) + " pt " + std::to_string(look.mark) + " ps 1.2 dt " +
        (l < std::size(kLabelColours) || method != kContactMethodNames.end() ? "solid" : "'-'") +
        colour + " title " + for_gnuplot(spaced_name(labels[l]));
    // Open marks on the frame's edge: the value lies beyond it.
    if (!edge.empty()) {
      plot += ", $edge" + id + " using 1:2 with points pt 6 ps 2.2 lw 2" + colour + " notitle";
    }
  }
  text +=
      "set logscale y\n" + range("y", stiffness.low(), stiffness.high()) +
      plain_log_tics("y", stiffness.low(), stiffness.high()) +
      range("x", 0.0, most > 0.0 ? 1.03 * most : 1.0) +
      "set xlabel 'damping, N s/m' tc rgb '#222222'\n"
      "set ylabel 'largest stable stiffness, N/mm' tc rgb '#222222'\n"
      "set title 'How damping moves the largest stable stiffness' font 'sans,14' tc rgb "
      "'#111111'\n"
      "set key outside right top Left reverse samplen 3 spacing 1.5 font 'sans,11' tc rgb "
      "'#111111'\n"
      "set label 1 'A ring: beyond the frame, none or all that were tried' at graph 0,-0.15 left "
      "font 'sans,10' tc rgb '#444444'\nset bmargin 5.5\n";
  return draw_chart(text + plot + "\n", 1200, 640, file_png);
}

bool draw_speed_error(std::span<const SpeedErrorPoint> points, const std::string& file_png) {
  if (points.empty()) return false;
  LogSpan time, error;
  std::vector<ContactMethod> methods;
  for (const SpeedErrorPoint& p : points) {
    time.take(p.tick_us);
    error.take(p.force_error_percent);
    place_in(methods, p.method);
  }
  std::sort(methods.begin(), methods.end());
  std::string text = kFrame, plot;
  for (std::size_t m = methods.size(); m-- > 0;) {  // ours last, on top
    std::vector<std::pair<double, double>> line;
    for (const SpeedErrorPoint& p : points) {
      if (p.method == methods[m]) {
        line.emplace_back(time.inside(p.tick_us), error.inside(p.force_error_percent));
      }
    }
    std::sort(line.begin(), line.end());
    std::string marks;
    for (const auto& [x, y] : line) marks += point_for_gnuplot(x, y);
    const Look& look = look_of(methods[m]);
    const std::string id = std::to_string(m);
    text += block_for_gnuplot("line" + id, marks);
    plot += (plot.empty() ? "plot $line" : ", $line") + id +
            " using 1:2 with linespoints lw 1.4 pt " + std::to_string(look.mark) +
            " ps 1.8 lc rgb '" + look.colour + "' title " + for_gnuplot(title_of(methods[m]));
  }
  text += "set logscale xy\n" + range("x", time.low(), time.high()) +
          range("y", error.low(), error.high()) + plain_log_tics("x", time.low(), time.high()) +
          plain_log_tics("y", error.low(), error.high()) +
          "set xlabel 'time of a tick, us, one thread' tc rgb '#222222'\n"
          "set ylabel 'error of the force, %' tc rgb '#222222'\n"
          "set title 'Speed and error of the force, from the same runs: better is further down and "
          "to the left' font 'sans,14' tc rgb '#111111'\n"
          "set key outside right top Left reverse invert samplen 3 spacing 1.5 font 'sans,11' tc "
          "rgb '#111111'\n";
  return draw_chart(text + plot + "\n", 1200, 640, file_png);
}

}  // namespace sulcus::lab
