#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

/// Pictures beside the page, by their file names, relative to it. An empty name, or a case that is
/// not there: none was drawn, and the page says so.
struct StabilityPictures {
  std::map<std::string, std::string> of_cases;  // by the case's name
  std::string frontier, damping, speed_error;
};

/// The page stability.html: what was tried, cases against methods, each case with what every
/// method did, and the charts. It is one file of HTML without scripts, and it names its pictures.
/// `rows`: in any order; a case without rows was not run, a method without rows in a case does not
/// apply to it. Cases that have no text stand last. `remarks`: paragraphs for the end, as the
/// machine and the build. All text is escaped.
std::string stability_page(std::span<const StabilityRow> rows, const StabilityPictures& pictures,
                           std::span<const std::string> remarks);

/// A quantity of stability.csv as words and unit: "force_step_N" is "force step" in "N".
struct QuantityWords {
  std::string words, unit;
};
QuantityWords quantity_words(const std::string& quantity);

}  // namespace sulcus::lab
