#include "tools/sulcus_lab/laws/laws_page.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/user_text.hpp"
#include "tools/sulcus_lab/laws/laws.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/stability/stability_page.hpp"

namespace sulcus::lab {

namespace {

constexpr std::string_view kLawStyle = R"(
:root { color-scheme: light; }
body { font: 16px/1.5 "DejaVu Sans", Verdana, Arial, sans-serif; color: #1a1a1a; background: #fff;
  max-width: 1120px; margin: 0 auto; padding: 1.5em; }
h1 { font-size: 1.7em; } h2 { font-size: 1.3em; margin: 2.2em 0 .5em;
  border-bottom: 2px solid #0072b2; }
p { max-width: 46em; } a { color: #005a8c; } img { max-width: 100%; border: 1px solid #ddd; }
table { border-collapse: collapse; font-size: .8em; line-height: 1.35; margin: .8em 0; }
th, td { border: 1px solid #bbb; padding: .3em .5em; text-align: left; vertical-align: top; }
thead th { background: #f0f0f0; } td.number { text-align: right; white-space: nowrap; }
td.pass { background: #e3f1e4; } td.fail { background: #fbe0d6; border-left: 4px solid #b03a00; }
td.reported { background: #eef3f8; } td small { display: block; color: #333; }
@media print { body { font-size: 10pt; max-width: none; padding: 0; }
  td { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
)";

using LawRows = std::vector<const LawRow*>;

std::string html(std::string_view name, std::string_view content,
                 std::string_view attributes = "") {
  std::string text = "<";
  text.append(name);
  if (!attributes.empty()) text.append(" ").append(attributes);
  return text.append(">").append(content).append("</").append(name).append(">");
}

std::string value_words(double value, const std::string& unit) {
  if (std::isnan(value)) return "not a number";
  return with_number("%.3g", value) + (unit.empty() || unit == "%" ? unit : " " + unit);
}

std::string wanted_words(const LawRow& row, const std::string& unit) {
  if (!row.limit) return "";
  return (row.at_least ? "at least " : "at most ") + value_words(*row.limit, unit);
}

/// How far past its limit a row is.
double excess_of(const LawRow& row) {
  if (std::isnan(row.value)) return HUGE_VAL;
  const double off = row.at_least ? *row.limit - row.value : row.value - *row.limit;
  return *row.limit == 0.0 ? off : off / std::abs(*row.limit);
}

/// Of rows with limits the worst: failed before passed; null: none has one.
const LawRow* worst_law_row(const LawRows& rows) {
  const LawRow* worst = nullptr;
  for (const LawRow* row : rows) {
    if (!row->limit) continue;
    if (!worst ||
        std::pair(!row->pass(), excess_of(*row)) > std::pair(!worst->pass(), excess_of(*worst))) {
      worst = row;
    }
  }
  return worst;
}

std::string verdict_cell(const LawRow* row) {
  if (!row || !row->limit) return html("td", "reported", "class=\"reported\"");
  return row->pass() ? html("td", "&#10003; pass", "class=\"pass\"")
                     : html("td", "&#10007; FAIL", "class=\"fail\"");
}

LawRows rows_of(std::span<const LawRow> rows, std::string_view law, std::string_view scaling = "") {
  LawRows found;
  for (const LawRow& row : rows) {
    if (row.law == law && (scaling.empty() || row.scaling == scaling)) found.push_back(&row);
  }
  return found;
}

/// A field of the first table: the verdict, and the worst of what has a limit.
std::string summary_cell(const LawRows& rows) {
  if (rows.empty()) return html("td", "");
  const LawRow* worst = worst_law_row(rows);
  if (!worst) return html("td", "reported", "class=\"reported\"");
  const QuantityWords words = quantity_words(worst->quantity);
  const std::string where = worst->shape + (worst->setting.empty() ? "" : ", ") + worst->setting;
  return html("td",
              (worst->pass() ? "&#10003; pass" : "&#10007; FAIL") +
                  html("small", for_html(words.words + " " + value_words(worst->value, words.unit) +
                                         ", " + wanted_words(*worst, words.unit) + " (" +
                                         spaced_name(where) + ")")),
              worst->pass() ? "class=\"pass\"" : "class=\"fail\"");
}

std::string summary(std::span<const LawRow> rows, const std::vector<std::string>& scalings) {
  std::string head = html("th", "law") + html("th", "wanted"), body;
  for (const std::string& scaling : scalings) head += html("th", for_html(scaling));
  for (const Law& law : laws()) {
    std::string line =
        html("th", html("a", for_html(law.title), "href=\"#" + std::string(law.name) + "\"")) +
        html("td", for_html(law.wanted));
    for (const std::string& scaling : scalings) {
      line += summary_cell(rows_of(rows, law.name, scaling));
    }
    body += html("tr", line) + "\n";
  }
  return html("table", html("thead", html("tr", head)) + "\n" + html("tbody", body)) + "\n";
}

std::string law_section(std::span<const LawRow> all, const Law& law) {
  std::string section = html("h2", for_html(law.title), "id=\"" + std::string(law.name) + "\"") +
                        html("p", for_html(law.text)) +
                        html("p", "<strong>Wanted:</strong> " + for_html(law.wanted) + ".");
  const LawRows rows = rows_of(all, law.name);
  if (rows.empty()) return section + html("p", "Not run this time.");
  std::string head, body;
  for (const char* column : {"shape", "scaling", "setting", "quantity", "value", "limit", ""}) {
    head += html("th", column);
  }
  for (const LawRow* row : rows) {
    const QuantityWords words = quantity_words(row->quantity);
    body +=
        html("tr",
             html("td", for_html(spaced_name(row->shape))) + html("td", for_html(row->scaling)) +
                 html("td", for_html(row->setting)) + html("td", for_html(words.words)) +
                 html("td", for_html(value_words(row->value, words.unit)), "class=\"number\"") +
                 html("td", for_html(wanted_words(*row, words.unit))) + verdict_cell(row)) +
        "\n";
  }
  return section + html("table", html("thead", html("tr", head)) + "\n" + html("tbody", body));
}

}  // namespace

std::string laws_page(std::span<const LawRow> rows, const std::string& picture,
                      const std::string& remark) {
  std::vector<std::string> scalings;
  for (const LawRow& row : rows) {
    if (std::ranges::find(scalings, row.scaling) == scalings.end()) scalings.push_back(row.scaling);
  }
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Sulcus: the laws of the force</title>\n<style>" +
      std::string(kLawStyle) + "</style>\n</head>\n<body>\n" + html("h1", "The laws of the force") +
      html(
          "p",
          "A force is a function of shape, pose and motion: it has no history, favours no axis of "
          "the grid, and gives out no energy that was not put in. Each law is measured on several "
          "shapes under each scaling of the contacts' stiffness. Each field: the verdict, and what "
          "is furthest past its limit or closest to it.") +
      "\n" + summary(rows, scalings);
  if (!picture.empty()) {
    page += html("p", "<img src=\"" + for_html(picture) +
                          "\" alt=\"Energy given out by closed ways, by shape\">");
  }
  for (const Law& law : laws()) page += "<section>\n" + law_section(rows, law) + "</section>\n";
  return page + html("p", for_html(remark)) + "</body>\n</html>\n";
}

}  // namespace sulcus::lab
