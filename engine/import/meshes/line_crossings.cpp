#include "engine/import/meshes/line_crossings.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace sulcus {
namespace {

// Lines run this much beside the voxel centres, in voxels, so that meshes made on a lattice have
// no edge or corner just on a line. Different, so that diagonals are missed as well.
constexpr double kBeside = 1.3e-6, kBesideOther = 2.9e-6;

/// Which side of the edge from u to v the line lies on, as twice an area: positive on the left.
/// Reckoned from the lower to the higher vertex, so that both triangles of an edge get the same
/// number and no line slips between them.
double side(const std::vector<Eigen::Vector3d>& positions, std::uint32_t u, std::uint32_t v, int b,
            int c, double pb, double pc) {
  const Eigen::Vector3d& low = positions[std::min(u, v)];
  const Eigen::Vector3d& high = positions[std::max(u, v)];
  const double twice_area = (high[b] - low[b]) * (pc - low[c]) - (high[c] - low[c]) * (pb - low[b]);
  return u < v ? twice_area : -twice_area;
}

/// Calls `visit` with line and crossing, triangle by triangle.
template <class Visit>
void for_each_crossing(const VoxelGrid& grid, int a, const std::vector<Eigen::Vector3d>& positions,
                       const std::vector<std::array<std::uint32_t, 3>>& triangles, Visit visit) {
  const int b_axis = (a + 1) % 3, c_axis = (a + 2) % 3;
  for (std::uint32_t triangle = 0; triangle < triangles.size(); ++triangle) {
    const auto& t = triangles[triangle];
    const std::array<const Eigen::Vector3d*, 3> p = {&positions[t[0]], &positions[t[1]],
                                                     &positions[t[2]]};
    const auto range = [&](int axis, double beside) {
      const double least = std::min({(*p[0])[axis], (*p[1])[axis], (*p[2])[axis]}) - beside;
      const double most = std::max({(*p[0])[axis], (*p[1])[axis], (*p[2])[axis]}) - beside;
      const double last = grid.cells[axis] - 1;
      // Clamped as numbers: a mesh far away would not fit an int.
      return std::array<int, 2>{static_cast<int>(std::clamp(std::ceil(least), 0.0, last + 1.0)),
                                static_cast<int>(std::clamp(std::floor(most), -1.0, last))};
    };
    const auto [b_from, b_to] = range(b_axis, kBeside);
    const auto [c_from, c_to] = range(c_axis, kBesideOther);
    for (int c = c_from; c <= c_to; ++c) {
      for (int b = b_from; b <= b_to; ++b) {
        const double pb = b + kBeside, pc = c + kBesideOther;
        const double e0 = side(positions, t[1], t[2], b_axis, c_axis, pb, pc);
        const double e1 = side(positions, t[2], t[0], b_axis, c_axis, pb, pc);
        const double e2 = side(positions, t[0], t[1], b_axis, c_axis, pb, pc);
        const bool left = e0 > 0 && e1 > 0 && e2 > 0;
        const bool right = e0 < 0 && e1 < 0 && e2 < 0;
        if (!left && !right) continue;
        const double at = (e0 * (*p[0])[a] + e1 * (*p[1])[a] + e2 * (*p[2])[a]) / (e0 + e1 + e2);
        const double end = grid.cells[a];
        const std::size_t line =
            static_cast<std::size_t>(b) +
            static_cast<std::size_t>(grid.cells[b_axis]) * static_cast<std::size_t>(c);
        // Counter-clockwise seen against the axis is a normal along it: the line leaves here.
        visit(line, LineCrossing{static_cast<int>(std::clamp(std::ceil(at), 0.0, end)),
                                 left ? -1 : 1, triangle});
      }
    }
  }
}

}  // namespace

LineCrossings::LineCrossings(const VoxelGrid& grid, int axis,
                             const std::vector<Eigen::Vector3d>& positions_index,
                             const std::vector<std::array<std::uint32_t, 3>>& triangles)
    : lines_b_(grid.cells[(axis + 1) % 3]) {
  // Sorted by their lines, by counting first.
  begin_.assign(
      static_cast<std::size_t>(lines_b_) * static_cast<std::size_t>(grid.cells[(axis + 2) % 3]) + 1,
      0);
  for_each_crossing(grid, axis, positions_index, triangles,
                    [&](std::size_t l, const LineCrossing&) { ++begin_[l + 1]; });
  for (std::size_t l = 1; l < begin_.size(); ++l) begin_[l] += begin_[l - 1];
  crossings_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for_each_crossing(grid, axis, positions_index, triangles,
                    [&](std::size_t l, const LineCrossing& x) { crossings_[next[l]++] = x; });
  tbb::parallel_for(std::size_t{1}, begin_.size(), [&](std::size_t l) {
    const auto from = crossings_.begin() + static_cast<std::ptrdiff_t>(begin_[l - 1]);
    const auto to = crossings_.begin() + static_cast<std::ptrdiff_t>(begin_[l]);
    std::sort(from, to, [](const auto& x, const auto& y) { return x.first < y.first; });
  });
}

}  // namespace sulcus
