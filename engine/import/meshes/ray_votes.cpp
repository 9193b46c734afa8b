#include "engine/import/meshes/ray_votes.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

#include <tbb/parallel_for.h>

#include "engine/import/meshes/line_crossings.hpp"

namespace sulcus {
namespace {

class RayCaster {
 public:
  RayCaster(const VoxelGrid& grid, int axis, const LineCrossings& crossings)
      : grid_(grid), a_(axis), b_((axis + 1) % 3), c_((axis + 2) % 3), crossings_(crossings) {}

  RayVotes cast() {
    RayVotes votes;
    votes.axis = a_;
    votes.solid.resize(grid_.leaf_count());
    votes.unsound.assign(
        static_cast<std::size_t>(grid_.cells[b_]) * static_cast<std::size_t>(grid_.cells[c_]), 0);
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
  void fill_line(int b, int c, RayVotes& votes) const {
    const std::span<const LineCrossing> line = crossings_.of(b, c);
    if (line.empty()) return;
    int winding = 0;
    for (std::size_t x = 0; x < line.size(); ++x) {
      winding += line[x].step;
      const int end = x + 1 < line.size() ? line[x + 1].first : grid_.cells[a_];
      if (winding != 0) fill(b, c, line[x].first, end, votes);
    }
    Cell cell;
    cell[b_] = b;
    cell[c_] = c;
    cell[a_] = 0;
    votes.unsound[RayVotes::line(grid_, a_, cell)] = winding != 0;
  }

  void fill(int b, int c, int begin, int end, RayVotes& votes) const {
    Cell cell;
    cell[b_] = b;
    cell[c_] = c;
    for (int a = begin; a < end; ++a) {
      cell[a_] = a;
      votes.solid[grid_.leaf_of(cell)].set(leaf_place(cell));
    }
  }

  const VoxelGrid& grid_;
  int a_, b_, c_;  // along the lines, and the two others in cyclic order
  const LineCrossings& crossings_;
};

}  // namespace

RayVotes cast_rays(const VoxelGrid& grid, int axis,
                   const std::vector<Eigen::Vector3d>& positions_index,
                   const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  return RayCaster(grid, axis, LineCrossings(grid, axis, positions_index, triangles)).cast();
}

}  // namespace sulcus
