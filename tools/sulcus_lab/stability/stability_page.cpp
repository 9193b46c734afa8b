#include "tools/sulcus_lab/stability/stability_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string_view>
#include <utility>

#include "engine/core/user_text.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/stability/cases/case_texts.hpp"

namespace sulcus::lab {

namespace {

constexpr std::size_t kMethodCount = kContactMethodNames.size();

/// What each method is, in the order of their names.
constexpr std::array<std::string_view, kMethodCount> kMethodTexts{
    "ours, and the default: contact forces weighted smoothly with depth, behind a virtual "
    "coupling. The tool hangs on the device by a spring, and comes to rest where that spring and "
    "the contact balance; the hand feels the spring.",
    "the same contact forces without the coupling: the tool is exactly where the device is.",
    "the paper's scaling: the sum of the contact forces divided by the number of voxels in "
    "contact; the tool follows the device.",
    "the plain penalty: every voxel in contact pushes with its full stiffness; the tool follows "
    "the device.",
    "the rule of McNeely and others (1999): the full sum below ten contacts, above that divided "
    "by a tenth of their number; the tool follows the device.",
    "one point instead of a burr, and a proxy of it that stays on the surface, as programs built "
    "on CHAI3D do; a spring pulls the device to the proxy.",
};

constexpr std::string_view kStyle = R"(
:root { color-scheme: light; }
body { font: 16px/1.5 "DejaVu Sans", Verdana, Arial, sans-serif; color: #1a1a1a; background: #fff;
  max-width: 1120px; margin: 0 auto; padding: 1.5em; }
h1 { font-size: 1.7em; line-height: 1.2; } h2 { font-size: 1.3em; margin: 2.2em 0 .5em;
  border-bottom: 2px solid #0072b2; } h3 { font-size: 1.1em; margin: 2.4em 0 .4em; }
p, dd { max-width: 46em; } dt { font-weight: bold; } dd { margin: 0 0 .5em 1.2em; }
a { color: #005a8c; } img { max-width: 100%; height: auto; border: 1px solid #ddd; }
figure { margin: 1em 0; } figcaption { font-size: .85em; color: #444; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .8em; line-height: 1.35; margin: .8em 0; }
caption { text-align: left; color: #444; padding-bottom: .3em; }
th, td { border: 1px solid #bbb; padding: .3em .5em; text-align: left; vertical-align: top; }
tbody th { white-space: nowrap; } .matrix th { white-space: normal; }
thead th { background: #f0f0f0; } td.number { text-align: right; white-space: nowrap; }
.verdict { white-space: nowrap; font-weight: bold; }
td.pass { background: #e3f1e4; } td.fail { background: #fbe0d6; border-left: 4px solid #b03a00; }
td.reported { background: #eef3f8; } td.none { color: #666; }
.matrix td { min-width: 8em; } .matrix small { display: block; color: #333; }
@media print { body { font-size: 10pt; max-width: none; padding: 0; } a { color: inherit; }
  td { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  .wide { overflow: visible; } .matrix { font-size: 6.5pt; } .matrix td { min-width: 0; }
  tr, figure { break-inside: avoid; } h2, h3 { break-after: avoid; } thead { display: table-header-group; } }
)";

std::string tag(std::string_view name, std::string_view content, std::string_view attributes = "") {
  return "<" + std::string(name) + (attributes.empty() ? "" : " ") + std::string(attributes) + ">" +
         std::string(content) + "</" + std::string(name) + ">";
}

std::string paragraph(std::string_view text) { return tag("p", for_html(text)) + "\n"; }

std::string method_title(std::size_t method) {
  return spaced_name(std::string(kContactMethodNames[method]));
}

std::string number(double value) {
  if (std::isnan(value)) return "not a number";
  if (std::isinf(value)) return value > 0 ? "without end" : "minus without end";
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string with_unit(double value, const std::string& unit) {
  if (!std::isfinite(value)) return number(value);
  return number(value) + (unit.empty() || unit == "%" ? unit : " " + unit);
}

/// "at most 0.01 N", or nothing.
std::string limit_words(const StabilityRow& row, const std::string& unit) {
  if (!row.limit) return "";
  return (row.at_least ? "at least " : "at most ") + with_unit(*row.limit, unit);
}

/// How close to its limit, or how far past it, a row is: over 1 past it, and more is worse.
double badness(const StabilityRow& row) {
  if (std::isnan(row.value)) return std::numeric_limits<double>::infinity();
  const double over = row.at_least ? *row.limit : row.value;
  const double under = row.at_least ? row.value : *row.limit;
  if (under > 0.0) return over / under;
  // No ratio to a limit of 0, nor to what has the other sign.
  return row.pass() ? 0.0 : std::numeric_limits<double>::infinity();
}

using Rows = std::vector<const StabilityRow*>;

/// Of rows with limits the worst: failed before passed, and then the furthest; null: none has one.
const StabilityRow* worst_of(const Rows& rows) {
  const StabilityRow* worst = nullptr;
  for (const StabilityRow* row : rows) {
    if (!row->limit) continue;
    if (!worst ||
        std::pair(!row->pass(), badness(*row)) > std::pair(!worst->pass(), badness(*worst))) {
      worst = row;
    }
  }
  return worst;
}

enum class Verdict { kNotApplicable, kReported, kPass, kFail };

Verdict verdict_of(const Rows& rows) {
  if (rows.empty()) return Verdict::kNotApplicable;
  const StabilityRow* worst = worst_of(rows);
  if (!worst) return Verdict::kReported;
  return worst->pass() ? Verdict::kPass : Verdict::kFail;
}

struct VerdictLook {
  std::string_view css, words;
};
VerdictLook look_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kNotApplicable:
      return {"none", "not applicable"};
    case Verdict::kReported:
      return {"reported", "no limit"};
    case Verdict::kPass:
      return {"pass", "&#10003; pass"};
    case Verdict::kFail:
      return {"fail", "&#10007; FAIL"};
  }
  return {};
}

std::string css_class(std::string_view name) { return "class=\"" + std::string(name) + "\""; }

/// All rows of a case, those of each method apart.
struct CaseRows {
  std::string name;
  std::array<Rows, kMethodCount> of_methods;
  bool empty() const {
    return std::all_of(of_methods.begin(), of_methods.end(),
                       [](const Rows& rows) { return rows.empty(); });
  }
};

std::vector<CaseRows> sorted_by_case(std::span<const StabilityRow> rows) {
  std::vector<CaseRows> cases;
  for (const CaseText& text : case_texts()) cases.push_back({std::string(text.name), {}});
  for (const StabilityRow& row : rows) {
    auto at = std::find_if(cases.begin(), cases.end(),
                           [&](const CaseRows& c) { return c.name == row.case_name; });
    if (at == cases.end()) at = cases.insert(cases.end(), {row.case_name, {}});
    at->of_methods[static_cast<std::size_t>(row.method)].push_back(&row);
  }
  return cases;
}

/// Null for a case without a text.
const CaseText* text_of(const std::string& name) {
  const bool is_case =
      std::ranges::any_of(case_texts(), [&](const CaseText& text) { return text.name == name; });
  const auto texts = is_case ? case_texts() : other_texts();
  const auto at = std::find_if(texts.begin(), texts.end(),
                               [&](const CaseText& text) { return text.name == name; });
  return at == texts.end() ? nullptr : &*at;
}

std::string number_and_title(std::size_t number_of_case, const CaseRows& c) {
  const CaseText* text = text_of(c.name);
  return std::to_string(number_of_case) + ". " +
         for_html(text ? text->title : std::string_view(spaced_name(c.name)));
}

std::string matrix_cell(const Rows& rows) {
  const Verdict verdict = verdict_of(rows);
  const VerdictLook look = look_of(verdict);
  std::string content = tag("span", look.words, css_class("verdict"));
  if (const StabilityRow* worst = worst_of(rows)) {
    const QuantityWords words = quantity_words(worst->quantity);
    content += tag("small", for_html(words.words + " " + with_unit(worst->value, words.unit) +
                                     ", " + limit_words(*worst, words.unit)));
  }
  return tag("td", content, css_class(look.css));
}

std::string matrix(const std::vector<CaseRows>& cases) {
  std::string head = "<th scope=\"col\">case</th>";
  std::array<std::array<int, 4>, kMethodCount> counts{};
  for (std::size_t m = 0; m < kMethodCount; ++m) {
    head += tag("th", for_html(method_title(m)), "scope=\"col\"");
  }
  std::string body;
  for (std::size_t c = 0; c < cases.size(); ++c) {
    std::string line = tag(
        "th",
        tag("a", number_and_title(c + 1, cases[c]), "href=\"#" + for_html(cases[c].name) + "\""),
        "scope=\"row\"");
    if (cases[c].empty()) {
      line +=
          tag("td", "not run", "class=\"none\" colspan=\"" + std::to_string(kMethodCount) + "\"");
    } else {
      for (std::size_t m = 0; m < kMethodCount; ++m) {
        line += matrix_cell(cases[c].of_methods[m]);
        ++counts[m][static_cast<std::size_t>(verdict_of(cases[c].of_methods[m]))];
      }
    }
    body += tag("tr", line) + "\n";
  }
  std::string foot = "<th scope=\"row\">passed of those with a limit</th>";
  for (const auto& count : counts) {
    const int passed = count[static_cast<std::size_t>(Verdict::kPass)];
    const int failed = count[static_cast<std::size_t>(Verdict::kFail)];
    foot += tag("th", std::to_string(passed) + " of " + std::to_string(passed + failed));
  }
  return "<div class=\"wide\"><table class=\"matrix\">" +
         tag("caption",
             "Each field: the verdict, and the quantity that came closest to its limit or "
             "furthest past it, with that limit.") +
         tag("thead", tag("tr", head)) + "\n<tbody>\n" + body + "</tbody>\n" +
         tag("tfoot", tag("tr", foot)) + "</table></div>\n";
}

/// In what run it was: device, hand, burr, delay, push.
std::string run_words(const StabilityRow& row) {
  std::string words;
  const auto add = [&](const std::string& part) { words += (words.empty() ? "" : ", ") + part; };
  if (!row.device.empty()) add(row.device);
  if (!row.hand.empty()) add(row.hand + " hand");
  add("burr " + number(row.burr_mm) + " mm");
  if (row.delay != 0)
    add("delay " + std::to_string(row.delay) + (row.delay == 1 ? " tick" : " ticks"));
  if (row.push_N != 0.0) add("push " + number(row.push_N) + " N");
  return words;
}

/// One line of a case's table: a method's rows of one quantity.
std::string quantity_line(const std::string& method, const Rows& rows) {
  const QuantityWords words = quantity_words(rows.front()->quantity);
  const auto [least, most] = std::minmax_element(
      rows.begin(), rows.end(),
      [](const StabilityRow* a, const StabilityRow* b) {  // NaN counts as the largest.
        return std::isnan(b->value) ? !std::isnan(a->value) : a->value < b->value;
      });
  std::string span = number((*least)->value);
  if ((*least)->value != (*most)->value) span += " to " + number((*most)->value);
  const StabilityRow* worst = worst_of(rows);
  const auto with_limit = std::count_if(
      rows.begin(), rows.end(), [](const StabilityRow* row) { return row->limit.has_value(); });
  const auto passed = std::count_if(
      rows.begin(), rows.end(), [](const StabilityRow* row) { return row->limit && row->pass(); });
  const VerdictLook look = look_of(verdict_of(rows));
  return tag("tr",
             tag("th", for_html(method), "scope=\"row\"") + tag("td", for_html(words.words)) +
                 tag("td", for_html(span + (words.unit.empty() ? "" : " " + words.unit)),
                     css_class("number")) +
                 tag("td", worst ? for_html(with_unit(worst->value, words.unit) + ", " +
                                            limit_words(*worst, words.unit))
                                 : std::string()) +
                 tag("td", worst              ? for_html(run_words(*worst))
                           : rows.size() == 1 ? for_html(run_words(*rows.front()))
                                              : std::string()) +
                 tag("td",
                     worst ? std::to_string(passed) + " of " + std::to_string(with_limit)
                           : std::to_string(rows.size()) + (rows.size() == 1 ? " run" : " runs"),
                     css_class("number")) +
                 tag("td", look.words, css_class(std::string(look.css) + " verdict"))) +
         "\n";
}

std::string case_table(const CaseRows& c) {
  std::string lines;
  for (std::size_t m = 0; m < kMethodCount; ++m) {
    std::vector<std::pair<std::string, Rows>> quantities;
    for (const StabilityRow* row : c.of_methods[m]) {
      auto at = std::find_if(quantities.begin(), quantities.end(),
                             [&](const auto& q) { return q.first == row->quantity; });
      if (at == quantities.end()) at = quantities.insert(quantities.end(), {row->quantity, {}});
      at->second.push_back(row);
    }
    for (const auto& [quantity, rows] : quantities) lines += quantity_line(method_title(m), rows);
  }
  std::string head;
  for (const std::string_view column : {"method", "quantity", "values", "worst against its limit",
                                        "in the run with", "runs passed", "verdict"}) {
    head += tag("th", column, "scope=\"col\"");
  }
  return "<div class=\"wide\"><table>" + tag("caption", "What each method did.") +
         tag("thead", tag("tr", head)) + "\n<tbody>\n" + lines + "</tbody></table></div>\n";
}

std::string figure(const std::string& file, std::string_view words) {
  if (file.empty()) return "";
  return tag("figure", "<img src=\"" + for_html(file) + "\" alt=\"" + for_html(words) + "\">" +
                           tag("figcaption", for_html(words))) +
         "\n";
}

std::string case_section(std::size_t number_of_case, const CaseRows& c,
                         const StabilityPictures& pictures) {
  std::string section =
      tag("h3", number_and_title(number_of_case, c), "id=\"" + for_html(c.name) + "\"") + "\n";
  if (const CaseText* text = text_of(c.name)) {
    section += paragraph(text->failure) +
               tag("p", "<strong>Script.</strong> " + for_html(text->script)) + "\n" +
               tag("p", "<strong>Limit.</strong> " + for_html(text->limit)) + "\n";
  }
  if (c.empty()) return section + paragraph("Not run this time.");
  section += case_table(c);
  const auto picture = pictures.of_cases.find(c.name);
  if (picture == pictures.of_cases.end() || picture->second.empty()) {
    return section + paragraph("No picture was drawn of it.");
  }
  return section + figure(picture->second, "Force over time, " + spaced_name(c.name));
}

std::string chart_section(const char* title, const std::string& file, std::string_view words) {
  return tag("h3", title) + "\n" +
         (file.empty() ? paragraph("This chart was not drawn.") : figure(file, words));
}

std::string what_was_tried() {
  std::string methods;
  for (std::size_t m = 0; m < kMethodCount; ++m) {
    methods += tag("dt", for_html(method_title(m))) + tag("dd", for_html(kMethodTexts[m])) + "\n";
  }
  return tag("h2", "What was tried") + "\n" +
         paragraph(
             "A haptic device gives its position a thousand times a second, and is answered with "
             "a force that it holds until the next time. Device, hand, program and tooth make a "
             "closed loop: a force that comes too late, or jumps, moves the hand, which moves "
             "the device, which changes the force. Where cases need that loop it is simulated "
             "whole: the device's mass, damping and friction, its position rounded to what it "
             "can tell apart, with no delay or one tick; a hand that is a mass, a damper and a "
             "spring, held lightly, firmly or with the whole arm; and a push of that hand. The "
             "devices are those that are common in dental trainers, with the limits their makers "
             "or users publish. Other cases follow a script, whatever the force; their rows name "
             "no device.") +
         tag("dl", "\n" + methods) + "\n" +
         paragraph(
             "The limits are for the method coupling, which is what the program does by "
             "default. The others stand beside it under the same limits, to show what they do. "
             "Forces and steps are judged before they are clamped for the device.");
}

}  // namespace

QuantityWords quantity_words(const std::string& quantity) {
  struct Ending {
    std::string_view text, unit;
  };
  // Longer ones before those that they end with.
  constexpr Ending kEndings[] = {
      {"_deg_per_tick", "degrees per tick"},
      {"_J_per_mm3", "J/mm\u00b3"},
      {"_N_s_per_m", "N s/m"},
      {"_N_per_mm", "N/mm"},
      {"_N_per_m", "N/m"},
      {"_mm_per_s", "mm/s"},
      {"_m_per_s", "m/s"},
      {"_percent", "%"},
      {"_pct", "%"},
      {"_mNm", "mN m"},
      {"_mm3", "mm\u00b3"},
      {"_deg", "degrees"},
      {"_Nm", "N m"},
      {"_Hz", "Hz"},
      {"_mN", "mN"},
      {"_mJ", "mJ"},
      {"_uJ", "\u00b5J"},
      {"_mm", "mm"},
      {"_um", "\u00b5m"},
      {"_ms", "ms"},
      {"_us", "\u00b5s"},
      {"_N", "N"},
      {"_J", "J"},
      {"_W", "W"},
      {"_s", "s"},
  };
  for (const Ending& ending : kEndings) {
    if (quantity.size() > ending.text.size() && quantity.ends_with(ending.text)) {
      return {spaced_name(quantity.substr(0, quantity.size() - ending.text.size())),
              std::string(ending.unit)};
    }
  }
  return {spaced_name(quantity), ""};
}

std::string stability_page(std::span<const StabilityRow> rows, const StabilityPictures& pictures,
                           std::span<const std::string> remarks) {
  const std::vector<CaseRows> cases = sorted_by_case(rows);
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Sulcus: stability</title>\n<style>" +
      std::string(kStyle) + "</style>\n</head>\n<body>\n" +
      tag("h1", "Stability: where methods of haptic rendering fail, and what this one does") +
      "\n" + what_was_tried() + tag("h2", "Cases and methods", "id=\"matrix\"") + "\n" +
      matrix(cases) + tag("h2", "The cases") + "\n";
  for (std::size_t c = 0; c < cases.size(); ++c) {
    page += "<section>\n" + case_section(c + 1, cases[c], pictures) + "</section>\n";
  }
  page += tag("h2", "The charts") + "\n" +
          chart_section("How stiff a tooth can be felt", pictures.frontier,
                        "Felt stiffness against the voxels in contact. Below the solid line the "
                        "push is not held and the burr pops through; above the dashed line it "
                        "buzzes. A method can be used where it is filled between them.") +
          chart_section("What damping does", pictures.damping,
                        "The largest stable stiffness against damping, a line for each loop.") +
          chart_section("Speed and error of the force", pictures.speed_error,
                        "The error of the force against the time of a tick, from the same runs.");
  if (!remarks.empty()) page += tag("h2", "Remarks") + "\n";
  for (const std::string& remark : remarks) page += paragraph(remark);
  return page + "</body>\n</html>\n";
}

}  // namespace sulcus::lab
