#include "tools/sulcus_lab/stability/force_traces.hpp"

#include <algorithm>
#include <iterator>

#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

namespace {

/// The ticks that are written: of each of 900 parts those with the least and the largest force and
/// depth, so that a buzz keeps its height; and the last.
std::vector<std::size_t> drawn_ticks(const ForceTrace& trace) {
  constexpr std::size_t kParts = 900;  // about what a frame has pixels
  const std::size_t count = std::max(trace.force_N.size(), trace.depth_mm.size());
  const std::size_t each = std::max<std::size_t>(1, count / kParts);
  std::vector<std::size_t> ticks;
  for (const std::vector<float>* values : {&trace.force_N, &trace.depth_mm}) {
    for (std::size_t begin = 0; begin < values->size(); begin += each) {
      const auto first = values->begin() + static_cast<std::ptrdiff_t>(begin);
      const auto last =
          values->begin() + static_cast<std::ptrdiff_t>(std::min(begin + each, values->size()));
      const auto [low, high] = std::minmax_element(first, last);
      for (const auto at : {low, high}) {
        ticks.push_back(static_cast<std::size_t>(at - values->begin()));
      }
    }
  }
  if (count > 0) ticks.push_back(count - 1);
  std::ranges::sort(ticks);
  ticks.erase(std::unique(ticks.begin(), ticks.end()), ticks.end());
  return ticks;
}

std::string cell_of(const std::vector<float>& values, std::size_t tick) {
  return tick < values.size() ? number_cell("%.6g", static_cast<double>(values[tick])) : "";
}

}  // namespace

void write_force_traces(std::span<const ForceTrace> traces, const std::string& file_csv) {
  CsvFile csv(file_csv, "run,method,label,time_s,force_N,depth_mm");
  for (std::size_t run = 0; run < traces.size(); ++run) {
    const ForceTrace& trace = traces[run];
    if (run > 0) csv.write("");  // a block each
    const std::string key =
        std::to_string(run) + "," + name_of(trace.method) + "," + text_cell(trace.label) + ",";
    const std::vector<std::size_t> ticks = drawn_ticks(trace);
    for (const std::size_t tick : ticks) {
      csv.write(key + number_cell("%.9g", trace.dt_s * static_cast<double>(tick)) + "," +
                cell_of(trace.force_N, tick) + "," + cell_of(trace.depth_mm, tick));
    }
    if (ticks.empty()) csv.write(key + "0,,");
  }
}

}  // namespace sulcus::lab
