#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "engine/core/user_text.hpp"
#include "tools/sulcus_lab/stability/chart_text.hpp"
#include "tools/sulcus_lab/stability/stability_charts.hpp"

namespace sulcus::lab {

namespace {

using namespace chart_text;  // NOLINT(google-build-using-namespace): the words of these pictures

/// The step of three to five tics up to a value: 1, 2 or 5 times a power of ten.
double coarse_step(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value / 5.0)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= value / 5.0) return step * power;
  }
  return 10.0 * power;
}

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
      points += point_for_gnuplot(dt * static_cast<double>(at - values.begin()), *at);
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
    text +=
        block_for_gnuplot("force" + std::to_string(t), thinned(p.traces[t].force_N, dt, kParts)) +
        block_for_gnuplot("depth" + std::to_string(t), thinned(p.traces[t].depth_mm, dt, kParts));
  }
  return text;
}

/// The picture's title, and under it the key that small frames share.
std::string picture_head(const ForcePicture& p) {
  std::string text = "set multiplot\nset key off\nset label 1 " +
                     for_gnuplot("Force over time: " + spaced_name(p.traces[0].case_name)) +
                     " at screen " + number_for_gnuplot(p.across(70)) + "," +
                     number_for_gnuplot(p.up(26)) + " left font 'sans,14' tc rgb '#111111'\n";
  if (!p.with_key()) return text;
  std::string entries;
  for (const ContactMethod method : p.methods) {
    entries += std::string(entries.empty() ? "" : ", ") + "NaN with lines lw " +
               number_for_gnuplot(look_of(method).width) + " lc rgb '" + look_of(method).colour +
               "' title " + for_gnuplot(title_of(method));
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
                      " using 1:2" + style_of(p, trace) + " title " + for_gnuplot(title);
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
  return "set label 2 " + for_gnuplot(title) + " at screen " + number_for_gnuplot(p.across(left)) +
         "," + number_for_gnuplot(p.up(top - 12)) + " left font 'sans,12' tc rgb '#111111'\n" +
         (gone.empty()
              ? "unset label 3\n"
              : "set label 3 " + for_gnuplot(gone) + " at screen " +
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

}  // namespace sulcus::lab
