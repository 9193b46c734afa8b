#include "engine/volume/workpiece.hpp"

#include <algorithm>
#include <vector>

#include "engine/core/hash.hpp"
#include "engine/core/parallel.hpp"

namespace sulcus {

namespace {

constexpr LeafBits kEmptyLeaf{};
constexpr std::uint32_t kLeavesOfPage = 4096 / sizeof(LeafBits);

/// What a voxel that is not full adds to the hash of the shape.
std::uint64_t level_hash(std::uint64_t voxel, FillLevel level) noexcept {
  return level % kFullLevel == 0 ? 0 : mix64((voxel << 8 | level) * 0x9e3779b97f4a7c15u);
}

}  // namespace

LeafBits surface_of_leaf(const VoxelModel& model, std::uint32_t leaf) {
  const Eigen::Vector3i n = model.grid.leaf_dims();
  const Cell at = model.grid.leaf_origin(leaf) / kLeafEdge;
  const auto neighbour = [&](int axis, int step) -> const LeafBits& {
    const int to = at[axis] + step;
    if (to < 0 || to >= n[axis]) return kEmptyLeaf;
    const int stride = axis == 0 ? 1 : axis == 1 ? n.x() : n.x() * n.y();
    return model.leaves[static_cast<std::size_t>(static_cast<int>(leaf) + step * stride)];
  };
  const LeafBits& self = model.leaves[leaf];
  const LeafBits &xm = neighbour(0, -1), &xp = neighbour(0, 1);
  const LeafBits &ym = neighbour(1, -1), &yp = neighbour(1, 1);
  const LeafBits &zm = neighbour(2, -1), &zp = neighbour(2, 1);
  LeafBits surface;
  for (int k = 0; k < 8; ++k) {
    const std::uint64_t w = self.words[k];
    // Bit by bit, the neighbour in each of the six directions.
    const std::uint64_t from_xm = (w << 1 & ~kColumn0) | (xm.words[k] >> 7 & kColumn0);
    const std::uint64_t from_xp = (w >> 1 & ~kColumn7) | (xp.words[k] << 7 & kColumn7);
    const std::uint64_t from_ym = w << 8 | ym.words[k] >> 56;
    const std::uint64_t from_yp = w >> 8 | yp.words[k] << 56;
    const std::uint64_t from_zm = k > 0 ? self.words[k - 1] : zm.words[7];
    const std::uint64_t from_zp = k < 7 ? self.words[k + 1] : zp.words[0];
    surface.words[k] = w & ~(from_xm & from_xp & from_ym & from_yp & from_zm & from_zp);
  }
  return surface;
}

Workpiece::Workpiece(VoxelModel model)
    : model_(std::move(model)), surface_(model_.leaves.size()), octree_(model_), columns_(model_) {
  struct Sums {
    std::uint64_t solid = 0, surface = 0, hash = 0, pages = 0;
  };
  constexpr std::uint32_t kBlock = 64 * kLeavesOfPage;
  std::vector<Sums> blocks((grid().leaf_count() + kBlock - 1) / kBlock);
  parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
    Sums& sum = blocks[block];
    const auto first = static_cast<std::uint32_t>(block) * kBlock;
    const std::uint32_t end = std::min(first + kBlock, grid().leaf_count());
    std::uint32_t of_next_page = first;
    for (std::uint32_t leaf = first; leaf != end; ++leaf) {
      if (model_.leaves[leaf] == kEmptyLeaf) continue;
      if (leaf >= of_next_page) {
        of_next_page = (leaf / kLeavesOfPage + 1) * kLeavesOfPage;
        ++sum.pages;
      }
      // Also where there is none: the page is there before a cut comes to it.
      surface_[leaf] = surface_of_leaf(model_, leaf);
      sum.solid += static_cast<std::uint64_t>(count_voxels(model_.leaves[leaf]));
      sum.surface += static_cast<std::uint64_t>(count_voxels(surface_[leaf]));
      sum.hash ^= leaf_hash(leaf);
    }
  });
  hash_ = fills_hash();
  for (const Sums& sum : blocks) {
    solid_voxels_ += sum.solid;
    surface_voxels_ += sum.surface;
    hash_ ^= sum.hash;
    leaf_pages_ += sum.pages;
  }
}

std::uint64_t Workpiece::fills_hash() const noexcept {
  std::uint64_t hash = 0;
  if (!model_.fills) return hash;
  for (const LeafLevels& page : model_.fills->pages()) {
    for (std::size_t place = 0; place < page.levels.size(); ++place) {
      hash ^= level_hash(std::uint64_t{page.leaf} << 9 | place, page.levels[place]);
    }
  }
  return hash;
}

bool Workpiece::is_surface(const Cell& c) const {
  return grid().contains(c) && surface_[grid().leaf_of(c)].has(leaf_place(c));
}

std::uint64_t Workpiece::leaf_hash(std::uint32_t leaf) const noexcept {
  const LeafBits& bits = model_.leaves[leaf];
  return bits == kEmptyLeaf ? 0 : hash_bytes(bits.words.data(), sizeof(bits.words), leaf + 1u);
}

std::uint64_t Workpiece::hash_with_tissues() const {
  std::uint64_t hash = hash_;
  if (!model_.tissues) return hash;
  for (std::uint32_t leaf = 0; leaf < grid().leaf_count(); ++leaf) {
    if (model_.leaves[leaf] == kEmptyLeaf) continue;
    const LabelBlock* block = model_.tissues->block(leaf);
    const std::uint8_t uniform = model_.tissues->uniform_label(leaf);
    hash ^= block ? hash_bytes(block->data(), block->size(), ~std::uint64_t{leaf})
                  : hash_bytes(&uniform, 1, ~std::uint64_t{leaf});
  }
  return hash;
}

void Workpiece::expose(const Cell& c) noexcept {
  if (!model_.solid(c)) return;
  LeafBits& surface = surface_[grid().leaf_of(c)];
  if (!surface.has(leaf_place(c))) ++surface_voxels_;
  surface.set(leaf_place(c));
}

void Workpiece::reserve_fills(std::uint32_t leaves) {
  if (model_.fills) model_.fills->reserve(leaves);
}

bool Workpiece::set_level(const Cell& c, FillLevel level) noexcept {
  const std::uint64_t voxel = std::uint64_t{grid().leaf_of(c)} << 9 | unsigned(leaf_place(c));
  const FillLevel was = model_.level(c);
  if (!model_.set_level(c, level)) return false;
  hash_ ^= level_hash(voxel, was) ^ level_hash(voxel, level);
  return true;
}

void Workpiece::remove(const Cell& c) noexcept {
  const std::uint32_t leaf = grid().leaf_of(c);
  if (has_fills())
    hash_ ^= level_hash(std::uint64_t{leaf} << 9 | unsigned(leaf_place(c)), level(c));
  hash_ ^= leaf_hash(leaf);
  model_.set_level(c, 0);
  hash_ ^= leaf_hash(leaf);
  columns_.clear(c);
  --solid_voxels_;

  LeafBits& surface = surface_[leaf];
  if (surface.has(leaf_place(c))) --surface_voxels_;
  surface.reset(leaf_place(c));
  for (int axis = 0; axis < 3; ++axis) {
    expose(c + Cell::Unit(axis));
    expose(c - Cell::Unit(axis));
  }
  octree_.set_leaf_status(
      leaf, model_.leaves[leaf] == kEmptyLeaf ? ChildStatus::kNone : ChildStatus::kSome);
}

void Workpiece::update_surface(const Cell& c) noexcept {
  if (!grid().contains(c)) return;
  bool exposed = false;
  for (int axis = 0; axis < 3; ++axis) {
    exposed |= !model_.solid(c + Cell::Unit(axis)) || !model_.solid(c - Cell::Unit(axis));
  }
  LeafBits& surface = surface_[grid().leaf_of(c)];
  const bool was = surface.has(leaf_place(c)), is = model_.solid(c) && exposed;
  if (was == is) return;
  is ? surface.set(leaf_place(c)) : surface.reset(leaf_place(c));
  is ? ++surface_voxels_ : --surface_voxels_;
}

void Workpiece::put_back(const Cell& c, FillLevel level) noexcept {
  const std::uint32_t leaf = grid().leaf_of(c);
  hash_ ^= leaf_hash(leaf);
  model_.set_level(c, level);
  hash_ ^= leaf_hash(leaf);
  if (has_fills()) hash_ ^= level_hash(std::uint64_t{leaf} << 9 | unsigned(leaf_place(c)), level);
  columns_.set(c);
  ++solid_voxels_;
  update_surface(c);
  for (int axis = 0; axis < 3; ++axis) {
    update_surface(c + Cell::Unit(axis));
    update_surface(c - Cell::Unit(axis));
  }
  const bool full =
      std::ranges::all_of(model_.leaves[leaf].words, [](std::uint64_t word) { return ~word == 0; });
  octree_.switch_on(c / kLeafEdge, full ? ChildStatus::kFull : ChildStatus::kSome);
}

std::size_t Workpiece::memory_bytes() const {
  const std::size_t leaves_bytes = leaf_pages_ * kLeavesOfPage * sizeof(LeafBits);
  return 2 * leaves_bytes + octree_.memory_bytes() + columns_.memory_bytes() +
         (model_.fills ? model_.fills->memory_bytes() : 0) +
         (model_.tissues ? model_.tissues->memory_bytes() : 0);
}

}  // namespace sulcus
