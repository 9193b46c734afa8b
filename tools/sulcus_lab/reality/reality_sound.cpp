#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "engine/core/units.hpp"
#include "engine/sound/handpiece_sound.hpp"
#include "tools/sulcus_lab/reality/cutting_rig.hpp"
#include "tools/sulcus_lab/reality/reality.hpp"

namespace sulcus::lab {

namespace {

/// Energy of the samples at a frequency, under a Hann window.
double energy_at(const std::vector<float>& samples, double hz) {
  double re = 0.0, im = 0.0;
  const auto count = static_cast<double>(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(i);
    const double weighed = (0.5 - 0.5 * std::cos(turn / count)) * static_cast<double>(samples[i]);
    re += weighed * std::cos(turn * hz / kSoundRate_hz);
    im -= weighed * std::sin(turn * hz / kSoundRate_hz);
  }
  return re * re + im * im;
}

/// Of a cut at 1 N with a turbine: the loudest frequency between half and one and a half of what
/// the burr turns a second, over that.
double first_line(CuttingLaw law, bool quick) {
  CuttingTrial trial;
  trial.law = law;
  if (quick) trial.voxel_mm = kQuickVoxel_mm;
  const double turns_hz = measure_cutting(trial).rpm / 60.0;
  constexpr double kSeconds = 0.25, kPower_W = 5.0, kEnamel_J_per_m3 = 3.5e9;
  std::vector<SoundTick> ticks;
  for (int i = 0; i <= 1000 * kSeconds; ++i) {
    ticks.push_back({1e-3 * i, 2.0 * std::numbers::pi * turns_hz, kPower_W, kEnamel_J_per_m3});
  }
  HandpieceSound sound(ticks, 0.0, kSeconds, 1);
  std::vector<float> samples(sound.count());
  sound.next(samples);
  double loudest_hz = 0.0, most = -1.0;
  constexpr double kBin_hz = 1.0 / kSeconds;
  for (double hz = 0.5 * turns_hz; hz <= 1.5 * turns_hz; hz += kBin_hz) {
    const double energy = energy_at(samples, hz);
    if (energy > most) most = energy, loudest_hz = hz;
  }
  return loudest_hz / turns_hz;
}

}  // namespace

std::vector<RealityRow> reality_sound(const RealityOptions& options) {
  options.progress("sound");
  return {{"first line of the sound over rpm / 60",
           "Zakeri 2010",
           0.99,
           1.01,
           {first_line(CuttingLaw::kPaper, options.quick),
            first_line(CuttingLaw::kSaturating, options.quick)}}};
}

}  // namespace sulcus::lab
