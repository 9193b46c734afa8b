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

/// Calls `visit(place, squared)` with the places 0 to 7 along an edge and the squares of their
/// steps from `x`, from the end that is nearer on, as long as `squared` plus `rest` is less than
/// `best`.
template <class Visit>
void from_the_nearer_end(int x, int rest, const int& best, const Visit& visit) {
  const bool from_last = x > kLeafEdge / 2, beyond = x <= 0 || x >= kLeafEdge - 1;
  for (int n = 0; n < kLeafEdge; ++n) {
    const int place = from_last ? kLeafEdge - 1 - n : n;
    const int squared = square(x - place);
    if (squared + rest < best) {
      visit(place, squared);
    } else if (beyond) {
      return;  // the others are further
    }
  }
}

/// BVMinimize's question: how near does a voxel come?
struct FromVoxel {
  using Scalar = float;
  const VoxelSet& to;
  const Cell c;
  int best = std::numeric_limits<int>::max();

  float minimumOnVolume(const Box& box) const {  // NOLINT(readability-identifier-naming): Eigen's
    return box.squaredExteriorDistance(c.cast<float>());
  }
  float minimumOnObject(std::uint32_t leaf) {  // NOLINT(readability-identifier-naming): Eigen's
    best = nearer_in_leaf(c, to.grid().leaf_origin(leaf), to.voxels(leaf), best);
    return static_cast<float>(best);
  }
};

/// BVIntersect's: which leaves come so near?
struct WithinDistance {
  const Eigen::Vector3f c;
  const float distance;
  const VoxelGrid& grid;
  std::vector<LeafTree::Near>& leaves;

  bool intersectVolume(const Box& box) const {  // NOLINT(readability-identifier-naming): Eigen's
    return box.squaredExteriorDistance(c) <= distance * distance;
  }
  bool intersectObject(std::uint32_t leaf) {  // NOLINT(readability-identifier-naming): Eigen's
    const float nearest = leaf_box(grid, leaf).exteriorDistance(c);
    if (nearest <= distance) leaves.push_back({nearest, leaf, grid.leaf_origin(leaf)});
    return false;  // which is to go on
  }
};

}  // namespace

int nearer_in_leaf(const Cell& c, const Cell& first, const LeafBits& voxels, int best) {
  const Cell from = c - first;
  const auto beyond2 = [](int v) { return square(v - std::clamp(v, 0, kLeafEdge - 1)); };
  const int least_dx2 = beyond2(from.x()), least_dxy2 = least_dx2 + beyond2(from.y());
  from_the_nearer_end(from.z(), least_dxy2, best, [&](int k, int dz2) {
    const std::uint64_t slice = voxels.words[static_cast<std::size_t>(k)];
    if (slice == 0) return;
    from_the_nearer_end(from.y(), dz2 + least_dx2, best, [&](int j, int dy2) {
      const auto row = static_cast<unsigned>(slice >> (kLeafEdge * j) & 0xff);
      if (row == 0) return;
      best = std::min(best, dz2 + dy2 + square(steps_along_row(row, from.x())));
    });
  });
  return best;
}

LeafTree::LeafTree(const VoxelSet& set) : grid_(set.grid()) {
  const std::vector<Box> boxes = leaf_boxes(set);
  tree_.init(set.leaves().begin(), set.leaves().end(), boxes.begin(), boxes.end());
}

std::uint32_t LeafTree::squared_distance(const VoxelSet& set, const Cell& c) const {
  FromVoxel question{set, c};
  return static_cast<std::uint32_t>(Eigen::BVMinimize(tree_, question));
}

void LeafTree::leaves_within(const Cell& c, float distance, std::vector<Near>& leaves) const {
  leaves.clear();
  WithinDistance question{c.cast<float>(), distance, grid_, leaves};
  Eigen::BVIntersect(tree_, question);
  std::ranges::sort(leaves, {}, &Near::distance);
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
