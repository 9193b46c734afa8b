#pragma once

#include <string>
#include <vector>

#include "tools/sulcus_lab/normals/normals_charts.hpp"

namespace sulcus::lab {

/// Cost of one normal on a shape.
struct CostRow {
  Method method;
  int neighbourhood;
  double readouts, ns_per_normal;
};
std::vector<CostRow> costs_of(const ShapeResult& result);

/// Exponents p of c n^p, n = 2 NS + 1, that fit a method's times and readouts best (least squares
/// of the logarithms); NaN with fewer than two neighbourhoods.
struct CostGrowth {
  double time, readouts;
};
CostGrowth growth_of(Method method, const std::vector<CostRow>& costs);

/// Time and readouts over 2 NS + 1, with the exponents [Kim and Park 2019, VI-C: n^2 against n^3].
bool draw_cost(const std::vector<CostRow>& costs, const std::string& shape,
               const std::string& file_png);

}  // namespace sulcus::lab
