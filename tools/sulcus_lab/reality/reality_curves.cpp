#include "tools/sulcus_lab/reality/reality_curves.hpp"

#include <array>
#include <string_view>

#include "tools/sulcus_lab/reality/cutting_rig.hpp"

namespace sulcus::lab {

namespace {

struct Series {
  std::string_view name;
  CuttingLaw law;
  std::string_view burr;
};
constexpr std::array kSeries{
    Series{"paper", CuttingLaw::kPaper, ""},
    Series{"saturating medium", CuttingLaw::kSaturating, "grit = 'medium'"},
    Series{"saturating coarse", CuttingLaw::kSaturating, "grit = 'coarse'"},
    Series{"saturating carbide", CuttingLaw::kSaturating, "material = 'carbide'"},
};

}  // namespace

std::vector<RealityPoint> reality_curves(const RealityOptions& options) {
  std::vector<RealityPoint> points{
      // 0.11 g of enamel in 12 minutes; 0.44 mm3/s/N of tooth, here at 1 N.
      {"load_N", "published", 0.65, 0.052, "Fais 2010"},
      {"load_N", "published", 1.0, 0.44, "Yoshida 2011"},
  };
  for (const Series& series : kSeries) {
    CuttingTrial trial;
    trial.law = series.law;
    trial.burr = series.burr;
    if (options.quick) trial.voxel_mm = kQuickVoxel_mm;
    for (const double load_N : {0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0}) {
      options.progress(std::string(series.name) + " against the load");
      trial.load_N = load_N;
      points.push_back(
          {"load_N", std::string(series.name), load_N, measure_cutting(trial).mm3_per_s});
    }
    trial.load_N = 1.0;
    for (const double krpm : {25.0, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0, 350.0, 400.0}) {
      options.progress(std::string(series.name) + " against the speed");
      trial.held_rpm = 1e3 * krpm;
      points.push_back(
          {"speed_krpm", std::string(series.name), krpm, measure_cutting(trial).mm3_per_s});
    }
  }
  return points;
}

}  // namespace sulcus::lab
