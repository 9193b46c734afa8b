#include "engine/volume/octree.hpp"

#include <algorithm>
#include <bit>

#include "engine/core/parallel.hpp"

namespace sulcus {

namespace {

/// Status and bounds of a leaf from its bits.
OctreeNode leaf_node(const LeafBits& bits, const Cell& origin) {
  std::uint64_t any = 0, all = ~std::uint64_t{0};
  int k_lower = 8, k_upper = 0;
  for (int k = 0; k < 8; ++k) {
    const std::uint64_t word = bits.words[k];
    any |= word;
    all &= word;
    if (word != 0) {
      k_lower = std::min(k_lower, k);
      k_upper = k + 1;
    }
  }
  OctreeNode node;
  if (any == 0) return node;
  std::uint64_t row = any;  // bits of x where any y is solid, folded into the low byte
  for (int shift : {32, 16, 8}) row |= row >> shift;
  row &= 0xff;
  const std::array<int, 3> lower{std::countr_zero(row), std::countr_zero(any) / 8, k_lower};
  const std::array<int, 3> upper{64 - std::countl_zero(row), (63 - std::countl_zero(any)) / 8 + 1,
                                 k_upper};
  for (int a = 0; a < 3; ++a) {
    node.lower[a] = static_cast<std::uint16_t>(origin[a] + lower[a]);
    node.upper[a] = static_cast<std::uint16_t>(origin[a] + upper[a]);
  }
  node.status = all == ~std::uint64_t{0} ? ChildStatus::kFull : ChildStatus::kSome;
  return node;
}

}  // namespace

Octree::Octree(const VoxelModel& model) {
  // From the leaves up to a level of one node, then the levels in order from the root.
  for (Eigen::Vector3i n = model.grid.leaf_dims();; n = (n.array() + 1) / 2) {
    dims_.insert(dims_.begin(), n);
    if ((n.array() == 1).all()) break;
  }
  std::uint32_t total = 0;
  for (const Eigen::Vector3i& n : dims_) {
    begin_.push_back(total);
    total += static_cast<std::uint32_t>(n.prod());
  }
  nodes_.resize(total);

  parallel_ranges<std::uint32_t>(
      0, model.grid.leaf_count(), 4096, [&](std::uint32_t low, std::uint32_t high) {
        for (std::uint32_t leaf = low; leaf != high; ++leaf) {
          nodes_[begin_.back() + leaf] =
              leaf_node(model.leaves[leaf], model.grid.leaf_origin(leaf));
        }
      });
  for (int level = levels() - 2; level >= 0; --level) {
    parallel_for(0, dims_[level].z(), [&](int z) { join_children(level, z); });
  }
}

void Octree::join_children(int level, int z) {
  const Eigen::Vector3i n = dims_[level];
  const Eigen::Vector3i n_child = dims_[level + 1];
  for (int y = 0; y < n.y(); ++y) {
    for (int x = 0; x < n.x(); ++x) {
      OctreeNode& node = nodes_[index({level, {x, y, z}})];
      int present = 0;
      for (int c = 0; c < 8; ++c) {
        const Eigen::Vector3i at(2 * x + (c & 1), 2 * y + (c >> 1 & 1), 2 * z + (c >> 2));
        if ((at.array() >= n_child.array()).any()) continue;
        const OctreeNode& child = nodes_[index({level + 1, at})];
        if (child.status == ChildStatus::kNone) continue;
        for (int a = 0; a < 3; ++a) {
          node.lower[a] = present ? std::min(node.lower[a], child.lower[a]) : child.lower[a];
          node.upper[a] = present ? std::max(node.upper[a], child.upper[a]) : child.upper[a];
        }
        ++present;
      }
      node.status = present == 0   ? ChildStatus::kNone
                    : present == 8 ? ChildStatus::kFull
                                   : ChildStatus::kSome;
    }
  }
}

}  // namespace sulcus
