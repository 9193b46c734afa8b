#include "tools/sulcus_lab/stability/stability_page.hpp"

#include <cmath>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "tools/sulcus_lab/stability/cases/case_texts.hpp"

namespace sulcus::lab::stability_page_test {
namespace {

StabilityRow row(std::string case_name, ContactMethod method, std::string quantity, double value,
                 std::optional<double> limit, bool at_least = false) {
  StabilityRow r;
  r.case_name = std::move(case_name);
  r.method = method;
  r.quantity = std::move(quantity);
  r.value = value;
  r.limit = limit;
  r.at_least = at_least;
  return r;
}

std::string page_of(const std::vector<StabilityRow>& rows, const StabilityPictures& pictures = {},
                    const std::vector<std::string>& remarks = {}) {
  return stability_page(rows, pictures, remarks);
}

/// What stands between two texts, the first of them at `from` or after it.
std::string between(const std::string& page, const std::string& first, const std::string& second,
                    std::size_t from = 0) {
  const std::size_t begin = page.find(first, from);
  if (begin == std::string::npos) return "";
  const std::size_t inner = begin + first.size();
  const std::size_t end = page.find(second, inner);
  return end == std::string::npos ? "" : page.substr(inner, end - inner);
}

/// The matrix's fields of a case, without tags: one a method, or "not run" alone.
std::vector<std::string> fields_of(const std::string& page, const std::string& case_name) {
  const std::string matrix = between(page, "<table class=\"matrix\">", "</table>");
  const std::string line = between(matrix, "href=\"#" + case_name + "\"", "</tr>");
  std::vector<std::string> fields;
  for (std::size_t at = line.find("<td"); at != std::string::npos; at = line.find("<td", at + 1)) {
    const std::size_t inner = line.find('>', at) + 1;
    const std::string cell = line.substr(inner, line.find("</td>", at) - inner);
    fields.push_back(std::regex_replace(cell, std::regex("(<[^>]*>)+"), " "));
  }
  return fields;
}

/// With its apostrophes as they are read.
std::string section_of(const std::string& page, const std::string& case_name) {
  const std::string section = between(page, "<h3 id=\"" + case_name + "\"", "</section>");
  return std::regex_replace(section, std::regex("&#39;"), "'");
}

/// The tags that were left open or closed out of turn, as a browser would have to guess.
std::string unbalanced_tags(const std::string& page) {
  const std::set<std::string> kVoid{"meta", "img"};
  std::vector<std::string> open;
  const std::regex tag("<(/?)([a-z0-9]+)[^>]*>");
  const std::string body = page.substr(page.find("<html"));
  for (std::sregex_iterator at(body.begin(), body.end(), tag), end; at != end; ++at) {
    const std::string name = (*at)[2];
    if (kVoid.count(name) != 0) continue;
    if ((*at)[1].length() == 0) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "</" + name + "> at " + std::to_string(at->position());
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + ">";
}

TEST(CaseTexts, AreTheTwentyCasesEachNamedOnceAndToldWhole) {
  EXPECT_EQ(case_texts().size(), 20u);
  std::set<std::string_view> names;
  for (const CaseText& text : case_texts()) {
    names.insert(text.name);
    EXPECT_TRUE(std::regex_match(std::string(text.name), std::regex("[a-z_]+"))) << text.name;
    EXPECT_LT(text.title.size(), 60u) << text.name << ": it stands in a column";
    for (const std::string_view told : {text.failure, text.script, text.limit}) {
      EXPECT_GT(told.size(), 20u) << text.name;
      EXPECT_EQ(told.back(), '.') << text.name;
    }
  }
  EXPECT_EQ(names.size(), 20u);
  EXPECT_EQ(case_texts().front().name, "thin_wall");
  EXPECT_EQ(case_texts().back().name, "cutting_energy");
}

TEST(QuantityWords, TellTheUnitFromTheEndOfTheName) {
  const auto words_of = [](const char* quantity) {
    const QuantityWords words = quantity_words(quantity);
    return words.words + "|" + words.unit;
  };
  EXPECT_EQ(words_of("force_reversal_N"), "force reversal|N");
  EXPECT_EQ(words_of("felt_stiffness_N_per_mm"), "felt stiffness|N/mm");
  EXPECT_EQ(words_of("turn_deg_per_tick"), "turn|degrees per tick");
  EXPECT_EQ(words_of("share_percent"), "share|%");
  EXPECT_EQ(words_of("settled_ms"), "settled|ms");
  EXPECT_EQ(words_of("crossings"), "crossings|");
  EXPECT_EQ(words_of("_N"), " N|") << "no name would be left";
}

TEST(StabilityPage, HasASectionForEachCaseWithItsTextsAndSaysWhatWasNotRun) {
  const std::string page = page_of({row("buzz", ContactMethod::kCoupling, "swing_N", 0.1, 0.2)});
  for (const CaseText& text : case_texts()) {
    const std::string name(text.name);
    const std::string section = section_of(page, name);
    EXPECT_NE(section.find(text.failure), std::string::npos) << name;
    EXPECT_NE(section.find(text.script), std::string::npos) << name;
    EXPECT_NE(section.find(text.limit), std::string::npos) << name;
    EXPECT_EQ(section.find("Not run this time.") == std::string::npos, name == "buzz") << name;
    ASSERT_EQ(fields_of(page, name).size(), name == "buzz" ? 6u : 1u) << name;
  }
  EXPECT_EQ(fields_of(page, "spur")[0], "not run");
}

TEST(StabilityPage, TheMatrixSaysInWordsWhatEachMethodDid) {
  const std::string page =
      page_of({row("thin_wall", ContactMethod::kCoupling, "force_reversal_N", 0.004, 0.01),
               row("thin_wall", ContactMethod::kCount, "force_reversal_N", 0.7, 0.01),
               row("thin_wall", ContactMethod::kNone, "peak_force_N", 12.0, std::nullopt)});
  const std::vector<std::string> fields = fields_of(page, "thin_wall");
  ASSERT_EQ(fields.size(), 6u);
  EXPECT_EQ(fields[0], " &#10003; pass force reversal 0.004 N, at most 0.01 N ");
  EXPECT_EQ(fields[2], " &#10007; FAIL force reversal 0.7 N, at most 0.01 N ");
  EXPECT_EQ(fields[3], " no limit ");
  EXPECT_EQ(fields[5], " not applicable ");
}

TEST(StabilityPage, OfSeveralRowsTheOneFurthestPastItsLimitIsShown) {
  const auto shown = [](const std::vector<StabilityRow>& rows) {
    return fields_of(page_of(rows), "wedge")[0];
  };
  constexpr auto kOurs = ContactMethod::kCoupling;
  // A share of the limit counts, not the number.
  EXPECT_EQ(
      shown({row("wedge", kOurs, "side_N", 0.09, 0.1), row("wedge", kOurs, "turn_deg", 1, 5)}),
      " &#10003; pass side 0.09 N, at most 0.1 N ");
  EXPECT_EQ(shown({row("wedge", kOurs, "felt_share", 0.95, 0.9, true),
                   row("wedge", kOurs, "felt_share", 0.76, 0.75, true)}),
            " &#10003; pass felt share 0.76, at least 0.75 ");
  // One that failed comes before all that passed, whatever the share.
  EXPECT_EQ(
      shown({row("wedge", kOurs, "side_N", 0.1, 0.1), row("wedge", kOurs, "pull_N", 1e-9, 0.0)}),
      " &#10007; FAIL pull 1e-09 N, at most 0 N ");
  EXPECT_EQ(shown({row("wedge", kOurs, "side_N", 0.5, 0.1),
                   row("wedge", kOurs, "felt_share", -0.1, 0.75, true)}),
            " &#10007; FAIL felt share -0.1, at least 0.75 ");
  EXPECT_EQ(shown({row("wedge", kOurs, "side_N", 0.5, 0.1),
                   row("wedge", kOurs, "force_N", std::nan(""), 3.3)}),
            " &#10007; FAIL force not a number, at most 3.3 N ");
}

TEST(StabilityPage, CountsWhatEachMethodPassed) {
  const std::string page =
      page_of({row("buzz", ContactMethod::kSmooth, "swing_N", 1, 2),
               row("spur", ContactMethod::kSmooth, "felt_N", 3, 2),
               row("wedge", ContactMethod::kSmooth, "side_N", 1, std::nullopt)});
  const std::string foot = between(page, "<tfoot>", "</tfoot>");
  EXPECT_NE(foot.find("with a limit</th><th>0 of 0</th><th>1 of 2</th><th>0 of 0</th>"),
            std::string::npos)
      << foot;
}

TEST(StabilityPage, ACasesTableGathersTheRunsOfAQuantityAndNamesTheWorst) {
  std::vector<StabilityRow> rows;
  for (const double push_N : {0.5, 1.0, 2.0}) {
    StabilityRow r = row("buzz", ContactMethod::kCoupling, "swing_N", 0.1 * push_N, 0.15);
    r.device = "omni";
    r.hand = "light";
    r.delay = 1;
    r.push_N = push_N;
    rows.push_back(r);
  }
  const std::string section = section_of(page_of(rows), "buzz");
  EXPECT_NE(section.find("0.05 to 0.2 N"), std::string::npos);
  EXPECT_NE(section.find("0.2 N, at most 0.15 N"), std::string::npos);
  EXPECT_NE(section.find("omni, light hand, burr 1 mm, delay 1 tick, push 2 N"), std::string::npos);
  EXPECT_NE(section.find("2 of 3"), std::string::npos);
}

TEST(StabilityPage, NamesThePicturesAndSaysWhichAreMissing) {
  StabilityPictures pictures;
  pictures.of_cases["buzz"] = "buzz.png";
  pictures.frontier = "frontier.png";
  const std::string page = page_of({row("buzz", ContactMethod::kCoupling, "swing_N", 1, 2),
                                    row("spur", ContactMethod::kCoupling, "felt_N", 1, 2)},
                                   pictures);
  EXPECT_NE(section_of(page, "buzz").find("<img src=\"buzz.png\" alt=\"Force over time, buzz\">"),
            std::string::npos);
  EXPECT_NE(section_of(page, "spur").find("No picture was drawn"), std::string::npos);
  const std::string charts = page.substr(page.find("<h2>The charts</h2>"));
  EXPECT_NE(charts.find("src=\"frontier.png\""), std::string::npos);
  EXPECT_NE(charts.find("This chart was not drawn."), std::string::npos);
}

TEST(StabilityPage, ACaseWithoutATextStandsLast) {
  const std::string page = page_of({row("new_one", ContactMethod::kCoupling, "felt_N", 1, 2)});
  EXPECT_NE(page.find(">21. new one</a>"), std::string::npos);
  EXPECT_NE(section_of(page, "new_one").find("1 N, at most 2 N"), std::string::npos);
}

TEST(StabilityPage, IsOneWellFormedFileWithoutScripts) {
  StabilityPictures pictures;
  pictures.of_cases["a<b>&\"c"] = "a<b>&\"c.png";
  StabilityRow nasty = row("a<b>&\"c", ContactMethod::kMcNeely, "<i>_N", 1, 2);
  nasty.device = "<script>";
  const std::string page = page_of({nasty, row("buzz", ContactMethod::kCoupling, "swing_N", 1, 2)},
                                   pictures, {"Built with <care> & so on."});
  EXPECT_EQ(unbalanced_tags(page), "");
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_NE(page.find("<p>Built with &lt;care&gt; &amp; so on.</p>"), std::string::npos);
}

}  // namespace
}  // namespace sulcus::lab::stability_page_test
