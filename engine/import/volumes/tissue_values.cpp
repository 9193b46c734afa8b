#include "engine/import/volumes/tissue_values.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/import/volumes/distance_transform.hpp"

namespace sulcus {

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
