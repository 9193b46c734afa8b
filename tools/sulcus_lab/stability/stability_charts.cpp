#include "tools/sulcus_lab/stability/stability_charts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "tools/sulcus_lab/chart.hpp"

namespace sulcus::lab {

namespace {

// Okabe and Ito's, told apart by every kind of colour vision; ours in the strong blue.
struct Look {
  const char* colour;
  double width;
  int mark;
};
constexpr Look kMethodLooks[] = {{"#0072b2", 3.0, 7},  {"#d55e00", 2.2, 5},  {"#009e73", 1.8, 9},
                                 {"#555555", 1.8, 13}, {"#e69f00", 1.8, 11}, {"#cc79a7", 1.8, 3}};
static_assert(std::size(kMethodLooks) == kContactMethodNames.size());
constexpr const char* kLabelColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00"};
constexpr const char* kDashes[] = {"solid", "'-'", "'.'", "'_.'", "'_ '"};

constexpr const char* kFrame =
    "set border 3 lc rgb '#666666'\nset tics nomirror tc rgb '#222222'\n"
    "set grid xtics ytics lc rgb '#d8d8d8' lw 1\n";

const Look& look_of(ContactMethod method) { return kMethodLooks[static_cast<std::size_t>(method)]; }
std::string title_of(ContactMethod method) {
  return spaced_name(std::string(kContactMethodNames[static_cast<std::size_t>(method)]));
}

std::string point(double x, double y) {
  return number_for_gnuplot(x) + " " + number_for_gnuplot(y) + "\n";
}
/// `$name << EOD` with the points.
std::string block(const std::string& name, const std::string& points) {
  return "$" + name + " << EOD\n" + points + "EOD\n";
}
std::string range(const char* axis, double low, double high) {
  return std::string("set ") + axis + "range [" + number_for_gnuplot(low) + ":" +
         number_for_gnuplot(high) + "]\n";
}
std::string margins(double left, double right, double bottom, double top) {
  return "set lmargin at screen " + number_for_gnuplot(left) + "\nset rmargin at screen " +
         number_for_gnuplot(right) + "\nset bmargin at screen " + number_for_gnuplot(bottom) +
         "\nset tmargin at screen " + number_for_gnuplot(top) + "\n";
}

template <class T>
std::size_t place_in(std::vector<T>& seen, const T& value) {
  const auto at = std::find(seen.begin(), seen.end(), value);
  if (at != seen.end()) return static_cast<std::size_t>(at - seen.begin());
  seen.push_back(value);
  return seen.size() - 1;
}

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

/// The step of three to five tics up to a value: 1, 2 or 5 times a power of ten.
double coarse_step(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value / 5.0)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= value / 5.0) return step * power;
  }
  return 10.0 * power;
}

/// A key of its own that runs across the picture at that height; `entries` as gnuplot plots them.
std::string key_across(double left, double right, double top, const std::string& entries) {
  return margins(left, right, 0.0, top) + "set key at screen " + number_for_gnuplot(left) + "," +
         number_for_gnuplot(top) +
         " left top Left reverse horizontal samplen 4 width 2 font 'sans,11' tc rgb '#111111'\n"
         "unset border\nunset tics\nunset xlabel\nunset ylabel\nset xrange [0:1]\nset yrange "
         "[0:1]\nplot " +
         entries + "\nset key off\n" + kFrame + "set xtics nomirror\nset ytics nomirror\n";
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

// Force over time.

/// Least and largest of each of that many parts, in their order, so that a buzz keeps its height.
std::string thinned(const std::vector<float>& values, double dt, std::size_t parts) {
  std::string points;
  const std::size_t each = std::max<std::size_t>(1, values.size() / parts);
  for (std::size_t begin = 0; begin < values.size(); begin += each) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last =
        values.begin() + static_cast<std::ptrdiff_t>(std::min(begin + each, values.size()));
    auto [low, high] = std::minmax_element(first, last);
    if (high < low) std::swap(low, high);
    for (const auto at : {low, high}) {
      points += point(dt * static_cast<double>(at - values.begin()), *at);
      if (low == high) break;
    }
  }
  return points;
}

struct Extent {
  double low = 0.0, high = 0.0;
};
Extent extent_of(const std::vector<float>& values) {
  Extent extent;
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    extent.low = std::min<double>(extent.low, value);
    extent.high = std::max<double>(extent.high, value);
  }
  return extent;
}

/// What is drawn of the forces: all, but where a trace is over twice as large as the middle one, up
/// to that.
Extent shown_of(std::span<const ForceTrace> traces) {
  std::vector<double> peaks;
  Extent all;
  for (const ForceTrace& trace : traces) {
    const Extent extent = extent_of(trace.force_N);
    all = {std::min(all.low, extent.low), std::max(all.high, extent.high)};
    peaks.push_back(std::max(extent.high, -extent.low));
  }
  std::sort(peaks.begin(), peaks.end());
  if (peaks.back() == 0.0) return {0.0, 1.0};
  double most = 2.0 * peaks[peaks.size() / 2];
  if (most == 0.0) most = peaks.back();
  const Extent shown{std::max(all.low, -most), std::min(all.high, most)};
  const double room = 0.06 * (shown.high - shown.low);
  return {shown.low - (shown.low < 0.0 ? room : 0.0), shown.high + room};
}

std::string newtons(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g N", value);
  return text;
}

/// Which traces stand together in a frame.
struct Frame {
  std::string title;
  std::vector<std::size_t> traces;
};

std::vector<Frame> frames_of(std::span<const ForceTrace> traces) {
  constexpr std::size_t kTogether = 5;
  std::vector<std::string> names;
  std::vector<Frame> frames;
  if (traces.size() <= kTogether) {
    frames.resize(1);
    for (std::size_t t = 0; t < traces.size(); ++t) frames[0].traces.push_back(t);
    return frames;
  }
  const bool by_label = std::any_of(traces.begin(), traces.end(), [&](const ForceTrace& trace) {
    return trace.label != traces[0].label;
  });
  for (std::size_t t = 0; t < traces.size(); ++t) {
    const std::string name = by_label ? traces[t].label : title_of(traces[t].method);
    const std::size_t frame = place_in(names, name);
    if (frame == frames.size()) frames.push_back({name, {}});
    frames[frame].traces.push_back(t);
  }
  return frames;
}

/// What the frames of a picture share: what is drawn, how far the axes go, and a grid of frames,
/// the depth under the force in each. Sizes in pixels, heights from the top.
struct ForcePicture {
  std::span<const ForceTrace> traces;
  std::vector<Frame> frames;
  std::vector<ContactMethod> methods;  // in their order
  std::vector<std::string> labels;
  double seconds = 1e-3, deepest_mm = 0.0, shallowest_mm = 0.0;
  Extent shown_N;
  bool with_depth = false;

  bool many() const { return frames.size() > 1; }
  bool in_ms() const { return seconds < 0.5; }
  double per_second() const { return in_ms() ? 1e3 : 1.0; }
  /// Small frames share one key, unless each is of one method and says so.
  bool with_key() const { return many() && methods.size() > 1 && labels.size() > 1; }

  static constexpr int kWidth = 1400;
  std::size_t columns() const { return frames.size() == 1 ? 1 : frames.size() <= 4 ? 2 : 3; }
  std::size_t rows() const { return (frames.size() + columns() - 1) / columns(); }
  int head() const { return with_key() ? 78 : many() ? 48 : 64; }
  int depth_height() const { return many() ? 110 : 180; }
  int row_height() const { return (many() ? 300 : 420) + (with_depth ? depth_height() : 0); }
  int height() const { return head() + static_cast<int>(rows()) * row_height(); }
  double across(double pixels) const { return pixels / kWidth; }
  double up(double pixels_from_top) const { return 1.0 - pixels_from_top / height(); }
};

ForcePicture picture_of(std::span<const ForceTrace> traces) {
  ForcePicture p;
  p.traces = traces;
  p.frames = frames_of(traces);
  for (const ForceTrace& trace : traces) {
    place_in(p.methods, trace.method);
    place_in(p.labels, trace.label);
    p.seconds = std::max(p.seconds, trace.dt_s * static_cast<double>(trace.force_N.size()));
    const Extent depth = extent_of(trace.depth_mm);
    p.deepest_mm = std::max(p.deepest_mm, depth.high);
    p.shallowest_mm = std::min(p.shallowest_mm, depth.low);
    p.with_depth = p.with_depth || !trace.depth_mm.empty();
  }
  std::sort(p.methods.begin(), p.methods.end());
  p.shown_N = shown_of(traces);
  return p;
}

/// What a trace is called where its frame does not say it.
std::string name_of(const ForcePicture& p, const ForceTrace& trace) {
  std::string name;
  if (p.methods.size() > 1 || p.labels.size() == 1) name = title_of(trace.method);
  if (p.labels.size() > 1 && !p.many()) name += (name.empty() ? "" : ", ") + trace.label;
  return name;
}

std::string style_of(const ForcePicture& p, const ForceTrace& trace) {
  const auto label = static_cast<std::size_t>(
      std::find(p.labels.begin(), p.labels.end(), trace.label) - p.labels.begin());
  const Look& look = look_of(trace.method);
  const bool by_method = p.methods.size() > 1;
  return std::string(" with lines lw ") + number_for_gnuplot(by_method ? look.width : 2.2) +
         " lc rgb '" +
         (by_method || p.many() ? look.colour : kLabelColours[label % std::size(kLabelColours)]) +
         "' dt " + (by_method && !p.many() ? kDashes[label % std::size(kDashes)] : "solid");
}

/// Of each trace $force and $depth with its number.
std::string force_blocks(const ForcePicture& p) {
  constexpr std::size_t kParts = 900;  // about what the frame has pixels
  std::string text;
  for (std::size_t t = 0; t < p.traces.size(); ++t) {
    const double dt = p.traces[t].dt_s * p.per_second();
    text += block("force" + std::to_string(t), thinned(p.traces[t].force_N, dt, kParts)) +
            block("depth" + std::to_string(t), thinned(p.traces[t].depth_mm, dt, kParts));
  }
  return text;
}

/// The picture's title, and under it the key that small frames share.
std::string picture_head(const ForcePicture& p) {
  std::string text = "set multiplot\nset key off\nset label 1 " +
                     quoted_for_gnuplot("Force over time: " + spaced_name(p.traces[0].case_name)) +
                     " at screen " + number_for_gnuplot(p.across(70)) + "," +
                     number_for_gnuplot(p.up(26)) + " left font 'sans,14' tc rgb '#111111'\n";
  if (!p.with_key()) return text;
  std::string entries;
  for (const ContactMethod method : p.methods) {
    entries += std::string(entries.empty() ? "" : ", ") + "NaN with lines lw " +
               number_for_gnuplot(look_of(method).width) + " lc rgb '" + look_of(method).colour +
               "' title " + quoted_for_gnuplot(title_of(method));
  }
  return text + key_across(p.across(70), p.across(ForcePicture::kWidth - 30), p.up(42), entries) +
         "unset label 1\n";
}

/// What gnuplot is to plot in a frame; empty: nothing.
struct FramePlots {
  std::string forces, depths;
  std::string gone;  // which traces leave the frame, and how far
};

FramePlots plots_of(const ForcePicture& p, const Frame& frame) {
  FramePlots plots;
  std::vector<std::size_t> order = frame.traces;
  // The default method last, on top.
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return p.traces[a].method > p.traces[b].method;
  });
  for (const std::size_t t : order) {
    const ForceTrace& trace = p.traces[t];
    const Extent extent = extent_of(trace.force_N);
    std::string title = name_of(p, trace);
    std::string leaves;
    if (extent.high > p.shown_N.high) leaves = "up to " + newtons(extent.high);
    if (extent.low < p.shown_N.low) {
      leaves += (leaves.empty() ? "to " : ", to ") + newtons(extent.low);
    }
    if (!leaves.empty()) {
      plots.gone +=
          (plots.gone.empty() ? "" : "; ") + (title.empty() ? trace.label : title) + " " + leaves;
      title += " (" + leaves + ")";
    }
    if (!trace.force_N.empty()) {
      plots.forces += (plots.forces.empty() ? "plot $force" : ", $force") + std::to_string(t) +
                      " using 1:2" + style_of(p, trace) + " title " + quoted_for_gnuplot(title);
    }
    if (!trace.depth_mm.empty()) {
      plots.depths += (plots.depths.empty() ? "plot $depth" : ", $depth") + std::to_string(t) +
                      " using 1:2" + style_of(p, trace) + " notitle";
    }
  }
  return plots;
}

/// The title of a small frame, and on the right what leaves it.
std::string frame_head(const ForcePicture& p, const std::string& title, const std::string& gone,
                       double left, double right, double top) {
  return "set label 2 " + quoted_for_gnuplot(title) + " at screen " +
         number_for_gnuplot(p.across(left)) + "," + number_for_gnuplot(p.up(top - 12)) +
         " left font 'sans,12' tc rgb '#111111'\n" +
         (gone.empty()
              ? "unset label 3\n"
              : "set label 3 " + quoted_for_gnuplot(gone) + " at screen " +
                    number_for_gnuplot(p.across(right)) + "," + number_for_gnuplot(p.up(top - 11)) +
                    " right font 'sans,9' tc rgb '#444444' front\n");
}

/// The key of a frame that has the picture to itself, beside it.
std::string key_beside(const ForcePicture& p, double right, double top) {
  return "set key at screen " + number_for_gnuplot(p.across(right + 20)) + "," +
         number_for_gnuplot(p.up(top)) +
         " left top Left reverse samplen 3 spacing 1.5 font 'sans,11' tc rgb '#111111'\n";
}

std::string frame_text(const ForcePicture& p, std::size_t f) {
  const bool many = p.many();
  const double tile =
      static_cast<double>(ForcePicture::kWidth - 30) / static_cast<double>(p.columns());
  const double left = 70 + tile * static_cast<double>(f % p.columns());
  const double right = left + tile - 80 - (many ? 0 : 330);
  const double top =
      p.head() + p.row_height() * static_cast<int>(f / p.columns()) + (many ? 26 : 0);
  const double bottom =
      top + p.row_height() - (many ? 26 : 0) - 66 - (p.with_depth ? p.depth_height() : 0);
  const std::string time_label = std::string("set format x '%g'\nset xlabel 'time, ") +
                                 (p.in_ms() ? "ms" : "s") + "' offset 0,0.4 tc rgb '#222222'\n";
  const FramePlots plots = plots_of(p, p.frames[f]);
  std::string text = margins(p.across(left), p.across(right), p.up(bottom), p.up(top));
  text += many ? "set key off\n" + frame_head(p, p.frames[f].title, plots.gone, left, right, top)
               : key_beside(p, right, top);
  text += range("y", p.shown_N.low, p.shown_N.high) +
          "set ytics autofreq\nset ylabel 'force, N' offset 1,0 tc rgb '#222222'\n" +
          (plots.depths.empty() ? time_label : std::string("set format x ''\nunset xlabel\n"));
  // A frame with no force is drawn empty, so that its depth keeps its place.
  text += (plots.forces.empty() ? std::string("plot NaN notitle") : plots.forces) +
          "\nunset label 1\nunset label 2\nunset label 3\n";
  if (plots.depths.empty()) return text;
  const double depth_top = bottom + 14, depth_bottom = bottom + p.depth_height();
  const double span_mm = std::max(p.deepest_mm - p.shallowest_mm, 1e-3), room = 0.08 * span_mm;
  return text + margins(p.across(left), p.across(right), p.up(depth_bottom), p.up(depth_top)) +
         "set key off\n" +
         // Downwards, as the tool goes.
         range("y", p.deepest_mm + room, p.shallowest_mm - (p.shallowest_mm < 0.0 ? room : 0.0)) +
         "set ytics " + number_for_gnuplot(coarse_step(span_mm)) +
         "\nset ylabel 'depth, mm' offset 1,0 tc rgb '#222222'\n" + time_label + plots.depths +
         "\n";
}

}  // namespace

bool draw_force_traces(std::span<const ForceTrace> traces, const std::string& file_png) {
  if (traces.empty()) return false;
  const ForcePicture p = picture_of(traces);
  std::string text =
      kFrame + force_blocks(p) + picture_head(p) + range("x", 0.0, p.seconds * p.per_second());
  for (std::size_t f = 0; f < p.frames.size(); ++f) text += frame_text(p, f);
  return draw_chart(text + "unset multiplot\n", ForcePicture::kWidth, p.height(), file_png);
}

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
      hold += point(p.contacts, p.felt_hold_N_per_mm);
      buzz += point(p.contacts, p.felt_buzz_N_per_mm);
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
    text += block("hold" + id, hold) + block("buzz" + id, buzz) + block("fill" + id, fill);
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
            quoted_for_gnuplot(titles[m]) + " at screen " + number_for_gnuplot(across(left)) + "," +
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
      inside += point(damping, y);
      if (y != largest) edge += point(damping, y);
    }
    const auto method =
        std::find(kContactMethodNames.begin(), kContactMethodNames.end(), labels[l]);
    Look look{kLabelColours[l % std::size(kLabelColours)], 2.2, 5 + 2 * static_cast<int>(l % 5)};
    if (method != kContactMethodNames.end()) {
      look = kMethodLooks[method - kContactMethodNames.begin()];
    }
    const std::string id = std::to_string(l);
    const std::string colour = std::string(" lc rgb '") + look.colour + "'";
    text += block("line" + id, inside) + block("edge" + id, edge);
    plot +=
        (plot.empty() ? "plot $line" : ", $line") + id + " using 1:2 with linespoints lw " +
        number_for_gnuplot(look.width) + " pt " + std::to_string(look.mark) + " ps 1.2 dt " +
        (l < std::size(kLabelColours) || method != kContactMethodNames.end() ? "solid" : "'-'") +
        colour + " title " + quoted_for_gnuplot(spaced_name(labels[l]));
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
    for (const auto& [x, y] : line) marks += point(x, y);
    const Look& look = look_of(methods[m]);
    const std::string id = std::to_string(m);
    text += block("line" + id, marks);
    plot += (plot.empty() ? "plot $line" : ", $line") + id +
            " using 1:2 with linespoints lw 1.4 pt " + std::to_string(look.mark) +
            " ps 1.8 lc rgb '" + look.colour + "' title " +
            quoted_for_gnuplot(title_of(methods[m]));
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
