#include "engine/import/ray_votes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <tbb/parallel_for.h>

namespace sulcus {
namespace {

// Lines run this much beside the voxel centres, in voxels, so that meshes made on a lattice have
// no edge or corner just on a line. Different, so that diagonals are missed as well.
constexpr double kBeside = 1.3e-6, kBesideOther = 2.9e-6;

/// From voxel `first` on along its line the winding number is higher by `step`.
struct Crossing {
  int first = 0;
  int step = 0;
};

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

class RayCaster {
 public:
  RayCaster(const VoxelGrid& grid, int axis, const std::vector<Eigen::Vector3d>& positions,
            const std::vector<std::array<std::uint32_t, 3>>& triangles)
      : grid_(grid),
        a_(axis),
        b_((axis + 1) % 3),
        c_((axis + 2) % 3),
        positions_(positions),
        triangles_(triangles) {}

  RayVotes cast() {
    collect();
    RayVotes votes;
    votes.axis = a_;
    votes.solid.resize(grid_.leaf_count());
    votes.unsound.assign(line_count(), 0);
    // Eight by eight lines share their leaves with no other: a column for each thread.
    const Eigen::Vector3i leaves = grid_.leaf_dims();
    tbb::parallel_for(0, leaves[b_] * leaves[c_], [&](int column) {
      const int b0 = column % leaves[b_] * kLeafEdge, c0 = column / leaves[b_] * kLeafEdge;
      for (int c = c0; c < c0 + kLeafEdge; ++c) {
        for (int b = b0; b < b0 + kLeafEdge; ++b) fill_line(b, c, votes);
      }
    });
    votes.all_sound = std::ranges::all_of(votes.unsound, [](auto u) { return u == 0; });
    return votes;
  }

 private:
  std::size_t line_count() const {
    return static_cast<std::size_t>(grid_.cells[b_]) * static_cast<std::size_t>(grid_.cells[c_]);
  }
  std::size_t line(int b, int c) const {
    return static_cast<std::size_t>(b) +
           static_cast<std::size_t>(grid_.cells[b_]) * static_cast<std::size_t>(c);
  }

  template <class Visit>
  void for_each_crossing(Visit visit) const {
    for (const auto& t : triangles_) {
      const std::array<const Eigen::Vector3d*, 3> p = {&positions_[t[0]], &positions_[t[1]],
                                                       &positions_[t[2]]};
      const auto range = [&](int axis, double beside) {
        const double least = std::min({(*p[0])[axis], (*p[1])[axis], (*p[2])[axis]}) - beside;
        const double most = std::max({(*p[0])[axis], (*p[1])[axis], (*p[2])[axis]}) - beside;
        const double last = grid_.cells[axis] - 1;
        // Clamped as numbers: a mesh far away would not fit an int.
        return std::array<int, 2>{static_cast<int>(std::clamp(std::ceil(least), 0.0, last + 1.0)),
                                  static_cast<int>(std::clamp(std::floor(most), -1.0, last))};
      };
      const auto [b_from, b_to] = range(b_, kBeside);
      const auto [c_from, c_to] = range(c_, kBesideOther);
      for (int c = c_from; c <= c_to; ++c) {
        for (int b = b_from; b <= b_to; ++b) {
          const double pb = b + kBeside, pc = c + kBesideOther;
          const double e0 = side(positions_, t[1], t[2], b_, c_, pb, pc);
          const double e1 = side(positions_, t[2], t[0], b_, c_, pb, pc);
          const double e2 = side(positions_, t[0], t[1], b_, c_, pb, pc);
          const bool left = e0 > 0 && e1 > 0 && e2 > 0;
          const bool right = e0 < 0 && e1 < 0 && e2 < 0;
          if (!left && !right) continue;
          const double at =
              (e0 * (*p[0])[a_] + e1 * (*p[1])[a_] + e2 * (*p[2])[a_]) / (e0 + e1 + e2);
          const double end = grid_.cells[a_];
          // Counter-clockwise seen against the axis is a normal along it: the line leaves here.
          visit(line(b, c),
                Crossing{static_cast<int>(std::clamp(std::ceil(at), 0.0, end)), left ? -1 : 1});
        }
      }
    }
  }

  /// Sorts the crossings by their lines, by counting first.
  void collect() {
    begin_.assign(line_count() + 1, 0);
    for_each_crossing([&](std::size_t l, const Crossing&) { ++begin_[l + 1]; });
    for (std::size_t l = 1; l < begin_.size(); ++l) begin_[l] += begin_[l - 1];
    crossings_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for_each_crossing([&](std::size_t l, const Crossing& x) { crossings_[next[l]++] = x; });
  }

  void fill_line(int b, int c, RayVotes& votes) {
    const std::size_t l = line(b, c);
    const auto from = crossings_.begin() + static_cast<std::ptrdiff_t>(begin_[l]);
    const auto to = crossings_.begin() + static_cast<std::ptrdiff_t>(begin_[l + 1]);
    if (from == to) return;
    std::sort(from, to, [](const Crossing& x, const Crossing& y) { return x.first < y.first; });
    int winding = 0;
    for (auto x = from; x != to; ++x) {
      winding += x->step;
      const int end = x + 1 != to ? (x + 1)->first : grid_.cells[a_];
      if (winding != 0) fill(b, c, x->first, end, votes);
    }
    votes.unsound[l] = winding != 0;
  }

  void fill(int b, int c, int begin, int end, RayVotes& votes) const {
    Cell cell;
    cell[b_] = b;
    cell[c_] = c;
    for (int a = begin; a < end; ++a) {
      cell[a_] = a;
      votes.solid[grid_.leaf_of(cell)].words[leaf_word(cell.z())] |=
          std::uint64_t{1} << leaf_bit(cell.x(), cell.y());
    }
  }

  const VoxelGrid& grid_;
  int a_, b_, c_;  // along the lines, and the two others in cyclic order
  const std::vector<Eigen::Vector3d>& positions_;
  const std::vector<std::array<std::uint32_t, 3>>& triangles_;
  std::vector<std::size_t> begin_;  // of each line's crossings
  std::vector<Crossing> crossings_;
};

}  // namespace

RayVotes cast_rays(const VoxelGrid& grid, int axis,
                   const std::vector<Eigen::Vector3d>& positions_index,
                   const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  return RayCaster(grid, axis, positions_index, triangles).cast();
}

}  // namespace sulcus
