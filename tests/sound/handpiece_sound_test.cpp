#include "engine/sound/handpiece_sound.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <unsupported/Eigen/FFT>

#include "engine/core/units.hpp"

// Judged by spectra of another library's, Eigen's.

namespace sulcus::handpiece_sound_test {
namespace {

constexpr double kEnamel = 3.5e9, kDentine = 0.65e9;

std::vector<SoundTick> steady(double rpm, double power_W, double seconds,
                              double hardness = kEnamel) {
  std::vector<SoundTick> ticks;
  for (int i = 0; i <= std::lround(1e3 * seconds); ++i) {
    ticks.push_back({1e-3 * i, rpm * kRevolutionPerMinute, power_W, hardness});
  }
  return ticks;
}

std::vector<float> sound_of(const std::vector<SoundTick>& ticks, std::uint64_t seed = 1) {
  HandpieceSound sound(ticks, ticks.front().time_s, ticks.back().time_s, seed);
  std::vector<float> samples(sound.count());
  EXPECT_EQ(sound.next(samples), samples.size());
  return samples;
}

/// Energy by bin, under a Hann window, of the last `count` samples.
std::vector<double> spectrum(const std::vector<float>& samples, std::size_t count = 32768) {
  std::vector<double> windowed(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double turn =
        2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    windowed[i] =
        (0.5 - 0.5 * std::cos(turn)) * static_cast<double>(samples[samples.size() - count + i]);
  }
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> bins;
  fft.fwd(bins, windowed);
  std::vector<double> energy(count / 2);
  for (std::size_t i = 0; i < energy.size(); ++i) energy[i] = std::norm(bins[i]);
  return energy;
}

double bin_hz(const std::vector<double>& energy) {
  return kSoundRate_hz / (2.0 * static_cast<double>(energy.size()));
}

double peak_hz(const std::vector<double>& energy) {
  return bin_hz(energy) * static_cast<double>(std::ranges::max_element(energy) - energy.begin());
}

double share_near(const std::vector<double>& energy, double hz, double reach_hz) {
  double near = 0.0;
  for (std::size_t i = 0; i < energy.size(); ++i) {
    if (std::abs(static_cast<double>(i) * bin_hz(energy) - hz) <= reach_hz) near += energy[i];
  }
  return near / std::accumulate(energy.begin(), energy.end(), 0.0);
}

double rms(const std::vector<float>& samples) {
  double sum = 0.0;
  for (const float s : samples) sum += static_cast<double>(s) * static_cast<double>(s);
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

// Of a turbine, free and at two loads [Zakeri 2010; Sun 2013]; and of a motor.
TEST(HandpieceSound, TheFirstLineIsTheTurnsASecondAndHasItsShareOfTheEnergy) {
  struct Case {
    double rpm, power_W;
  };
  for (const Case& c : {Case{360e3, 0.0}, Case{322.2e3, 2.0}, Case{288.4e3, 8.0}, Case{180e3, 20.0},
                        Case{200e3, 100.0}, Case{40e3, 3.0}}) {
    const std::vector<double> energy = spectrum(sound_of(steady(c.rpm, c.power_W, 1.0)));
    const double peak = peak_hz(energy);
    EXPECT_NEAR(peak, c.rpm / 60.0, bin_hz(energy)) << c.rpm;
    EXPECT_GE(share_near(energy, peak, 128.0), 0.28) << c.rpm;
    EXPECT_LE(share_near(energy, peak, 128.0), 0.85) << c.rpm;
  }
}

TEST(HandpieceSound, ItsMultiplesAreThere) {
  const std::vector<double> energy = spectrum(sound_of(steady(290e3, 0.0, 1.0)));
  const double first = 290e3 / 60.0;
  for (const double times : {2.0, 3.0}) {
    const double there = share_near(energy, times * first, 10.0);
    EXPECT_GT(there, 20.0 * share_near(energy, (times - 0.4) * first, 10.0)) << times;
  }
}

TEST(HandpieceSound, ItFollowsTheSpeedAsItSags) {
  std::vector<SoundTick> ticks;
  for (int i = 0; i <= 3000; ++i) {
    const double rpm = i < 1000 ? 322e3 : i < 2000 ? 322e3 - 33.6 * (i - 1000) : 288.4e3;
    ticks.push_back({1e-3 * i, rpm * kRevolutionPerMinute, 5.0, kEnamel});
  }
  const std::vector<float> samples = sound_of(ticks);
  const auto until = [&](double end_s) {
    const auto end = static_cast<std::ptrdiff_t>(end_s * kSoundRate_hz);
    return std::vector<float>(samples.begin(), samples.begin() + end);
  };
  EXPECT_NEAR(peak_hz(spectrum(until(1.0))), 322e3 / 60.0, 2.0);
  EXPECT_NEAR(peak_hz(spectrum(until(1.55), 4096)), (322e3 - 0.504 * 33.6e3) / 60.0, 15.0);
  EXPECT_NEAR(peak_hz(spectrum(until(3.0))), 288.4e3 / 60.0, 2.0);
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto mean = [](const std::vector<double>& v) {
    return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
  };
  const double mean_a = mean(a), mean_b = mean(b);
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return ab / std::sqrt(aa * bb);
}

// Between the lines, whose places are known.
TEST(HandpieceSound, ItsNoiseFollowsThePower) {
  std::mt19937 random(5);
  std::vector<SoundTick> ticks;
  std::vector<double> powers, noises;
  for (int window = 0; window < 60; ++window) {
    const double power_W = 15.0 * static_cast<double>(random() % 1000) / 1000.0;
    powers.push_back(power_W);
    for (int i = 0; i < 100; ++i) {
      // As jagged as the ticks of a run are.
      const double jagged = 0.5 + static_cast<double>(random() % 1000) / 1000.0;
      ticks.push_back({1e-3 * static_cast<double>(ticks.size()), 300e3 * kRevolutionPerMinute,
                       power_W * jagged, kEnamel});
    }
  }
  const std::vector<float> samples = sound_of(ticks);
  for (std::size_t window = 0; window < powers.size(); ++window) {
    // Its last 4096 samples, of 4410.
    const auto end =
        static_cast<std::ptrdiff_t>(std::min<std::size_t>(4410 * (window + 1), samples.size()));
    const std::vector<double> energy =
        spectrum(std::vector<float>(samples.begin(), samples.begin() + end), 4096);
    double sum = 0.0;
    for (std::size_t i = 0; i < energy.size(); ++i) {
      const double of_line = std::remainder(static_cast<double>(i) * bin_hz(energy), 5000.0);
      if (std::abs(of_line) > 300.0 && i > 10) sum += energy[i];
    }
    noises.push_back(std::sqrt(sum));
  }
  EXPECT_GT(correlation(powers, noises), 0.9);
}

// As loud, and duller.
TEST(HandpieceSound, SofterTissueSoundsDuller) {
  const auto half_hz = [](double hardness) {  // of the noise, half of which is below it
    const std::vector<double> energy =
        spectrum(sound_of(steady(300e3, 15.0, 2.0, hardness)), 65536);
    std::vector<double> noise;
    for (std::size_t i = 0; i < energy.size(); ++i) {
      const double hz = static_cast<double>(i) * bin_hz(energy);
      const bool is_line = hz > 1000.0 && std::abs(std::remainder(hz, 5000.0)) <= 50.0;
      noise.push_back(is_line ? 0.0 : energy[i]);
    }
    const double all = std::accumulate(noise.begin(), noise.end(), 0.0);
    double sum = 0.0;
    std::size_t i = 0;
    while (sum < 0.5 * all) sum += noise[i++];
    return static_cast<double>(i) * bin_hz(energy);
  };
  EXPECT_GT(half_hz(kEnamel), 1.5 * half_hz(kDentine));
  EXPECT_GT(half_hz(kDentine), 1.2 * half_hz(0.25e9));
  const double enamel = rms(sound_of(steady(300e3, 15.0, 4.0, kEnamel)));
  const double dentine = rms(sound_of(steady(300e3, 15.0, 4.0, kDentine)));
  EXPECT_NEAR(dentine / enamel, 1.0, 0.05);
}

TEST(HandpieceSound, ABurrThatStandsIsSilent) {
  std::vector<SoundTick> ticks = steady(300e3, 10.0, 2.0);
  for (std::size_t i = 1000; i < ticks.size(); ++i) ticks[i].spindle_rad_per_s = 0.0;
  const std::vector<float> samples = sound_of(ticks);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > std::size_t{kSoundRate_hz} + 1) {
      ASSERT_EQ(samples[i], 0.0f) << i;
    }
  }
  EXPECT_GT(rms({samples.begin(), samples.begin() + kSoundRate_hz}), 0.05);
}

TEST(HandpieceSound, NothingIsAbove20kHz) {
  const std::vector<double> energy = spectrum(sound_of(steady(500e3, 0.0, 1.0)));
  EXPECT_NEAR(peak_hz(energy), 500e3 / 60.0, bin_hz(energy));
  // Three times its turns, 25 kHz, would be folded down to 19.1.
  EXPECT_LT(share_near(energy, kSoundRate_hz - 25000.0, 5.0), 1e-4);
}

TEST(HandpieceSound, ItStaysBelowFullScale) {
  for (const float s : sound_of(steady(300e3, 1000.0, 5.0))) ASSERT_LT(std::abs(s), 1.0f);
}

TEST(HandpieceSound, TheSameTicksAndSeedSoundTheSame) {
  const std::vector<SoundTick> ticks = steady(300e3, 8.0, 0.5);
  const std::vector<float> whole = sound_of(ticks);
  EXPECT_EQ(whole, sound_of(ticks));
  EXPECT_NE(whole, sound_of(ticks, 2));
  HandpieceSound in_parts(ticks, 0.0, 0.5, 1);
  std::vector<float> joined, part(777);
  while (const std::size_t count = in_parts.next(part)) {
    joined.insert(joined.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(count));
  }
  EXPECT_EQ(whole, joined);
}

TEST(HandpieceSound, BeforeTheFirstTickItIsSilent) {
  std::vector<SoundTick> ticks = steady(300e3, 8.0, 0.5);
  for (SoundTick& tick : ticks) tick.time_s += 1.0;
  HandpieceSound sound(ticks, 0.0, 1.5, 1);
  std::vector<float> samples(sound.count());
  sound.next(samples);
  EXPECT_EQ(samples.size(), std::size_t{66150});
  EXPECT_TRUE(
      std::all_of(samples.begin(), samples.begin() + 44000, [](float s) { return s == 0.0f; }));
  EXPECT_GT(rms({samples.begin() + 45000, samples.end()}), 0.05);
}

}  // namespace
}  // namespace sulcus::handpiece_sound_test
