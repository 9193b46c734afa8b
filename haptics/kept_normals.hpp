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
inline bool keeps_normals(const HapticsSettings& settings) {
  return settings.keep_normals && use_tool(settings.normals);
}

/// Normals that stand from one tick to the next, leaf by leaf, without what the tool has to say:
/// they depend on the workpiece alone, so keeping them changes no result. Under `ldm` they come in
/// two tiers: what is touched for the first time is ldm_fast's until it has been refined, and which
/// are is part of the state.
///
/// Changed by the tick alone, after the contact has been evaluated; read in between. Memory is
/// taken when the scene loads, and used as leaves are touched; leaves that were not for 4,000
/// ticks give way to others, and where memory runs out those that were touched longest ago. Windows
/// are as those of ldm and ldm_fast; an edit drops what it can have been seen from, and no more
/// than that.
class KeptNormals {
 public:
  KeptNormals(const VoxelGrid& grid, const HapticsSettings& settings);

  struct Value {
    float normal[3], offset;  // voxels; together, as ContactKernels::take_kept reads them
  };
  /// Voxels of a leaf, as in LeafBits.
  using Mask = std::array<std::uint64_t, 8>;
  /// What is kept of a leaf, what is looked at first in a cache line of its own. Nothing is set
  /// before a page is used, so that those which are not cost no memory.
  struct alignas(sizeof(Mask)) Page {
    Mask kept, refined;
    std::array<Mask, 3> along;      // seen by maps along each axis
    Mask wide;                      // and with every other column, twice as far
    std::uint32_t first_key;        // voxel_key of the leaf's first voxel
    std::uint64_t touched;          // tick
    std::array<Value, 512> values;  // by leaf_place
  };
  static bool is(const Mask& mask, int place) {
    return (mask[static_cast<std::size_t>(place >> 6)] >> (place & 63) & 1u) != 0;
  }

  /// Null where nothing of the leaf is kept. Leaves are named by their leaf_key.
  const Page* find(std::uint32_t leaf) const noexcept;
  /// Asks for the memory that `find` starts from.
  void prefetch(std::uint32_t leaf) const noexcept { __builtin_prefetch(&table_[home(leaf)]); }
  /// A leaf and where its page is, or was before another leaf took that.
  struct Place {
    std::uint32_t leaf, page;
  };
  Place place_of(std::uint32_t leaf, const Page& page) const noexcept {
    return {leaf, static_cast<std::uint32_t>(&page - pages_.get())};
  }

  /// Keeps estimates that were made without the tool. Those that are not defined are passed over.
  void keep(std::uint32_t key, const SurfaceEstimate& estimate, bool refined,
            std::uint64_t tick) noexcept;
  void touch(std::span<const Place> places, std::uint64_t tick) noexcept;
  /// Drops what has been seen through windows that the edits lie in.
  void drop(std::span<const Edit> edits) noexcept;

  /// In the order in which they were taken: what a saved state names.
  std::span<const Page> pages() const { return {pages_.get(), used_}; }
  /// Forgets all, and takes leaves again in the order of a saved state.
  void clear() noexcept;
  void add_leaf(std::uint32_t leaf, std::uint64_t touched) noexcept;

  /// Of the refined voxels, whatever the order they came in.
  std::uint64_t hash() const { return hash_; }
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
  void forget(std::uint32_t page) noexcept;
  struct CellBox {
    Cell first, last;
  };
  void drop_box(const Cell& lower, const Cell& upper) noexcept;
  void drop_seen(Page& page, int axis, const CellBox& box, bool wide) noexcept;
  void clear(Page& page, int word, std::uint64_t bits) noexcept;

  VoxelGrid grid_;
  int across_, wide_;  // reach of a map across its axis, and of a wide one; 0: there are none
  std::uint32_t capacity_, used_ = 0;
  std::unique_ptr<Page[]> pages_;  // untouched until used
  struct Slot {
    std::uint32_t leaf = 0, page_plus_1 = 0;  // 0: free
  };
  std::vector<Slot> table_;  // by leaf_key, open addressing
  std::uint64_t hash_ = 0;
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
