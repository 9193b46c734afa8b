#pragma once

#include <string>
#include <vector>

#include "tools/sulcus_lab/reality/reality.hpp"

namespace sulcus::lab {

/// A point of the chart: a rate of removal that was measured, by Sulcus or by others.
struct RealityPoint {
  std::string against;  // load_N or speed_krpm
  std::string series;   // a law, with its grit; or published
  double x = 0.0, mm3_per_s = 0.0;
  std::string label = {};  // of a published one
};

/// A burr of 1 mm in enamel: with the turbine against the load, at 1 N and a held speed against the
/// speed.
std::vector<RealityPoint> reality_curves(const RealityOptions& options);

}  // namespace sulcus::lab
