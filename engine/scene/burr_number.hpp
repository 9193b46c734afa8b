#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/scene/scene.hpp"

namespace sulcus {

/// A shape number of ISO 6360-2 and which of our shapes it is.
struct BurrShapeNumber {
  std::string_view number;  // three digits
  BurrShape shape;
  double length_m;  // of the head; 0: it goes with the size, ours is taken
  std::string_view what;
  std::string_view source;
};

/// Those whose meaning is sourced, and no others, by number.
std::span<const BurrShapeNumber> burr_shape_numbers() noexcept;

/// What a number of ISO 6360 says of a burr's shape.
struct BurrNumber {
  BurrShape shape = BurrShape::kRound;
  double diameter_m = 0.0;
  std::optional<double> length_m;  // where the shape number says it
  // Of all 15 digits, where they are known.
  std::optional<BurrMaterial> material;
  std::optional<Grit> grit;  // of a diamond
  std::string unknown;       // the one of these two that is not known, "grit 494"
};

/// What is wrong with a number, for an InputError.
struct BurrNumberFault {
  std::string found, expected;
};

/// Reads "806 314 001 524 014": material, shank, shape, toothing or grit, size in tenths of a
/// millimetre; or shape and size alone, "001 014"; with spaces or without. Materials and grits that
/// are not known are no fault, and a carbide's toothing may be any; the shank is the friction
/// grip's, 313 to 316. Otherwise the fault.
std::optional<BurrNumber> read_burr_number(std::string_view text, BurrNumberFault& fault);

}  // namespace sulcus
