#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tools/sulcus_lab/reality/cutting_rig.hpp"
#include "tools/sulcus_lab/reality/reality.hpp"
#include "tools/sulcus_lab/reality/reality_bands.hpp"

namespace sulcus::lab {

namespace {

/// Measures a row under both laws.
class Rows {
 public:
  explicit Rows(const RealityOptions& options) : options_(options) {}

  /// `of(base)`: the row's figure, where `base` has the law and the voxel.
  template <class Of>
  void add(RealityRow row, const Of& of) {
    for (const CuttingLaw law : {CuttingLaw::kPaper, CuttingLaw::kSaturating}) {
      options_.progress(row.check);
      CuttingTrial base;
      base.law = law;
      if (options_.quick) base.voxel_mm = kQuickVoxel_mm;
      row.value[static_cast<std::size_t>(law)] = of(base);
    }
    rows_.push_back(std::move(row));
  }
  std::vector<RealityRow> take() { return std::move(rows_); }

 private:
  const RealityOptions& options_;
  std::vector<RealityRow> rows_;
};

double rate_of(const CuttingTrial& trial) { return measure_cutting(trial).mm3_per_s; }

double rate_at(CuttingTrial trial, double load_N, std::string_view burr = {}) {
  trial.load_N = load_N;
  trial.burr = burr;
  return rate_of(trial);
}
double rate_held(CuttingTrial trial, double rpm) {
  trial.held_rpm = rpm;
  return rate_of(trial);
}

/// In steps of 25,000 rpm up to 400,000, 1,000 rpm.
double best_speed_of_carbide(CuttingTrial trial) {
  trial.burr = "material = 'carbide'";
  double best_krpm = 0.0, most = 0.0;
  for (double krpm = 50.0; krpm <= 400.0; krpm += 25.0) {
    const double rate = rate_held(trial, 1e3 * krpm);
    if (rate > most) best_krpm = krpm;
    most = std::max(most, rate);
  }
  return best_krpm;
}

/// Of the rate of a new burr, after 39 mm, at the load that it was measured with.
double left_after_wear(const CuttingTrial& base, const std::string& grit) {
  constexpr double kLoad_N = 1.45;  // 147.5 g
  const std::string worn = grit + "\nworn_mm = 39";
  return rate_at(base, kLoad_N, worn) / rate_at(base, kLoad_N, grit);
}

constexpr const char* kCoarse = "grit = 'coarse'";
constexpr const char* kSuperCoarse = "grit = 'super_coarse'";

}  // namespace

std::vector<RealityRow> reality_rates(const RealityOptions& options) {
  Rows rows(options);
  rows.add({"rate in enamel, turbine, medium grit, 0.65 N, mm3/s/N",
            "Fais 2010; Yoshida 2011",
            0.08,
            0.44,
            {}},
           [](const CuttingTrial& base) { return rate_at(base, 0.65) / 0.65; });
  rows.add(row_of(Fitted::kSpeed), [](const CuttingTrial& base) {
    return rate_held(base, 400e3) / rate_held(base, 100e3);
  });
  rows.add(row_of(Fitted::kMediumLoad),
           [](const CuttingTrial& base) { return rate_at(base, 2.0) / rate_at(base, 1.0); });
  rows.add(row_of(Fitted::kCoarseLoad), [](const CuttingTrial& base) {
    return rate_at(base, 2.0, kCoarse) / rate_at(base, 1.0, kCoarse);
  });
  rows.add(row_of(Fitted::kCarbideBest), best_speed_of_carbide);
  rows.add(row_of(Fitted::kMediumWear),
           [](const CuttingTrial& base) { return left_after_wear(base, "grit = 'medium'"); });
  const std::string siegel = "three grits, Siegel and von Fraunhofer";
  rows.add({"rate after 39 mm over new, coarse grit", siegel, 0.60, 0.70, {}},
           [](const CuttingTrial& base) { return left_after_wear(base, kCoarse); });
  rows.add({"rate after 39 mm over new, super-coarse grit", siegel, 0.70, 0.80, {}},
           [](const CuttingTrial& base) { return left_after_wear(base, kSuperCoarse); });
  rows.add({"rate with 1.6 mm over 1.0 mm diameter, turbine, 1 N",
            "nine variables, J Prosthet Dent 2016",
            0.6,
            1.4,
            {}},
           [](const CuttingTrial& base) {
             CuttingTrial wide = base;
             wide.diameter_mm = 1.6;
             return rate_of(wide) / rate_of(base);
           });
  rows.add({"dentine over enamel by volume, turbine, 1 N", "Liao 1995", 1.0, 2.0, {}},
           [](const CuttingTrial& base) {
             CuttingTrial dentine = base;
             dentine.tissue = "dentine";
             return rate_of(dentine) / rate_of(base);
           });
  rows.add({"tangential over normal force",
            "dental handpiece on glass ceramic (fitted)",
            0.40,
            0.60,
            {}},
           [](const CuttingTrial& base) { return measure_cutting(base).tangential_ratio; });
  return rows.take();
}

}  // namespace sulcus::lab
