#pragma once

#include <gtest/gtest.h>

#include "tests/support/colour_difference.hpp"
#include "tests/support/structural_similarity.hpp"

namespace sulcus::test {

/// How far pictures that look alike may differ. The same build on the same driver gives the same
/// bits; this leaves room for another driver's rounding and sampling of edges.
struct LooksLikeLimits {
  double mean_similarity = 0.99, worst_similarity = 0.9;
  double mean_colour = 0.5, worst_colour = 3.0;
};

/// Whether a picture looks like another of its size to an eye that overlooks a pixel: nothing
/// missing, nothing more, no other colour, no pattern.
inline ::testing::AssertionResult looks_like(const Image& image, const Image& reference,
                                             const LooksLikeLimits& limits = {}) {
  if (image.width != reference.width || image.height != reference.height) {
    return ::testing::AssertionFailure()
           << image.width << " x " << image.height << " pixels instead of " << reference.width
           << " x " << reference.height;
  }
  const Similarity structure = structural_similarity(image, reference);
  const ColourDifference colour = colour_difference(image, reference);
  const bool alike = structure.mean >= limits.mean_similarity &&
                     structure.worst >= limits.worst_similarity &&
                     colour.mean <= limits.mean_colour && colour.worst <= limits.worst_colour;
  return (alike ? ::testing::AssertionSuccess() : ::testing::AssertionFailure())
         << "structural similarity " << structure.mean << " in the mean (at least "
         << limits.mean_similarity << "), " << structure.worst << " in the worst square ("
         << limits.worst_similarity << "); colours differ by " << colour.mean
         << " in the mean (at most " << limits.mean_colour << "), " << colour.worst << " at most ("
         << limits.worst_colour << ")";
}

}  // namespace sulcus::test
