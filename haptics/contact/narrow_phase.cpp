#include "haptics/contact/narrow_phase.hpp"

#include <algorithm>
#include <bit>

#include "haptics/contact/contact_kernels.hpp"

namespace sulcus {

namespace {

constexpr std::size_t kLeavesAhead = 8;  // so many leaves ahead their memory is asked for
constexpr std::size_t kGroup = Contacts::kGroup;
constexpr std::size_t kLeafVoxels = kLeafEdge * kLeafEdge * kLeafEdge;

std::size_t whole_groups(std::size_t count) { return (count + kGroup - 1) / kGroup * kGroup; }

}  // namespace

NarrowPhase::NarrowPhase(const Workpiece& workpiece, const DistanceField& field,
                         const Pose& world_from_tool, double reach_m,
                         ContactScratch& scratch) noexcept
    : workpiece_(workpiece),
      frame_(workpiece.grid(), field, world_from_tool, 0.0),
      reach_m_(static_cast<float>(reach_m)),
      // Half the diagonal between the outermost voxel centres of a leaf; between samples the field
      // may rise by a little more than the way.
      leaf_reach_m_(static_cast<float>(reach_m +
                                       3.5 * 1.7320508075688772 * workpiece.grid().voxel_m +
                                       0.25 * field.spacing_m())),
      scratch_(scratch) {
  begin();
  const std::size_t count = scratch.leaves.size();
  if (count == 0) return;
  scratch.leaf_keys.resize(whole_groups(count));
  scratch.leaf_distances_m.resize(whole_groups(count));
  for (std::size_t l = 0; l < scratch.leaf_keys.size(); ++l) {
    scratch.leaf_keys[l] =
        voxel_key(workpiece.grid().leaf_origin(scratch.leaves[std::min(l, count - 1)]));
  }
  contact_kernels().leaf_distances(frame_, scratch.leaf_keys.data(), scratch.leaf_keys.size(),
                                   scratch.leaf_distances_m.data());
}

void NarrowPhase::begin() noexcept {
  scratch_.contacts.clear();
  scratch_.block.clear();
  leaf_ = 0;
  tested_ = 0;
}

/// By distance, and by voxel where that is equal: a float's bits order like the float once negative
/// ones are turned over.
std::uint64_t NarrowPhase::depth_order(std::size_t contact) const noexcept {
  const float distance_m =
      scratch_.block(ContactBlock::kDistance)[contact - scratch_.block.first()];
  const auto bits = std::bit_cast<std::uint32_t>(distance_m);
  const std::uint32_t ordered = (bits >> 31) != 0 ? ~bits : bits | 0x80000000u;
  return std::uint64_t{ordered} << 32 | scratch_.contacts.keys()[contact];
}

void NarrowPhase::begin_with_deepest() noexcept {
  auto& orders = scratch_.by_depth;
  orders.clear();
  begin();
  for (bool more = true; more;) {
    more = next();
    for (std::size_t i = 0; i < scratch_.contacts.size(); ++i) orders.push_back(depth_order(i));
    scratch_.contacts.clear();
    if (orders.size() <= scratch_.capacity) continue;
    const auto last = orders.begin() + static_cast<std::ptrdiff_t>(scratch_.capacity - 1);
    std::nth_element(orders.begin(), last, orders.end());
    orders.resize(scratch_.capacity);
  }
  deepest_ = *std::max_element(orders.begin(), orders.end());
  begin();
}

bool NarrowPhase::next() noexcept {
  const std::size_t count = scratch_.leaves.size();
  const TissueMap* const tissues = workpiece_.model().tissues.get();
  std::size_t waiting = 0;
  for (; leaf_ < count; ++leaf_) {
    const std::uint32_t ahead = scratch_.leaves[std::min(leaf_ + kLeavesAhead, count - 1)];
    __builtin_prefetch(&workpiece_.surface(ahead));
    if (tissues) tissues->prefetch(ahead);
    if (scratch_.leaf_distances_m[leaf_] > leaf_reach_m_) continue;
    if (waiting + kLeafVoxels > ContactBlock::kVoxels) break;
    waiting += contact_kernels().leaf_keys(workpiece_.surface(scratch_.leaves[leaf_]),
                                           scratch_.leaf_keys[leaf_],
                                           scratch_.block_keys.data() + waiting);
  }
  if (waiting > 0) test(waiting);
  return leaf_ < count;
}

void NarrowPhase::test(std::size_t waiting) noexcept {
  Contacts& contacts = scratch_.contacts;
  ContactBlock& block = scratch_.block;
  std::uint32_t* const keys = scratch_.block_keys.data();
  std::fill(keys + waiting, keys + whole_groups(waiting), keys[0]);
  const std::size_t first = contacts.size(), at = first - block.first();
  float* const outward[3] = {block(ContactBlock::kOutward) + at,
                             block(ContactBlock::kOutward + 1) + at,
                             block(ContactBlock::kOutward + 2) + at};
  const std::size_t found =
      contact_kernels().find_near(frame_, keys, waiting, reach_m_, contacts.keys() + first,
                                  block(ContactBlock::kDistance) + at, outward);
  contacts.resize(deepest_ ? drop_shallow(first, first + found) : first + found);
  block.set_end(contacts.size());
  label(first);
  tested_ += static_cast<std::uint32_t>(waiting);
}

/// Of new contacts those that are not among the deepest. Returns the end of the others.
std::size_t NarrowPhase::drop_shallow(std::size_t first, std::size_t end) noexcept {
  ContactBlock& block = scratch_.block;
  std::uint32_t* const keys = scratch_.contacts.keys();
  std::size_t kept = first;
  for (std::size_t i = first; i < end; ++i) {
    if (depth_order(i) > *deepest_) continue;
    keys[kept] = keys[i];
    for (std::size_t q = ContactBlock::kDistance; q < ContactBlock::kOffset; ++q) {
      block(q)[kept - block.first()] = block(q)[i - block.first()];
    }
    ++kept;
  }
  return kept;
}

/// Tissues of contacts from `first` on, leaf by leaf.
void NarrowPhase::label(std::size_t first) noexcept {
  Contacts& contacts = scratch_.contacts;
  const std::size_t end = contacts.size();
  const TissueMap* const tissues = workpiece_.model().tissues.get();
  if (!tissues) {
    std::fill(contacts.tissues() + first, contacts.tissues() + end, std::uint8_t{0});
    return;
  }
  const std::uint32_t* const keys = contacts.keys();
  for (std::size_t i = first; i < end;) {
    const std::size_t begin = i;
    while (++i < end && leaf_key(keys[i]) == leaf_key(keys[begin])) {
    }
    const std::uint32_t leaf = workpiece_.grid().leaf_of(cell_of_key(keys[begin]));
    if (const LabelBlock* const block = tissues->block(leaf)) {
      for (std::size_t k = begin; k < i; ++k) {
        contacts.tissues()[k] = (*block)[static_cast<std::size_t>(leaf_place(keys[k]))];
      }
    } else {
      std::fill(contacts.tissues() + begin, contacts.tissues() + i, tissues->uniform_label(leaf));
    }
  }
}

}  // namespace sulcus
