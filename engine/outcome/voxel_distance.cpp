#include "engine/outcome/voxel_distance.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "engine/core/parallel.hpp"

namespace sulcus {

namespace {

// Whole numbers below 2^24, so that float is exact.
using Box = Eigen::AlignedBox3f;

/// Of the centres of a leaf's voxels, not only of those in the set: a little too large, and cheap.
Box leaf_box(const VoxelGrid& grid, std::uint32_t leaf) {
  const Cell first = grid.leaf_origin(leaf);
  return {first.cast<float>(), (first + Cell::Constant(kLeafEdge - 1)).cast<float>()};
}

std::vector<Box> leaf_boxes(const VoxelSet& set) {
  std::vector<Box> boxes;
  boxes.reserve(set.leaves().size());
  for (const std::uint32_t leaf : set.leaves()) boxes.push_back(leaf_box(set.grid(), leaf));
  return boxes;
}

constexpr int square(int v) { return v * v; }

/// Steps from x to the nearest of a row of eight voxels, of which `row` (not 0) says which there
/// are.
int steps_along_row(unsigned row, int x) {
  if (x <= 0) return std::countr_zero(row) - x;
  if (x >= kLeafEdge - 1) return x - (std::bit_width(row) - 1);
  const unsigned upper = row >> x;
  const unsigned lower = row & ((2u << x) - 1);
  const int up = upper != 0 ? std::countr_zero(upper) : kLeafEdge;
  const int down = lower != 0 ? x - (std::bit_width(lower) - 1) : kLeafEdge;
  return std::min(up, down);
}

/// The lesser of `best` and the squared distance of `c` to the nearest voxel of a leaf that begins
/// at `first`.
int nearer(const Cell& c, const Cell& first, const LeafBits& voxels, int best) {
  const Cell from = c - first;
  const auto beyond2 = [](int v) { return square(v - std::clamp(v, 0, kLeafEdge - 1)); };
  const int least_dx2 = beyond2(from.x()), least_dxy2 = least_dx2 + beyond2(from.y());
  if (least_dxy2 + beyond2(from.z()) >= best) return best;
  for (int k = 0; k < kLeafEdge; ++k) {
    const std::uint64_t slice = voxels.words[static_cast<std::size_t>(k)];
    const int dz2 = square(from.z() - k);
    if (slice == 0 || dz2 + least_dxy2 >= best) continue;
    for (int j = 0; j < kLeafEdge; ++j) {
      const auto row = static_cast<unsigned>(slice >> (kLeafEdge * j) & 0xff);
      const int dyz2 = dz2 + square(from.y() - j);
      if (row == 0 || dyz2 + least_dx2 >= best) continue;
      best = std::min(best, dyz2 + square(steps_along_row(row, from.x())));
    }
  }
  return best;
}

/// How near does a voxel come? Asked by BVMinimize, which goes to the nearest boxes first, and by
/// BVIntersect, which goes to all that may be nearer than the best so far.
struct FromVoxel {
  using Scalar = float;
  const VoxelSet& to;
  const Cell c;
  int best = std::numeric_limits<int>::max();

  // NOLINTBEGIN(readability-identifier-naming): Eigen's names
  float minimumOnVolume(const Box& box) const {
    return box.squaredExteriorDistance(c.cast<float>());
  }
  float minimumOnObject(std::uint32_t leaf) {
    best = nearer(c, to.grid().leaf_origin(leaf), to.voxels(leaf), best);
    return static_cast<float>(best);
  }
  bool intersectVolume(const Box& box) const {
    return minimumOnVolume(box) < static_cast<float>(best);
  }
  bool intersectObject(std::uint32_t leaf) {
    minimumOnObject(leaf);
    return false;  // which is to go on
  }
  // NOLINTEND(readability-identifier-naming)
};

}  // namespace

LeafTree::LeafTree(const VoxelSet& set) {
  const std::vector<Box> boxes = leaf_boxes(set);
  tree_.init(set.leaves().begin(), set.leaves().end(), boxes.begin(), boxes.end());
}

std::uint32_t LeafTree::squared_distance(const VoxelSet& set, const Cell& c) const {
  FromVoxel question{set, c};
  return static_cast<std::uint32_t>(Eigen::BVMinimize(tree_, question));
}

std::uint32_t LeafTree::squared_distance(const VoxelSet& set, const Cell& c,
                                         std::uint32_t squared) const {
  FromVoxel question{set, c, static_cast<int>(squared)};
  Eigen::BVIntersect(tree_, question);
  return static_cast<std::uint32_t>(question.best);
}

std::vector<std::uint32_t> squared_distances(const VoxelSet& from, const VoxelSet& to) {
  if (from.count() == 0 || to.count() == 0) return {};
  const LeafTree tree(to);
  const std::span<const std::uint32_t> leaves = from.leaves();
  std::vector<std::size_t> begin{0};  // of each leaf's distances
  for (const std::uint32_t leaf : leaves) {
    begin.push_back(begin.back() + static_cast<std::size_t>(count_voxels(from.voxels(leaf))));
  }
  std::vector<std::uint32_t> distances(begin.back());
  parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t n) {
    const Cell first = from.grid().leaf_origin(leaves[n]);
    std::size_t at = begin[n];
    for_each_voxel(from.voxels(leaves[n]), [&](int place) {
      distances[at++] = tree.squared_distance(to, first + cell_in_leaf(place));
    });
  });
  return distances;
}

}  // namespace sulcus
