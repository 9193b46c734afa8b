#pragma once

#include <optional>
#include <string>

#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

/// One line of laws.csv: what one measurement of a law found, and what is wanted of it.
struct LawRow {
  std::string law;       // "closed_way", as kLaws names them
  std::string shape;     // that it was measured on
  std::string scaling;   // of [haptics]
  std::string setting;   // what sets it apart from others of the same shape: "0.1 mm deep, forth"
  std::string quantity;  // with its unit: "given_out_uJ"
  double value = 0.0;
  std::optional<double> limit;  // none: only reported
  bool at_least = false;        // the limit is the least that passes, else the most
  /// What is not a number passes no limit.
  bool pass() const { return !limit || (at_least ? value >= *limit : value <= *limit); }
};

}  // namespace sulcus::lab
