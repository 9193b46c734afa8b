#include "app/report/comparison_page.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>

#include <nlohmann/json.hpp>

#include "app/report/measures_table.hpp"
#include "app/report/page/curves.hpp"
#include "app/report/page/page_html.hpp"
#include "app/report/page/web_files.hpp"
#include "app/report/page_attempt.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/user_text.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/recording/recording_reader.hpp"

namespace sulcus {

namespace {

using Attempts = std::vector<ComparedAttempt>;

const AssessedMeasure* found_in(const Assessment& assessment, std::string_view name) {
  const auto found = std::ranges::find(assessment.measures, name, &AssessedMeasure::name);
  return found == assessment.measures.end() ? nullptr : &*found;
}

/// How far a measure is from being met; 0 where it is.
double missed_by(const AssessedMeasure& measure) {
  if (!measure.limit) return 0.0;
  const MeasureLimit& limit = *measure.limit;
  return std::max({0.0, limit.low ? *limit.low - measure.value : 0.0,
                   limit.high ? measure.value - *limit.high : 0.0});
}

/// The attempt that is nearest to what a measure is to be; none where several are.
std::optional<std::size_t> best_of(const Attempts& attempts, std::string_view name) {
  std::optional<std::size_t> best;
  double least = 0.0;
  bool alone = false;
  for (std::size_t n = 0; n < attempts.size(); ++n) {
    const AssessedMeasure* const measure = found_in(attempts[n].assessment, name);
    if (!measure || !measure->limit) return {};
    const double missed = missed_by(*measure);
    if (!best || missed < least) {
      best = n;
      least = missed;
      alone = true;
    } else if (missed == least) {
      alone = false;
    }
  }
  return alone ? best : std::nullopt;
}

std::string number_of(std::size_t n) { return std::to_string(n + 1); }

/// Of the greatest; none where several are.
template <class Value>
std::optional<std::size_t> of_greatest(const std::vector<Value>& values) {
  const auto greatest = std::ranges::max_element(values);
  if (std::ranges::count(values, *greatest) > 1) return {};
  return static_cast<std::size_t>(greatest - values.begin());
}

/// How many measures each attempt is nearest to what they are to be in, of those of a mark.
std::vector<int> nearest_counts(const Attempts& attempts, double mark) {
  Attempts of_mark;
  std::vector<std::size_t> numbers;
  for (std::size_t n = 0; n < attempts.size(); ++n) {
    if (attempts[n].assessment.mark != mark) continue;
    of_mark.push_back(attempts[n]);
    numbers.push_back(n);
  }
  std::vector<int> counts(attempts.size());
  for (const AssessedMeasure& measure : of_mark.front().assessment.measures) {
    if (const auto best = best_of(of_mark, measure.name)) ++counts[numbers[*best]];
  }
  return counts;
}

/// In a sentence: which is better, and by what. Of equal marks, by how near they come.
std::string verdict(const Attempts& attempts) {
  std::vector<double> marks;
  for (const ComparedAttempt& attempt : attempts) {
    if (!attempt.assessment.mark) return "<p>Not all of them have a mark.</p>\n";
    marks.push_back(*attempt.assessment.mark);
  }
  std::ostringstream html;
  html << "<p class=\"mark\">";
  const std::vector<int> nearest = nearest_counts(attempts, std::ranges::max(marks));
  if (const auto best = of_greatest(marks)) {
    html << "Attempt " << number_of(*best) << " is better: ";
  } else if (const auto nearer = of_greatest(nearest)) {
    html << "Attempt " << number_of(*nearer) << " is better, nearer than its equals in "
         << nearest[*nearer] << (nearest[*nearer] == 1 ? " measure: " : " measures: ");
  } else {
    html << "No one is better than all others: ";
  }
  for (std::size_t n = 0; n < attempts.size(); ++n) {
    html << (n == 0 ? "" : ", ") << "attempt " << number_of(n)
         << formatted(" has %.0f of 100", marks[n]);
  }
  html << "</p>\n";
  return html.str();
}

void add_cell(const AssessedMeasure* measure, std::size_t attempt, bool best, std::ostream& html) {
  html << (best ? "<td class=\"number best\">" : "<td class=\"number\">");
  if (measure) {
    html << plain_number(measure->value) << ' ' << for_html(unit_title(measure->unit));
    if (measure->limit) {
      html << (measure->met() ? " <span class=\"met\">met</span>"
                              : " <span class=\"not-met\">not met</span>");
    }
    if (!measure->met()) {
      html << " <button data-measure=\"" << for_html(measure->name) << "\" data-attempt=\""
           << attempt << "\">show</button>";
    }
  } else {
    html << "not there";
  }
  html << "</td>";
}

void add_row(const Attempts& attempts, std::string_view name, std::ostream& html) {
  const AssessedMeasure* any = nullptr;
  for (const ComparedAttempt& attempt : attempts) {
    if (const AssessedMeasure* const found = found_in(attempt.assessment, name)) any = found;
  }
  if (!any) return;
  html << (any->limit ? "<tr>" : "<tr class=\"aside\">") << "<th>" << for_html(measure_title(*any))
       << "</th><td>" << (any->limit ? for_html(limit_title(*any->limit)) : "") << "</td>";
  const std::optional<std::size_t> best = best_of(attempts, name);
  for (std::size_t n = 0; n < attempts.size(); ++n) {
    add_cell(found_in(attempts[n].assessment, name), n, best == n, html);
  }
  html << "</tr>\n";
}

/// What is to be met first, then what is only told.
std::string measures_table(const Attempts& attempts) {
  std::ostringstream html;
  html << "<div class=\"wide\"><table>\n<thead><tr><th>Measure</th><th>To be</th>";
  for (std::size_t n = 0; n < attempts.size(); ++n) {
    html << "<th>Attempt " << number_of(n) << "<br>" << for_html(attempts[n].recording) << "</th>";
  }
  html << "</tr></thead>\n";
  const auto limited = [&](std::string_view name) {
    return std::ranges::any_of(attempts, [&](const ComparedAttempt& attempt) {
      const AssessedMeasure* const measure = found_in(attempt.assessment, name);
      return measure && measure->limit;
    });
  };
  for (const bool first : {true, false}) {
    for (const MeasureName& measure : measure_names()) {
      if (limited(measure.name) == first) add_row(attempts, measure.name, html);
    }
  }
  html << "</table></div>\n";
  return html.str();
}

struct AttemptCurves {
  std::vector<double> times_s;
  std::vector<Curve> curves;
};

AttemptCurves curves_of(const RecordingReader& reader) {
  AttemptCurves all;
  Curve force{.name = "Force", .unit = "N", .colour = "#2062b2"};
  Curve cut{.name = "Cut", .unit = "mm\xC2\xB3", .colour = "#8a6d1c"};
  double cut_mm3 = 0.0;
  const double voxel_mm3 = reader.grid().voxel_volume_m3() * 1e9;
  const std::vector<TickRecord> rows = reader.ticks();
  all.times_s.reserve(rows.size());
  force.values.reserve(rows.size());
  cut.values.reserve(rows.size());
  for (const TickRecord& row : rows) {
    all.times_s.push_back(row.time_s);
    force.values.push_back(std::hypot(row.force_N[0], row.force_N[1], row.force_N[2]));
    cut.values.push_back(cut_mm3 += static_cast<double>(row.removed) * voxel_mm3);
  }
  all.curves = {std::move(force), std::move(cut)};
  return all;
}

/// Each on axes that all attempts share.
std::string curves_side_by_side(const std::vector<AttemptCurves>& attempts) {
  std::ostringstream html;
  for (std::size_t kind = 0; kind < attempts.front().curves.size(); ++kind) {
    CurveAxes axes = axes_of(attempts.front().curves[kind], attempts.front().times_s);
    for (const AttemptCurves& attempt : attempts) {
      axes = joined(axes, axes_of(attempt.curves[kind], attempt.times_s));
    }
    html << "<div class=\"two\">\n";
    for (std::size_t n = 0; n < attempts.size(); ++n) {
      Curve curve = attempts[n].curves[kind];
      curve.name = "Attempt " + number_of(n) + ": " + curve.name;
      html << "<div data-attempt=\"" << n << "\">" << curve_figure(curve, attempts[n].times_s, axes)
           << "</div>\n";
    }
    html << "</div>\n";
  }
  return html.str();
}

}  // namespace

void write_comparison_page(const Attempts& attempts, const std::string& file) {
  const std::string three = three_js();
  nlohmann::ordered_json shown = nlohmann::ordered_json::array();
  std::vector<AttemptCurves> curves;
  for (const ComparedAttempt& attempt : attempts) {
    const RecordingReader reader(attempt.recording);
    shown.push_back(page_attempt(reader, attempt.recording, &attempt.assessment, attempt.settings,
                                 kPageMoments / attempts.size()));
    curves.push_back(curves_of(reader));
  }
  const std::string title = "Comparison of " + std::to_string(attempts.size()) + " attempts";
  std::ostringstream page;
  page << "<h1>" << title << "</h1>\n" << verdict(attempts) << viewer_html();
  page << "<h2>Assessment</h2>\n<p>Green: nearer than the others to what it is to be.</p>\n"
       << measures_table(attempts) << "<h2>Curves</h2>\n"
       << curves_side_by_side(curves);
  write_whole_file(file, page_html(title, page.str(), {{"attempts", shown}}, three));
}

}  // namespace sulcus
