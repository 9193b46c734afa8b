#include "haptics/contact/normals.hpp"

#include <algorithm>
#include <bit>

#include "engine/normals/normal_method.hpp"
#include "haptics/contact/contact_kernels.hpp"

namespace sulcus {

namespace {

/// Walks over contacts leaf by leaf.
class LeafWalk {
 public:
  explicit LeafWalk(const NormalCache* cache) : cache_(cache) {}
  /// The page of the contact's leaf, or null.
  const NormalCache::Page* page(std::uint32_t key) {
    if (!cache_) return nullptr;
    if (const std::uint32_t leaf = leaf_key(key); leaf != leaf_) {
      leaf_ = leaf;
      page_ = cache_->find(leaf);
    }
    return page_;
  }

 private:
  const NormalCache* cache_;
  std::uint32_t leaf_ = ~0u;
  const NormalCache::Page* page_ = nullptr;
};

void put(ContactScratch& scratch, std::size_t i, const SurfaceEstimate& e, float voxel_m) {
  scratch.contacts.set_vector(Contacts::kNormal, i, e.normal);
  scratch.block(ContactBlock::kOffset)[i - scratch.block.first()] = e.offset * voxel_m;
}

Eigen::Vector3f outward_of(const ContactScratch& scratch, std::size_t i) {
  return scratch.block.vector(ContactBlock::kOutward, i - scratch.block.first());
}

void request(ContactScratch& scratch, std::size_t i) {
  scratch.queries.push_back(VoxelQuery{cell_of_key(scratch.contacts.keys()[i])});
  scratch.queried.push_back(static_cast<std::uint32_t>(i));
}

/// Takes the cached normals of contacts from `start` on, and requests the others. Where `use_veto`,
/// lists those that the tool hint vetoes.
///
/// In blocks of a pipeline, since the pages of many contacts are more than the processor's caches
/// hold: prefetch the table, find the pages and prefetch them, find the values and prefetch them,
/// take them.
void take_cached(const NormalCache& cache, float voxel_m, bool use_veto, ContactScratch& scratch,
                 std::size_t start) {
  static constexpr NormalCache::Value kNothing{};
  const ContactArrays arrays = arrays_of(scratch.contacts, start);
  const BlockArrays block_arrays = arrays_of(scratch.block, start);
  const std::uint32_t* const keys = arrays.keys;
  const std::size_t blocks = (arrays.size + kCachedBlock - 1) / kCachedBlock;
  const auto count_of = [&](std::size_t block) {
    return std::min(kCachedBlock, arrays.size - block * kCachedBlock);
  };
  const NormalCache::Page* pages[kCachedBlock];
  const float* both[2][kCachedBlock];  // of two blocks: found in one round, taken two rounds later

  // A look at each eighth meets nearly every leaf, and costs less than to miss none.
  const auto ask_pages = [&](std::size_t block) {
    for (std::size_t k = 0; k < count_of(block); k += 8) {
      cache.prefetch(leaf_key(keys[block * kCachedBlock + k]));
    }
  };
  LeafWalk walk(&cache);
  const NormalCache::Page* found = nullptr;
  const auto find_pages = [&](std::size_t block) {
    for (std::size_t k = 0; k < count_of(block); ++k) {
      const std::uint32_t key = keys[block * kCachedBlock + k];
      const NormalCache::Page* const page = walk.page(key);
      if (page && page != found) {
        __builtin_prefetch(&page->kept);
        scratch.cached_leaves.push_back(cache.place_of(leaf_key(key), *page));
      }
      pages[k] = found = page;
    }
  };
  const auto find_values = [&](std::size_t block) {
    const std::size_t count = count_of(block);
    auto& values = both[block % 2];
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = block * kCachedBlock + k;
      const NormalCache::Page* const page = pages[k];
      const int place = leaf_place(keys[i]);
      if (page && NormalCache::is(page->kept, place)) {
        values[k] = page->values[static_cast<std::size_t>(place)].normal;
        __builtin_prefetch(values[k]);
      } else {
        values[k] = kNothing.normal;
        request(scratch, start + i);
      }
    }
    std::fill(values + count, values + kCachedBlock, kNothing.normal);
  };
  const auto take = [&](std::size_t block) {
    const std::size_t first = block * kCachedBlock;
    std::uint64_t away = contact_kernels().take_cached(both[block % 2], count_of(block), voxel_m,
                                                       arrays, block_arrays, first);
    for (; use_veto && away != 0; away &= away - 1) {
      scratch.vetoed.push_back(static_cast<std::uint32_t>(start + first) +
                               static_cast<std::uint32_t>(std::countr_zero(away)));
    }
  };
  for (std::size_t b = 0; b < blocks + 4; ++b) {
    if (b >= 4) take(b - 4);
    if (b >= 2 && b - 2 < blocks) find_values(b - 2);
    if (b >= 1 && b - 1 < blocks) find_pages(b - 1);
    if (b < blocks) ask_pages(b);
  }
}

}  // namespace

void normals(const Workpiece& workpiece, const HapticsSettings& settings, const NormalCache* cache,
             ContactScratch& scratch, std::size_t first) noexcept {
  const Contacts& contacts = scratch.contacts;
  const auto voxel_m = static_cast<float>(workpiece.grid().voxel_m);
  scratch.vetoed.clear();
  // Points of a potential depend on the solid alone.
  const bool use_veto = use_tool(settings.normals) && settings.scaling != Scaling::kPotential;
  if (first == 0) {
    scratch.queries.clear();
    scratch.queried.clear();
    scratch.cached_leaves.clear();
  }
  // Without a cache queries have the numbers of their contacts, of which some may have been dropped
  // since they were asked for.
  const std::size_t first_query = cache ? scratch.queries.size() : first;
  if (cache) {
    take_cached(*cache, voxel_m, use_veto, scratch, first);
  } else {
    // Nothing is cached: each is found with the tool hint at once.
    scratch.queries.resize(contacts.size());
    scratch.queried.resize(contacts.size());
    for (std::size_t i = first; i < contacts.size(); ++i) {
      scratch.queries[i] = {cell_of_key(contacts.keys()[i]), settings.scaling == Scaling::kPotential
                                                                 ? Eigen::Vector3f::Zero().eval()
                                                                 : outward_of(scratch, i)};
      scratch.queried[i] = static_cast<std::uint32_t>(i);
    }
  }
  scratch.estimates.resize(scratch.queries.size());
  estimate_surfaces(workpiece, std::span(scratch.queries).subspan(first_query), settings,
                    std::span(scratch.estimates).subspan(first_query));
  for (std::size_t q = first_query; q < scratch.queries.size(); ++q) {
    const std::uint32_t i = scratch.queried[q];
    put(scratch, i, scratch.estimates[q], voxel_m);
    if (cache && use_veto && !(scratch.estimates[q].normal.dot(outward_of(scratch, i)) > 0.0f)) {
      scratch.vetoed.push_back(i);
    }
  }
  if (scratch.vetoed.empty()) return;

  // The tool hint names a side where the solid has none, and vetoes normals. A normal that it does
  // not veto is the same with and without it (a test), so only the others are found again.
  scratch.tool_queries.clear();
  for (const std::uint32_t i : scratch.vetoed) {
    scratch.tool_queries.push_back({cell_of_key(contacts.keys()[i]), outward_of(scratch, i)});
  }
  scratch.tool_estimates.resize(scratch.tool_queries.size());
  estimate_surfaces(workpiece, scratch.tool_queries, settings, scratch.tool_estimates);
  for (std::size_t q = 0; q < scratch.tool_queries.size(); ++q) {
    put(scratch, scratch.vetoed[q], scratch.tool_estimates[q], voxel_m);
  }
}

void keep_found(const HapticsSettings& settings, std::uint64_t tick, const ContactScratch& scratch,
                NormalCache& cache) noexcept {
  if (!use_tool(settings.normals)) return;
  for (std::size_t q = 0; q < scratch.queried.size(); ++q) {
    cache.keep(voxel_key(scratch.queries[q].voxel), scratch.estimates[q], tick);
  }
}

void keep_normals(const HapticsSettings& settings, std::uint64_t tick,
                  const ContactScratch& scratch, NormalCache& cache) noexcept {
  if (!use_tool(settings.normals)) return;
  cache.mark_used(scratch.cached_leaves, tick);
  keep_found(settings, tick, scratch, cache);
}

}  // namespace sulcus
