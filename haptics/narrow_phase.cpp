#include "haptics/narrow_phase.hpp"

#include <algorithm>
#include <bit>

#include "engine/core/fault.hpp"
#include "haptics/contact_kernels.hpp"

namespace sulcus {

namespace {

constexpr std::size_t kLeavesAhead = 8;  // so many leaves ahead their memory is asked for
constexpr std::size_t kGroup = Contacts::kGroup;
constexpr std::size_t kLeafVoxels = kLeafEdge * kLeafEdge * kLeafEdge;

std::size_t whole_groups(std::size_t count) { return (count + kGroup - 1) / kGroup * kGroup; }

/// Orders by distance, and by voxel where that is equal: a float's bits order like the float once
/// negative ones are turned over.
std::uint64_t depth_order(float distance_m, std::uint32_t key) {
  const auto bits = std::bit_cast<std::uint32_t>(distance_m);
  const std::uint32_t ordered = (bits >> 31) != 0 ? ~bits : bits | 0x80000000u;
  return std::uint64_t{ordered} << 32 | key;
}

/// Keeps the `count` deepest contacts, in the order that they have.
void keep_deepest(ContactScratch& scratch, std::size_t count) {
  Contacts& contacts = scratch.contacts;
  const auto order = [&](std::size_t i) {
    return depth_order(contacts(Contacts::kDistance)[i], contacts.keys()[i]);
  };
  scratch.by_depth.resize(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) scratch.by_depth[i] = order(i);
  const auto last = scratch.by_depth.begin() + static_cast<std::ptrdiff_t>(count - 1);
  std::nth_element(scratch.by_depth.begin(), last, scratch.by_depth.end());
  const std::uint64_t bound = *last;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (order(i) > bound) continue;
    contacts.keys()[kept] = contacts.keys()[i];
    contacts.tissues()[kept] = contacts.tissues()[i];
    *contacts.from(Contacts::kDistance, kept) = *contacts.from(Contacts::kDistance, i);
    contacts.set_vector(Contacts::kOutward, kept, contacts.vector(Contacts::kOutward, i));
    ++kept;
  }
  contacts.resize(kept);
}

}  // namespace

NarrowPhase::NarrowPhase(const Workpiece& workpiece, const DistanceField& field,
                         const Pose& world_from_tool, double reach_m, ContactScratch& scratch,
                         ContactResult& result) noexcept
    : workpiece_(workpiece),
      frame_(workpiece.grid(), field, world_from_tool, 0.0),
      reach_m_(static_cast<float>(reach_m)),
      // Half the diagonal between the outermost voxel centres of a leaf; between samples the field
      // may rise by a little more than the way.
      leaf_reach_m_(static_cast<float>(reach_m +
                                       3.5 * 1.7320508075688772 * workpiece.grid().voxel_m +
                                       0.25 * field.spacing_m())),
      scratch_(scratch),
      result_(result) {
  scratch.contacts.resize(0);
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

bool NarrowPhase::next() noexcept {
  const std::size_t count = scratch_.leaves.size();
  const TissueMap* const tissues = workpiece_.model().tissues.get();
  std::size_t waiting = 0;
  for (; leaf_ < count; ++leaf_) {
    const std::uint32_t ahead = scratch_.leaves[std::min(leaf_ + kLeavesAhead, count - 1)];
    __builtin_prefetch(&workpiece_.surface(ahead));
    if (tissues) tissues->prefetch(ahead);
    if (scratch_.leaf_distances_m[leaf_] > leaf_reach_m_) continue;
    if (waiting + kLeafVoxels > ContactScratch::kBlock) break;
    waiting += contact_kernels().leaf_keys(workpiece_.surface(scratch_.leaves[leaf_]),
                                           scratch_.leaf_keys[leaf_],
                                           scratch_.block_keys.data() + waiting);
  }
  if (waiting > 0) test(waiting);
  return leaf_ < count;
}

void NarrowPhase::test(std::size_t waiting) noexcept {
  Contacts& contacts = scratch_.contacts;
  std::uint32_t* const keys = scratch_.block_keys.data();
  std::fill(keys + waiting, keys + whole_groups(waiting), keys[0]);
  const std::size_t first = contacts.size();
  float* const outward[3] = {contacts.from(Contacts::kOutward, first),
                             contacts.from(Contacts::kOutward + 1, first),
                             contacts.from(Contacts::kOutward + 2, first)};
  const std::size_t found =
      contact_kernels().find_near(frame_, keys, waiting, reach_m_, contacts.keys() + first,
                                  contacts.from(Contacts::kDistance, first), outward);
  contacts.resize(first + found);
  label(first);
  result_.tested += static_cast<std::uint32_t>(waiting);
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

void narrow_phase(const Workpiece& workpiece, const DistanceField& field,
                  const Pose& world_from_tool, double reach_m, ContactScratch& scratch,
                  ContactResult& result) noexcept {
  NarrowPhase phase(workpiece, field, world_from_tool, reach_m, scratch, result);
  for (bool more = true; more;) {
    more = phase.next();
    if (scratch.contacts.size() <= scratch.capacity) continue;
    keep_deepest(scratch, scratch.capacity);
    result.faults |= kFaultContactsFull;
  }
}

}  // namespace sulcus
