#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// How a quantity is shown in colours, and what its scale says beside the picture. Values beyond
/// the scale have the colour of its end.
struct ColourScale {
  enum class Kind : std::uint8_t {
    kRising,      // light to dark, every step darker than the one before, so that it reads in grey
    kDecades,     // the same by the logarithm: `low` above 0
    kAroundZero,  // blue, white at 0, orange: apart also to those who do not tell red from green
  };

  std::string name;          // with its unit
  double low = 0.0;          // SI
  double high = 1.0;         // SI, above `low`
  double unit = 1.0;         // what a 1 beside the scale is, SI
  std::string beyond_low{};  // words to the number at an end: "and less"
  std::string beyond_high{};
  std::string end_low{};  // in place of number and words: "not cut > 0.5 mm"
  std::string end_high{};
  Kind kind = Kind::kRising;
  bool inside = false;  // of voxels inside too, so that a section shows it
  bool unlit = false;   // drawn in its very colours, without light and shade

  bool operator==(const ColourScale&) const = default;
  /// Where on the scale a value is, 0 to 1.
  double part(double value) const;
  /// Linear RGB of a place on it.
  Eigen::Vector3f colour_at(double part) const;
  Eigen::Vector3f colour(double value) const { return colour_at(part(value)); }

  struct Mark {
    double part;
    std::string words;
  };
  /// What stands beside it, from its low end up.
  std::vector<Mark> marks() const;
};

/// The smallest of 1, 2, 5 times a power of ten that is not below `value`, which is above 0.
double round_number_above(double value);

}  // namespace sulcus
