#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// Neighbouring solid points along x: [begin, end) in row (j, k).
struct SolidRun {
  int begin = 0, end = 0;
  int j = 0, k = 0;
  std::uint32_t component = 0;
};

/// The 6-connected components of what is solid. Runs lie in the order of memory; components are
/// numbered in the order of their first run.
struct SolidComponents {
  std::vector<SolidRun> runs;
  std::vector<std::uint64_t> voxels;  // of each component

  /// The component with most voxels, the first of equals. There must be one.
  std::uint32_t largest() const;
};

/// Components of the points whose value is at least `least` (or above it, where `strictly`).
/// `values`: sizes.prod(), x fastest.
SolidComponents find_components(std::span<const float> values, const Eigen::Vector3i& sizes,
                                float least, bool strictly);

}  // namespace sulcus
