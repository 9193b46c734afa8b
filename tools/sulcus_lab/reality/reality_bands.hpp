#pragma once

#include <array>
#include <string>

#include "haptics/cutting_law.hpp"
#include "tools/sulcus_lab/reality/reality.hpp"

namespace sulcus::lab {

/// A published band that the constants of the saturating law were fitted to.
struct FittedBand {
  std::string_view check, source;
  double low, high;
  /// What the law gives with some constants, in closed form: a burr of 1 mm in enamel.
  double (*value)(const SaturatingConstants& constants);
};

/// In the order of `reality_rates`, which measures them.
enum class Fitted : std::uint8_t {
  kSpeed,        // rate at 400,000 over that at 100,000 rpm, diamond
  kMediumLoad,   // rate at 2 N over that at 1 N
  kCoarseLoad,   // the same
  kCarbideBest,  // speed of the greatest rate, 1,000 rpm
  kMediumWear,   // rate after 39 mm over that of a new burr
};
inline constexpr std::size_t kFittedBands = 5;
const std::array<FittedBand, kFittedBands>& fitted_bands() noexcept;

/// A row of such a band, still without values.
RealityRow row_of(Fitted band);

/// How far a value lies from the middle of a band, in halves of its width: 1 is at its edge.
double off_the_middle(const FittedBand& band, double value) noexcept;

/// The constants that make the sum over the bands of off_the_middle^2 least.
SaturatingConstants fit_saturating_law();

/// Prints what is minimised, band by band, and the constants that come of it.
void print_fit();

}  // namespace sulcus::lab
