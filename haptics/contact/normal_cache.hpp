#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/normals/normal_method.hpp"
#include "engine/normals/surface_estimate.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Whether normals are kept under these settings.
inline bool uses_normal_cache(const HapticsSettings& settings) {
  return settings.keep_normals && use_tool(settings.normals);
}

/// Normals that stand from one tick to the next, leaf by leaf. They are found without the tool hint
/// and depend on the solid alone, so that caching them changes no result: it is no part of the
/// simulation's state.
///
/// The tick alone changes it, after the contact has been evaluated. Memory is taken when the scene
/// loads, and used leaf by leaf. A leaf without a contact for 4,000 ticks is evicted for another
/// one, and where memory runs out the leaf whose last contact is longest ago. An edit invalidates
/// exactly the normals whose sampling window contains it.
class NormalCache {
 public:
  NormalCache(const VoxelGrid& grid, const HapticsSettings& settings);

  struct Value {
    float normal[3], offset;  // voxels; together, as ContactKernels::take_cached reads them
  };
  /// Voxels of a leaf, as in LeafBits.
  using Mask = std::array<std::uint64_t, 8>;
  /// The normals of a leaf; the masks that are read first have a cache line of their own. Nothing
  /// is set before a page is used, so that unused ones cost no memory.
  struct alignas(sizeof(Mask)) Page {
    Mask kept;
    std::array<Mask, 3> window_axis;  // seen by maps along each axis
    Mask wide_window;                 // and with every other column, twice as far
    std::uint32_t first_key;          // voxel_key of the leaf's first voxel
    std::uint64_t touched;            // tick of its last contact
    std::array<Value, 512> values;    // by leaf_place
  };
  static bool is(const Mask& mask, int place) {
    return (mask[static_cast<std::size_t>(place >> 6)] >> (place & 63) & 1u) != 0;
  }

  /// Null where the leaf has no page. Leaves are named by their leaf_key.
  const Page* find(std::uint32_t leaf) const noexcept;
  /// Prefetches what `find` reads first.
  void prefetch(std::uint32_t leaf) const noexcept { __builtin_prefetch(&table_[home(leaf)]); }
  /// A leaf and where its page is, or was before another leaf took that.
  struct Place {
    std::uint32_t leaf, page;
  };
  Place place_of(std::uint32_t leaf, const Page& page) const noexcept {
    return {leaf, static_cast<std::uint32_t>(&page - pages_.get())};
  }

  /// Keeps an estimate that was made without the tool hint; one that is not defined is skipped.
  void keep(std::uint32_t key, const SurfaceEstimate& estimate, std::uint64_t tick) noexcept;
  /// These leaves have contacts in this tick.
  void mark_used(std::span<const Place> places, std::uint64_t tick) noexcept;
  /// Invalidates the normals whose windows the edits lie in.
  void drop(std::span<const Edit> edits) noexcept;

  /// In the order in which they came into use.
  std::span<const Page> pages() const { return {pages_.get(), used_}; }
  void clear() noexcept;

  std::size_t memory_bytes() const;

 private:
  std::size_t home(std::uint32_t leaf) const noexcept;
  std::size_t slot_of(std::uint32_t leaf) const noexcept;
  Page* page(std::uint32_t leaf) noexcept;
  /// A page to use again; where none was found, that behind the used ones.
  std::uint32_t long_untouched(std::uint64_t tick) const noexcept;
  /// Where all are in use: the page touched longest ago, of those the first; as many as there are
  /// where all were touched in this tick.
  std::uint32_t longest_untouched(std::uint64_t tick) noexcept;
  Page* make_page(std::uint32_t leaf, std::uint64_t tick) noexcept;
  Page& set_page(std::uint32_t at, std::uint32_t leaf, std::uint64_t tick) noexcept;
  void evict(std::uint32_t page) noexcept;
  struct CellBox {
    Cell first, last;
  };
  void drop_box(const Cell& lower, const Cell& upper) noexcept;
  enum class Window { kNarrow, kWide };
  void drop_window(Page& page, int axis, const CellBox& box, Window window) noexcept;

  VoxelGrid grid_;
  int across_, wide_;  // reach of a map across its axis, and of a wide one; 0: there are none
  std::uint32_t capacity_, used_ = 0;
  std::unique_ptr<Page[]> pages_;  // untouched until used
  struct Slot {
    std::uint32_t leaf = 0, page_plus_1 = 0;  // 0: free
  };
  std::vector<Slot> table_;  // by leaf_key, open addressing
  struct Old {
    std::uint64_t touched;
    std::uint32_t page;
  };
  std::vector<Old> old_;      // those untouched longest, in their order, as they were in a tick
  std::size_t next_old_ = 0;  // of them
  std::uint64_t listed_ = 0;  // that tick
  std::optional<std::uint64_t> all_touched_;  // a tick in which all pages had been touched
};

}  // namespace sulcus
