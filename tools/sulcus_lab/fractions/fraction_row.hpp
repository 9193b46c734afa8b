#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "engine/scene/scene.hpp"

namespace sulcus::lab {

/// One figure of both surfaces, in the order of SurfaceKind: binary, fractions.
using OfSurfaces = std::array<double, 2>;
inline constexpr SurfaceKind kBothSurfaces[] = {SurfaceKind::kBinary, SurfaceKind::kFractions};

/// A line of fractions.csv: a quantity, the smaller the better, on both surfaces.
struct FractionRow {
  std::string quantity;  // with its unit: "normal_error_deg"
  std::string shape;     // or scene
  std::string setting;   // what sets it apart from others of the same shape
  OfSurfaces value{};
  double wanted = 0.0;  // of the size of the value with fractions, at most
  /// A normal's, an evaluation's or a tick's, for the chart; not finite: not timed.
  OfSurfaces ns{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};

  double binary() const { return value[0]; }
  double fractions() const { return value[1]; }
  /// What is not a number does not pass.
  bool pass() const { return std::abs(fractions()) <= wanted; }
  bool is_timed() const { return std::isfinite(ns[0]) && std::isfinite(ns[1]); }
};

}  // namespace sulcus::lab
