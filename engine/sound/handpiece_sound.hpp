#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace sulcus {

/// What of a tick makes its sound.
struct SoundTick {
  double time_s = 0.0;
  double spindle_rad_per_s = 0.0;
  double power_W = 0.0;  // of cutting
  /// Specific cutting energy of what was cut: how hard it is. 0: nothing was.
  double hardness_J_per_m3 = 0.0;
};

/// Samples of a second.
inline constexpr int kSoundRate_hz = 44100;

/// The sound of a handpiece at work, computed from what was recorded of it:
///
///   lines    at the burr's turns a second and its multiples, as loud as in a free turbine's
///            spectrum, with nothing above 20 kHz; they follow the speed as it sags
///   air      noise of the running handpiece, a quarter of the first line's energy
///   cutting  noise whose RMS follows the power of cutting, up to 20 W; duller the softer the
///   tissue
///
/// So the first line has between 28 and 85 % of all energy, as measured [Zakeri 2010; Sun 2013]. A
/// burr that stands is silent, to the bit. The same ticks and seed give the same samples.
class HandpieceSound {
 public:
  /// `ticks`: rising, not kept beyond its life. The first sample is at `begin_s`. Before the first
  /// tick and after `end_s` it is silent; between two it goes over from one to the other.
  HandpieceSound(std::span<const SoundTick> ticks, double begin_s, double end_s,
                 std::uint64_t seed);

  /// Samples up to `end_s`.
  std::uint64_t count() const { return count_; }
  /// The next samples, -1 to 1, as many as there are left and there is room for. Returns how many.
  std::size_t next(std::span<float> samples);

 private:
  struct Now {
    double spindle_rad_per_s, power_W, hardness_J_per_m3;
  };
  Now now(double time_s);
  float sample(double time_s);
  double noise();

  std::span<const SoundTick> ticks_;
  double begin_s_;
  std::uint64_t count_ = 0, done_ = 0;
  std::size_t tick_ = 0;  // the last before now
  std::mt19937_64 random_;
  // What is carried from sample to sample.
  double phase_rad_ = 0.0, power_W_ = 0.0, hardness_J_per_m3_ = 0.0;
  double air_ = 0.0, cutting_ = 0.0;  // of the low-pass filters
};

}  // namespace sulcus
