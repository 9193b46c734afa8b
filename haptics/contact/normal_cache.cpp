#include "haptics/contact/normal_cache.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/core/hash.hpp"
#include "engine/normals/height_map.hpp"
#include "haptics/contact/open_addressing.hpp"

namespace sulcus {

namespace {

constexpr int kWindowHalfLength = 17;  // voxels along a map's axis: a column's window and one more
constexpr int kCoarseRadius = 2;       // voxels that a coarse normal is found from
constexpr std::uint32_t kContactsPerLeaf = 16;  // for sizing: contacts per cached leaf
// A leaf without a contact for so many ticks may be evicted, so that a long run takes no more
// memory than its last seconds need. Probes for one depend on the tick alone, so that eviction
// needs no saved state.
constexpr std::uint64_t kEvictAfterTicks = 4'000;
constexpr std::uint32_t kEvictionProbes = 16;
constexpr std::size_t kListed = 64;     // of the pages untouched longest
constexpr std::size_t kPagesAhead = 8;  // so many pages ahead their memory is asked for

/// Voxels of a leaf's slice with x and y in the ranges, 0 to 7, ends included.
std::uint64_t slice(int x0, int x1, int y0, int y1) {
  const std::uint64_t row = (0xffu >> (7 - (x1 - x0))) << x0;
  const std::uint64_t rows = 0x0101010101010101u >> (8 * (7 - (y1 - y0))) << (8 * y0);
  return row * rows;
}

}  // namespace

NormalCache::NormalCache(const VoxelGrid& grid, const HapticsSettings& settings)
    : grid_(grid),
      across_(std::max(settings.neighbourhood, kCoarseRadius)),
      wide_(has_wide_maps(settings.neighbourhood) ? 2 * across_ : 0),
      capacity_(
          std::max(64u, static_cast<std::uint32_t>(settings.max_contacts) / kContactsPerLeaf)),
      pages_(std::make_unique_for_overwrite<Page[]>(capacity_)),
      table_(std::bit_ceil(std::size_t{2} * capacity_)) {
  old_.reserve(kListed);
}

std::size_t NormalCache::home(std::uint32_t leaf) const noexcept {
  return (leaf * std::uint64_t{0x9e3779b97f4a7c15}) >> 32 & (table_.size() - 1);
}

std::size_t NormalCache::slot_of(std::uint32_t leaf) const noexcept {
  std::size_t slot = home(leaf);
  while (table_[slot].page_plus_1 != 0 && table_[slot].leaf != leaf) {
    slot = (slot + 1) & (table_.size() - 1);
  }
  return slot;
}

const NormalCache::Page* NormalCache::find(std::uint32_t leaf) const noexcept {
  const std::uint32_t entry = table_[slot_of(leaf)].page_plus_1;
  return entry == 0 ? nullptr : &pages_[entry - 1];
}

NormalCache::Page* NormalCache::page(std::uint32_t leaf) noexcept {
  const std::uint32_t entry = table_[slot_of(leaf)].page_plus_1;
  return entry == 0 ? nullptr : &pages_[entry - 1];
}

std::uint32_t NormalCache::long_untouched(std::uint64_t tick) const noexcept {
  for (std::uint32_t look = 0; look < std::min(kEvictionProbes, used_); ++look) {
    const auto at = static_cast<std::uint32_t>(mix64(kEvictionProbes * tick + look) % used_);
    if (pages_[at].touched + kEvictAfterTicks < tick) return at;
  }
  return used_;
}

/// A page's last tick only grows. So of a list of the oldest pages, in order, the first one that is
/// unchanged is still the oldest. All pages are searched once for many evictions, and not again in
/// a tick that uses all of them.
std::uint32_t NormalCache::longest_untouched(std::uint64_t tick) noexcept {
  if (all_touched_ == tick) return capacity_;
  for (; next_old_ < old_.size(); ++next_old_) {
    const Old& old = old_[next_old_];
    if (old.touched >= listed_) break;  // others may have been touched in that tick since
    if (pages_[old.page].touched == old.touched) return old.page;
  }
  old_.clear();
  const auto before = [](const Old& a, const Old& b) {
    return std::pair(a.touched, a.page) < std::pair(b.touched, b.page);
  };
  for (std::uint32_t page = 0; page < capacity_; ++page) {
    const Old old{pages_[page].touched, page};
    if (old_.size() == kListed && !before(old, old_.front())) continue;
    if (old_.size() == kListed) {
      std::pop_heap(old_.begin(), old_.end(), before);
      old_.pop_back();
    }
    old_.push_back(old);
    std::push_heap(old_.begin(), old_.end(), before);
  }
  std::sort_heap(old_.begin(), old_.end(), before);
  next_old_ = 0;
  listed_ = tick;
  if (old_.front().touched < tick) return old_.front().page;
  all_touched_ = tick;
  return capacity_;
}

NormalCache::Page* NormalCache::make_page(std::uint32_t leaf, std::uint64_t tick) noexcept {
  std::uint32_t at = long_untouched(tick);
  if (at == used_ && used_ == capacity_) {
    at = longest_untouched(tick);
    if (at == capacity_) return nullptr;  // all are in use
  }
  if (at < used_) evict(at);
  return &set_page(at, leaf, tick);
}

NormalCache::Page& NormalCache::set_page(std::uint32_t at, std::uint32_t leaf,
                                         std::uint64_t tick) noexcept {
  used_ = std::max(used_, at + 1);
  Page& page = pages_[at];
  page.first_key = leaf;
  page.touched = tick;
  page.kept = page.wide_window = {};
  page.window_axis = {};
  table_[slot_of(leaf)] = {leaf, at + 1};
  return page;
}

void NormalCache::clear() noexcept {
  std::ranges::fill(table_, Slot{});
  used_ = 0;
  old_.clear();
  next_old_ = 0;
  all_touched_.reset();
}

void NormalCache::evict(std::uint32_t at) noexcept {
  close_gap(
      slot_of(pages_[at].first_key), table_.size(),
      [&](std::size_t slot) { return table_[slot].page_plus_1 != 0; },
      [&](std::size_t slot) { return home(table_[slot].leaf); },
      [&](std::size_t to, std::size_t from) {
        table_[to] = from == kNoSlot ? Slot{} : table_[from];
      });
}

void NormalCache::keep(std::uint32_t key, const SurfaceEstimate& estimate,
                       std::uint64_t tick) noexcept {
  if (!estimate.defined) return;
  const std::uint32_t leaf = leaf_key(key);
  Page* p = page(leaf);
  if (!p) p = make_page(leaf, tick);
  if (!p) return;
  const int place = leaf_place(key);
  const auto word = static_cast<std::size_t>(place >> 6);
  const std::uint64_t bit = std::uint64_t{1} << (place & 63);
  const auto set = [&](Mask& mask, bool value) {
    mask[word] = value ? mask[word] | bit : mask[word] & ~bit;
  };
  set(p->kept, true);
  for (std::size_t axis = 0; axis < 3; ++axis)
    set(p->window_axis[axis], estimate.looked_along(axis));
  set(p->wide_window, estimate.looked_wide());
  p->values[static_cast<std::size_t>(place)] = {
      {estimate.normal.x(), estimate.normal.y(), estimate.normal.z()}, estimate.offset};
}

void NormalCache::mark_used(std::span<const Place> places, std::uint64_t tick) noexcept {
  for (std::size_t i = 0; i < places.size(); ++i) {
    __builtin_prefetch(&pages_[places[std::min(i + kPagesAhead, places.size() - 1)].page].touched,
                       1);
    Page& there = pages_[places[i].page];
    if (there.first_key == places[i].leaf) {
      there.touched = tick;
    } else if (Page* const moved = page(places[i].leaf)) {
      moved->touched = tick;
    }
  }
}

void NormalCache::drop_box(const Cell& lower, const Cell& upper) noexcept {
  const auto widened = [&](const Cell& reach) {
    return CellBox{(lower - reach).cwiseMax(0),
                   (upper + reach).cwiseMin(grid_.cells - Cell::Ones())};
  };
  const auto window = [&](int axis, int across) {
    Cell reach = Cell::Constant(across);
    reach[axis] = kWindowHalfLength;
    return widened(reach);
  };
  // Each leaf that any window reaches is looked up once.
  const CellBox all = widened(Cell::Constant(std::max(kWindowHalfLength, wide_)));
  for (int z = all.first.z() & ~7; z <= all.last.z(); z += 8) {
    for (int y = all.first.y() & ~7; y <= all.last.y(); y += 8) {
      for (int x = all.first.x() & ~7; x <= all.last.x(); x += 8) {
        Page* const p = page(voxel_key(x, y, z));
        if (!p) continue;
        for (int axis = 0; axis < 3; ++axis) {
          drop_window(*p, axis, window(axis, across_), Window::kNarrow);
          if (wide_ > 0) drop_window(*p, axis, window(axis, wide_), Window::kWide);
        }
      }
    }
  }
}

void NormalCache::drop_window(Page& page, int axis, const CellBox& box, Window window) noexcept {
  const Cell origin = cell_of_key(page.first_key);
  const Cell first = (box.first - origin).cwiseMax(0);
  const Cell last = (box.last - origin).cwiseMin(kLeafEdge - 1);
  if ((first.array() > last.array()).any()) return;
  const std::uint64_t in_slice = slice(first.x(), last.x(), first.y(), last.y());
  for (int k = first.z(); k <= last.z(); ++k) {
    const auto w = static_cast<std::size_t>(k);
    const std::uint64_t seen = in_slice & page.window_axis[static_cast<std::size_t>(axis)][w];
    page.kept[w] &= ~(window == Window::kWide ? seen & page.wide_window[w] : seen);
  }
}

void NormalCache::drop(std::span<const Edit> edits) noexcept {
  // Edits of a leaf, which come together, as one box.
  for (std::size_t first = 0; first < edits.size();) {
    Cell lower = grid_.cell_of_linear(edits[first].voxel), upper = lower;
    const std::uint32_t leaf = leaf_key(voxel_key(lower));
    std::size_t next = first + 1;
    for (; next < edits.size(); ++next) {
      const Cell c = grid_.cell_of_linear(edits[next].voxel);
      if (leaf_key(voxel_key(c)) != leaf) break;
      lower = lower.cwiseMin(c);
      upper = upper.cwiseMax(c);
    }
    drop_box(lower, upper);
    first = next;
  }
}

std::size_t NormalCache::memory_bytes() const {
  return used_ * sizeof(Page) + table_.capacity() * sizeof(Slot);
}

}  // namespace sulcus
