#include "engine/sound/handpiece_sound.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/units.hpp"

namespace sulcus {

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kStep_s = 1.0 / kSoundRate_hz;

// Of full scale: lines and noise together stay below it.
constexpr double kFirstLine = 0.15;
// Of the lines at once, twice, three and four times the turns; ours, so that the line at twice them
// stands out, as above 9 kHz of a turbine's at 6 kHz [Zakeri 2010].
constexpr std::array kLines{1.0, 0.45, 0.3, 0.2};
constexpr double kFadesFrom_hz = 18e3, kSilentFrom_hz = 20e3;
// From here on it is as loud as it becomes.
constexpr double kLoudSpeed = 100e3 * kRevolutionPerMinute;

// Energies beside that of the first line; ours, within what was measured.
constexpr double kAirEnergy = 0.25;
constexpr double kAir_hz = 8e3;
constexpr double kPowerLikeLine_W = 15.0, kMostPower_W = 20.0;
constexpr double kSmoothing_s = 5e-3;
// Above this a tissue's noise falls off: of dentine, and rising with the root of the hardness;
// ours.
constexpr double kDentine_hz = 2.5e3, kDentine_J_per_m3 = 0.65e9;
constexpr double kDullest_hz = 300.0, kBrightest_hz = 12e3;

/// What a low-pass of one pole takes of a sample.
double part_of(double corner_hz) { return 1.0 - std::exp(-kTwoPi * corner_hz * kStep_s); }

/// One step of it, of noise of RMS 1; its own is 1 whatever the corner is.
double filtered(double noise, double part, double& state) {
  state += part * (noise - state);
  return state * std::sqrt((2.0 - part) / part);
}

}  // namespace

HandpieceSound::HandpieceSound(std::span<const SoundTick> ticks, double begin_s, double end_s,
                               std::uint64_t seed)
    : ticks_(ticks),
      begin_s_(begin_s),
      count_(static_cast<std::uint64_t>(std::max(0.0, std::round((end_s - begin_s) / kStep_s)))),
      random_(seed) {}

/// RMS 1, even.
double HandpieceSound::noise() {
  constexpr double kOf53Bits = 1.0 / 9007199254740992.0;
  const double even = static_cast<double>(random_() >> 11) * kOf53Bits;
  return std::sqrt(3.0) * (2.0 * even - 1.0);
}

HandpieceSound::Now HandpieceSound::now(double time_s) {
  if (ticks_.empty() || time_s < ticks_.front().time_s) return {};
  while (tick_ + 1 < ticks_.size() && ticks_[tick_ + 1].time_s <= time_s) ++tick_;
  const SoundTick& a = ticks_[tick_];
  const SoundTick& b = ticks_[std::min(tick_ + 1, ticks_.size() - 1)];
  const double between = b.time_s > a.time_s ? (time_s - a.time_s) / (b.time_s - a.time_s) : 0.0;
  const auto mixed = [&](double from, double to) { return from + between * (to - from); };
  return {mixed(a.spindle_rad_per_s, b.spindle_rad_per_s), mixed(a.power_W, b.power_W),
          a.hardness_J_per_m3};
}

float HandpieceSound::sample(double time_s) {
  const Now at = now(time_s);
  const double smoothing = part_of(1.0 / (kTwoPi * kSmoothing_s));
  power_W_ += smoothing * (std::clamp(at.power_W, 0.0, kMostPower_W) - power_W_);
  if (at.hardness_J_per_m3 > 0.0) {
    const double change = hardness_J_per_m3_ > 0.0 ? smoothing : 1.0;
    hardness_J_per_m3_ += change * (at.hardness_J_per_m3 - hardness_J_per_m3_);
  }
  const double loud = kFirstLine * std::clamp(at.spindle_rad_per_s / kLoudSpeed, 0.0, 1.0);
  phase_rad_ = std::fmod(phase_rad_ + at.spindle_rad_per_s * kStep_s, kTwoPi);
  double sum = 0.0;
  for (std::size_t line = 0; line < kLines.size(); ++line) {
    const double times = static_cast<double>(line + 1);
    const double hz = times * at.spindle_rad_per_s / kTwoPi;
    const double left = (kSilentFrom_hz - hz) / (kSilentFrom_hz - kFadesFrom_hz);
    sum += kLines[line] * std::clamp(left, 0.0, 1.0) * std::sin(times * phase_rad_);
  }
  const double bright_hz = std::clamp(
      kDentine_hz * std::sqrt(hardness_J_per_m3_ / kDentine_J_per_m3), kDullest_hz, kBrightest_hz);
  const double of_line = std::numbers::sqrt2 / 2.0;  // RMS of a line of amplitude 1
  sum += of_line * std::sqrt(kAirEnergy) * filtered(noise(), part_of(kAir_hz), air_);
  sum += of_line * power_W_ / kPowerLikeLine_W * filtered(noise(), part_of(bright_hz), cutting_);
  return static_cast<float>(loud * sum);
}

std::size_t HandpieceSound::next(std::span<float> samples) {
  const auto taken =
      static_cast<std::size_t>(std::min<std::uint64_t>(samples.size(), count_ - done_));
  for (std::size_t i = 0; i < taken; ++i, ++done_) {
    samples[i] = sample(begin_s_ + static_cast<double>(done_) * kStep_s);
  }
  return taken;
}

}  // namespace sulcus
