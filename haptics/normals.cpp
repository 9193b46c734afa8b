#include "haptics/normals.hpp"

#include <algorithm>

#include "engine/normals/normal_method.hpp"

namespace sulcus {

namespace {

/// What normals of the first touch are made by.
HapticsSettings first_tier(const HapticsSettings& settings, const KeptNormals* kept) {
  HapticsSettings first = settings;
  if (kept && settings.normals == NormalMethod::kLdm && settings.refine_per_tick > 0) {
    first.normals = NormalMethod::kLdmFast;
  }
  return first;
}

/// Walks over contacts leaf by leaf.
class LeafWalk {
 public:
  explicit LeafWalk(const KeptNormals* kept) : kept_(kept) {}
  /// The page of the contact's leaf, or null.
  const KeptNormals::Page* page(std::uint32_t key) {
    if (!kept_) return nullptr;
    if (const std::uint32_t leaf = leaf_key(key); leaf != leaf_) {
      leaf_ = leaf;
      page_ = kept_->find(leaf);
    }
    return page_;
  }

 private:
  const KeptNormals* kept_;
  std::uint32_t leaf_ = ~0u;
  const KeptNormals::Page* page_ = nullptr;
};

void put(Contacts& contacts, std::size_t i, const float (&normal)[3], float offset_m) {
  for (int a = 0; a < 3; ++a) contacts(Contacts::kNormal, a)[i] = normal[a];
  contacts(Contacts::kOffset)[i] = offset_m;
}

void put(Contacts& contacts, std::size_t i, const SurfaceEstimate& e, float voxel_m) {
  put(contacts, i, {e.normal.x(), e.normal.y(), e.normal.z()}, e.offset * voxel_m);
}

bool is_refined(const KeptNormals::Page* page, std::uint32_t key) {
  return page && KeptNormals::is(page->refined, leaf_place(key));
}

}  // namespace

void normals(const Workpiece& workpiece, const HapticsSettings& settings, const KeptNormals* kept,
             ContactScratch& scratch) noexcept {
  Contacts& contacts = scratch.contacts;
  const auto voxel_m = static_cast<float>(workpiece.grid().voxel_m);
  const HapticsSettings first = first_tier(settings, kept);
  scratch.queries.clear();
  scratch.queried.clear();
  scratch.vetoed.clear();
  const bool told = use_tool(settings.normals);
  const auto hear_tool = [&](std::size_t i, const Eigen::Vector3f& normal) {
    if (!told || normal.dot(contacts.vector(Contacts::kOutward, i)) > 0.0f) return;
    scratch.vetoed.push_back(static_cast<std::uint32_t>(i));
  };
  LeafWalk walk(kept);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t key = contacts.keys()[i];
    const KeptNormals::Page* page = walk.page(key);
    const int place = leaf_place(key);
    if (page && KeptNormals::is(page->kept, place)) {
      const KeptNormals::Value& value = page->values[static_cast<std::size_t>(place)];
      put(contacts, i, value.normal, value.offset * voxel_m);
      hear_tool(i, {value.normal[0], value.normal[1], value.normal[2]});
      continue;
    }
    scratch.queries.push_back(VoxelQuery{cell_of_key(key)});
    scratch.queried.push_back(static_cast<std::uint32_t>(i));
  }
  scratch.estimates.resize(scratch.queries.size());
  estimate_surfaces(workpiece, scratch.queries, first, scratch.estimates);
  for (std::size_t q = 0; q < scratch.queries.size(); ++q) {
    put(contacts, scratch.queried[q], scratch.estimates[q], voxel_m);
    hear_tool(scratch.queried[q], scratch.estimates[q].normal);
  }
  if (scratch.vetoed.empty()) return;

  // What the tool has to say: it names a side where the solid has none, and vetoes. A normal that
  // it does not veto is the same with and without it (a test), so only the others are found again,
  // tier by tier.
  for (const bool refined : {false, true}) {
    scratch.tool_queries.clear();
    scratch.tool_queried.clear();
    LeafWalk again(kept);
    for (const std::uint32_t i : scratch.vetoed) {
      const std::uint32_t key = contacts.keys()[i];
      if (is_refined(again.page(key), key) != refined) continue;
      scratch.tool_queries.push_back(
          VoxelQuery{cell_of_key(key), contacts.vector(Contacts::kOutward, i)});
      scratch.tool_queried.push_back(i);
    }
    scratch.tool_estimates.resize(scratch.tool_queries.size());
    estimate_surfaces(workpiece, scratch.tool_queries, refined ? settings : first,
                      scratch.tool_estimates);
    for (std::size_t q = 0; q < scratch.tool_queries.size(); ++q) {
      put(contacts, scratch.tool_queried[q], scratch.tool_estimates[q], voxel_m);
    }
  }
}

void keep_found(const HapticsSettings& settings, std::uint64_t tick, const ContactScratch& scratch,
                KeptNormals& kept) noexcept {
  if (!use_tool(settings.normals)) return;
  for (std::size_t q = 0; q < scratch.queries.size(); ++q) {
    kept.keep(scratch.contacts.keys()[scratch.queried[q]], scratch.estimates[q], false, tick);
  }
}

void keep_normals(const Workpiece& workpiece, const HapticsSettings& settings, std::uint64_t tick,
                  ContactScratch& scratch, KeptNormals& kept) noexcept {
  if (!use_tool(settings.normals)) return;
  const Contacts& contacts = scratch.contacts;
  std::uint32_t leaf = ~0u;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (const std::uint32_t at = leaf_key(contacts.keys()[i]); at != leaf) {
      leaf = at;
      kept.touch(leaf, tick);
    }
  }
  keep_found(settings, tick, scratch, kept);
  if (settings.normals != NormalMethod::kLdm || settings.refine_per_tick == 0) return;

  const auto most = std::min(static_cast<std::size_t>(settings.refine_per_tick), scratch.capacity);
  scratch.tool_queries.clear();
  LeafWalk walk(&kept);
  for (std::size_t i = 0; i < contacts.size() && scratch.tool_queries.size() < most; ++i) {
    const std::uint32_t key = contacts.keys()[i];
    const KeptNormals::Page* page = walk.page(key);
    const int place = leaf_place(key);
    if (!page || !KeptNormals::is(page->kept, place) || KeptNormals::is(page->refined, place))
      continue;
    scratch.tool_queries.push_back(VoxelQuery{cell_of_key(key)});
  }
  scratch.tool_estimates.resize(scratch.tool_queries.size());
  estimate_surfaces(workpiece, scratch.tool_queries, settings, scratch.tool_estimates);
  for (std::size_t q = 0; q < scratch.tool_queries.size(); ++q) {
    kept.keep(voxel_key(scratch.tool_queries[q].voxel), scratch.tool_estimates[q], true, tick);
  }
}

}  // namespace sulcus
