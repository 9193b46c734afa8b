#include "engine/import/volumes/tissue_values.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <tbb/parallel_for.h>

namespace sulcus {
namespace {

constexpr float kFar = 1e12f;  // squared steps; far above any lattice of ours, and exact in sums

/// Lower envelope of the parabolas f(q) + (x - q)^2 along one line, in place
/// [Felzenszwalb and Huttenlocher 2012].
class LineTransform {
 public:
  explicit LineTransform(int longest) : apex_(longest), border_(longest + 1), line_(longest) {}

  void run(float* values, std::ptrdiff_t stride, int count) {
    for (int q = 0; q < count; ++q) line_[q] = values[q * stride];
    int last = -1;
    for (int q = 0; q < count; ++q) {
      if (line_[q] >= kFar) continue;
      double from = -HUGE_VAL;
      while (last >= 0) {
        from = crossing(apex_[last], q);
        if (from > border_[last]) break;
        --last;
      }
      if (last < 0) from = -HUGE_VAL;
      apex_[++last] = q;
      border_[last] = from;
    }
    if (last < 0) return;
    int piece = 0;
    for (int x = 0; x < count; ++x) {
      while (piece < last && border_[piece + 1] < x) ++piece;
      const auto d = static_cast<float>(x - apex_[piece]);
      values[x * stride] = line_[apex_[piece]] + d * d;
    }
  }

 private:
  /// Where the parabola of the later apex falls below that of the earlier.
  double crossing(int earlier, int later) const {
    const double e = earlier, l = later;
    return ((line_[later] + l * l) - (line_[earlier] + e * e)) / (2.0 * (l - e));
  }

  std::vector<int> apex_;
  std::vector<double> border_;
  std::vector<float> line_;
};

/// Squared distance to the nearest point whose mark is `target`.
Lattice<float> squared_distance(const Lattice<std::uint8_t>& solid, std::uint8_t target) {
  Lattice<float> distance(solid.sizes, kFar);
  const Eigen::Vector3i n = solid.sizes;
  const std::ptrdiff_t row = n.x();
  const std::ptrdiff_t slice = row * n.y();
  float* values = distance.values.data();
  tbb::parallel_for(0, n.z(), [&](int k) {
    LineTransform transform(n.head<2>().maxCoeff());
    const std::size_t begin = distance.index(0, 0, k);
    for (std::size_t v = begin; v < begin + static_cast<std::size_t>(slice); ++v) {
      if (solid.values[v] == target) values[v] = 0.0f;
    }
    for (int j = 0; j < n.y(); ++j) transform.run(values + begin + j * row, 1, n.x());
    for (int i = 0; i < n.x(); ++i) transform.run(values + begin + i, row, n.y());
  });
  tbb::parallel_for(0, n.y(), [&](int j) {
    LineTransform transform(n.z());
    for (int i = 0; i < n.x(); ++i) transform.run(values + j * row + i, slice, n.z());
  });
  return distance;
}

/// Signed depth of every lattice point under the surface between solid points (1) and empty ones
/// (0), in lattice steps: from a solid point the distance to the nearest empty point less a half,
/// from an empty one minus that to the nearest solid point less a half. Exact, separable
/// [Felzenszwalb and Huttenlocher 2012]. Points of a lattice all solid (empty) get a large
/// positive (negative) depth.
Lattice<float> signed_depth(const Lattice<std::uint8_t>& solid) {
  Lattice<float> depth = squared_distance(solid, 0);
  const Lattice<float> outside = squared_distance(solid, 1);
  tbb::parallel_for(std::size_t{0}, depth.values.size(), [&](std::size_t v) {
    depth.values[v] = solid.values[v] != 0 ? std::sqrt(depth.values[v]) - 0.5f
                                           : 0.5f - std::sqrt(outside.values[v]);
  });
  return depth;
}

}  // namespace

Lattice<float> tissue_values(const Lattice<float>& grey, const Lattice<std::uint8_t>& solid) {
  // How far outside the surface values are wanted: the corners of a cell that it crosses.
  constexpr float kOutside = 2.5f;
  const Lattice<float> depth = signed_depth(solid);
  Lattice<float> values = grey;

  std::vector<std::size_t> shell;
  for (std::size_t v = 0; v < depth.values.size(); ++v) {
    if (depth.values[v] < kPartialVolumeDepth && depth.values[v] > -kOutside) shell.push_back(v);
  }
  // Deepest first: what a point takes its value from is then final.
  std::ranges::stable_sort(
      shell, [&](std::size_t a, std::size_t b) { return depth.values[a] > depth.values[b]; });

  const Eigen::Vector3i n = grey.sizes;
  for (const std::size_t v : shell) {
    const auto nx = static_cast<std::size_t>(n.x()), ny = static_cast<std::size_t>(n.y());
    const int i = static_cast<int>(v % nx), j = static_cast<int>(v / nx % ny),
              k = static_cast<int>(v / nx / ny);
    double sum = 0.0, weights = 0.0;
    for (int dk = -1; dk <= 1; ++dk) {
      for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) {
          if (!depth.contains(i + di, j + dj, k + dk)) continue;
          const std::size_t w = depth.index(i + di, j + dj, k + dk);
          const double rise = depth.values[w] - depth.values[v];
          if (rise <= 0.0) continue;
          // The fourth power keeps to the steepest way up and still averages equals.
          const double slope2 = rise * rise / (di * di + dj * dj + dk * dk);
          sum += slope2 * slope2 * values.values[w];
          weights += slope2 * slope2;
        }
      }
    }
    if (weights == 0.0) continue;  // the ridge of a part thinner than the shell
    const auto deeper = static_cast<float>(sum / weights);
    values.values[v] = solid.values[v] != 0 ? std::max(values.values[v], deeper) : deeper;
  }
  return values;
}

}  // namespace sulcus
