#include "app/report/measures_table.hpp"

#include <algorithm>
#include <sstream>

#include "app/report/page/curves.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/user_text.hpp"

namespace sulcus {

std::string measure_title(const AssessedMeasure& measure) {
  std::string title = measure.name;
  if (!measure.unit.empty() && title.ends_with("_" + measure.unit)) {
    title.resize(title.size() - measure.unit.size() - 1);
  }
  std::ranges::replace(title, '_', ' ');
  if (!title.empty() && title[0] >= 'a' && title[0] <= 'z') {
    title[0] = static_cast<char>(title[0] - 'a' + 'A');
  }
  return title;
}

std::string unit_title(const std::string& unit) {
  if (unit == "mm2") return "mm\xC2\xB2";
  if (unit == "mm3") return "mm\xC2\xB3";
  if (unit == "deg") return "\xC2\xB0";
  if (unit == "um") return "\xC2\xB5m";
  return unit;
}

std::string limit_title(const MeasureLimit& limit) {
  if (limit.low && limit.high) return formatted("%g to %g", *limit.low, *limit.high);
  return limit.low ? formatted("at least %g", *limit.low) : formatted("at most %g", *limit.high);
}

std::string assessment_table(const Assessment& assessment) {
  std::ostringstream html;
  if (assessment.mark) {
    html << "<p class=\"mark\">" << formatted("%.0f of 100", *assessment.mark) << "</p>\n";
  }
  html << "<div class=\"wide\"><table>\n<thead><tr><th>Measure</th><th>Found</th><th>To be</th>"
          "<th></th><th>Came about</th></tr></thead>\n";
  for (const AssessedMeasure& measure : assessment.measures) {
    html << (measure.limit ? "<tr>" : "<tr class=\"aside\">") << "<th>"
         << for_html(measure_title(measure)) << "</th><td class=\"number\">"
         << plain_number(measure.value) << ' ' << for_html(unit_title(measure.unit)) << "</td><td>"
         << (measure.limit ? for_html(limit_title(*measure.limit)) : "") << "</td>";
    if (!measure.limit) {
      html << "<td></td>";
    } else {
      html << (measure.met() ? "<td class=\"met\">met" : "<td class=\"not-met\">not met")
           << "</td>";
    }
    html << "<td>" << (measure.time_s ? formatted("%.2f s", *measure.time_s) : "");
    if (!measure.met()) {
      html << " <button data-measure=\"" << for_html(measure.name)
           << "\" data-attempt=\"0\">show</button>";
    }
    html << "</td></tr>\n";
  }
  for (const std::string& name : assessment.not_measured) {
    html << "<tr><th>" << for_html(name)
         << "</th><td colspan=\"4\">there is no such thing to be measured</td></tr>\n";
  }
  html << "</table></div>\n";
  return html.str();
}

}  // namespace sulcus
