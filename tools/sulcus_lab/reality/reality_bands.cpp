#include "tools/sulcus_lab/reality/reality_bands.hpp"

#include <cmath>
#include <cstdio>

#include <Eigen/Core>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include "engine/core/units.hpp"
#include "engine/scene/handpiece_presets.hpp"

namespace sulcus::lab {

namespace {

constexpr double kEnamel_J_per_m3 = 3.5e9;  // assets/tissues.toml
constexpr double kRadius_m = 0.5e-3;

/// Of removal by a burr, over the tangential ratio.
double rate(const BurrSettings& burr, const SaturatingConstants& constants, double load_N,
            double rad_per_s) {
  const double rim_m_per_s = rad_per_s * kRadius_m;
  return SaturatingLaw(burr, constants).share(kEnamel_J_per_m3, load_N, rim_m_per_s) * load_N *
         rim_m_per_s / kEnamel_J_per_m3;
}

double turbine_rate(Grit grit, const SaturatingConstants& constants, double load_N) {
  const HandpiecePreset& turbine = handpiece_presets().front();
  const double held = kSaturatingTangentialRatio * load_N * kRadius_m;
  BurrSettings burr;
  burr.grit = grit;
  return rate(burr, constants, load_N,
              turbine.free_rad_per_s * (1.0 - held / turbine.spindle.stall_torque_Nm));
}

double of_speed(const SaturatingConstants& c) {
  return rate({}, c, 1.0, 400'000 * kRevolutionPerMinute) /
         rate({}, c, 1.0, 100'000 * kRevolutionPerMinute);
}
double of_medium_load(const SaturatingConstants& c) {
  return turbine_rate(Grit::kMedium, c, 2.0) / turbine_rate(Grit::kMedium, c, 1.0);
}
double of_coarse_load(const SaturatingConstants& c) {
  return turbine_rate(Grit::kCoarse, c, 2.0) / turbine_rate(Grit::kCoarse, c, 1.0);
}
double best_of_carbide(const SaturatingConstants& c) {
  return 1e-3 * c.carbide_m_per_s / kRadius_m / kRevolutionPerMinute;
}
double of_medium_wear(const SaturatingConstants& c) {
  BurrSettings worn;
  worn.worn_m = 39e-3;
  return rate(worn, c, 1.0, 1e4) / rate({}, c, 1.0, 1e4);
}

// Bands of a figure without a spread are ours: the speed of a peak to a quarter, a rate after wear
// to five hundredths.
constexpr std::array<FittedBand, kFittedBands> kBands{{
    {"rate at 400,000 over 100,000 rpm, speed held, 1 N", "nine variables, J Prosthet Dent 2016",
     0.6, 1.4, of_speed},
    {"rate at 2 N over 1 N, turbine, medium grit", "load and cutting efficiency, Siegel", 0.9, 1.2,
     of_medium_load},
    {"rate at 2 N over 1 N, turbine, coarse grit", "load and cutting efficiency, Siegel", 1.2, 2.0,
     of_coarse_load},
    {"carbide: speed of the greatest rate, 1,000 rpm", "carbide F57 against speed", 150.0, 250.0,
     best_of_carbide},
    {"rate after 39 mm over new, medium grit", "three grits, Siegel and von Fraunhofer", 0.45, 0.55,
     of_medium_wear},
}};

/// `logs`: of the constants, in this order.
SaturatingConstants constants_of(const Eigen::VectorXd& logs) {
  SaturatingConstants c;
  c.grain_area_m2 = std::exp(logs[0]);
  c.diamond_m_per_s = std::exp(logs[1]);
  c.carbide_m_per_s = std::exp(logs[2]);
  c.wear_length_m = std::exp(logs[3]);
  return c;
}

/// As Eigen's minimiser asks for it.
struct Residuals {
  // NOLINTBEGIN(readability-identifier-naming): Eigen's
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  static constexpr int InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic;
  static int values() { return static_cast<int>(kFittedBands); }
  // NOLINTEND(readability-identifier-naming)
  int operator()(const InputType& logs, ValueType& off) const {
    const SaturatingConstants constants = constants_of(logs);
    for (std::size_t b = 0; b < kFittedBands; ++b) {
      off[static_cast<int>(b)] = off_the_middle(kBands[b], kBands[b].value(constants));
    }
    return 0;
  }
};

}  // namespace

const std::array<FittedBand, kFittedBands>& fitted_bands() noexcept { return kBands; }

RealityRow row_of(Fitted band) {
  const FittedBand& b = kBands[static_cast<std::size_t>(band)];
  return {std::string(b.check), std::string(b.source) + " (fitted)", b.low, b.high, {}};
}

double off_the_middle(const FittedBand& band, double value) noexcept {
  return (2.0 * value - band.low - band.high) / (band.high - band.low);
}

SaturatingConstants fit_saturating_law() {
  // From anywhere near: square micrometres, metres a second, centimetres.
  Eigen::VectorXd logs = Eigen::Vector4d(1e-10, 5.0, 5.0, 2e-2).array().log();
  Eigen::NumericalDiff<Residuals> residuals;
  Eigen::LevenbergMarquardt<Eigen::NumericalDiff<Residuals>> minimiser(residuals);
  minimiser.parameters.xtol = minimiser.parameters.ftol = 1e-12;
  minimiser.minimize(logs);
  return constants_of(logs);
}

void print_fit() {
  const SaturatingConstants fitted = fit_saturating_law(), used;
  std::printf(
      "Minimised: the sum of d^2, d how far a value lies from the middle of its band, in "
      "halves of the band's width.\n\n%-52s %8s %8s %9s %7s  %s\n",
      "band", "low", "high", "value", "d^2", "source");
  double sum = 0.0;
  for (const FittedBand& band : kBands) {
    const double value = band.value(fitted), off = off_the_middle(band, value);
    std::printf("%-52s %8.4g %8.4g %9.4g %7.3f  %s\n", std::string(band.check).c_str(), band.low,
                band.high, value, off * off, std::string(band.source).c_str());
    sum += off * off;
  }
  std::printf("%-52s %8s %8s %9s %7.3f\n\n%-52s %9s %9s\n", "sum", "", "", "", sum, "constant",
              "fitted", "in use");
  const auto print = [](const char* name, double from_fit, double in_use) {
    std::printf("%-52s %9.4g %9.4g\n", name, from_fit, in_use);
  };
  print("A, grain area of a medium grit, um2", fitted.grain_area_m2 / 1e-12,
        used.grain_area_m2 / 1e-12);
  print("v0 of diamonds, m/s", fitted.diamond_m_per_s, used.diamond_m_per_s);
  print("v0 of carbide, m/s", fitted.carbide_m_per_s, used.carbide_m_per_s);
  print("L, wear length of a medium grit, mm", fitted.wear_length_m / kMillimetre,
        used.wear_length_m / kMillimetre);
  print("tangential ratio: the middle of 0.40 to 0.60", 0.5 * (0.40 + 0.60),
        kSaturatingTangentialRatio);
}

}  // namespace sulcus::lab
