#include "engine/normals/map_group.hpp"

#include "engine/normals/coarse_normal.hpp"

namespace sulcus {

std::size_t MapGroup::take(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                           std::size_t first, int neighbourhood, int trace,
                           LeafTiles& tiles) noexcept {
  count_ = tiles.come_to(first, kSize);
  trace_ = trace;
  std::array<std::array<std::int32_t, 3>, kSize> sums;
  coarse_sums(workpiece, queries.subspan(first, count_), columns_.data(), sums.data());

  const QuadricFilter& whole = quadric_filter(neighbourhood, lanes_of(neighbourhood));
  filled_ = 0;
  is_whole_.fill(false);
  for (std::size_t k = 0; k < count_; ++k) {
    const VoxelQuery& query = queries[first + k];
    coarse[k] = coarse_of(sums[k]);
    if (coarse[k] == Eigen::Vector3f::Zero()) coarse[k] = query.outward;
    axes[k] = dominant_axes(coarse[k]);
    tiles_[k] = nullptr;
    if (coarse[k] == Eigen::Vector3f::Zero()) continue;
    eight(k).put_axes(place(k), axes[k].axis, coarse[k].data(), query.outward.data());
    const HeightTile* const tile = tiles.find(axes[k]);
    // By reference: what is written number by number cannot be read as one at once.
    const Eigen::Vector3i& at = at_[k] = in_tile(query.voxel, axes[k]);
    if (tile && tiles.is_of_leaf(first + k) && tile->has_map(at.x(), at.y(), at.z(), trace)) {
      is_whole_[k] = true;
      tiles_[k] = tile;
      rows_[k] = rows_of(*tile, at.x(), at.y(), at.z());
      put_tile_sums(*tile, at, whole, eight(k), place(k));
      continue;
    }
    HeightMap& map = maps_[filled_];
    map.ns = neighbourhood;
    map.stride = 1;
    map.sign = axes[k].sign;
    columns_[filled_] = columns_about(workpiece, query.voxel, axes[k]);
    slots_[k] = filled_++;
  }
  if (filled_ > 0) fit_traced(whole);
  for (std::size_t e = 0; e < eights(); ++e) map_kernels().surfaces(surfaces[e], 1);
  return count_;
}

void MapGroup::fit_traced(const QuadricFilter& whole) noexcept {
  map_kernels().trace_all(columns_.data(), filled_, trace_, maps_.data());
  for (std::size_t k = 0; k < count_; ++k) {
    if (tiles_[k] || coarse[k] == Eigen::Vector3f::Zero()) continue;
    const HeightMap& map = maps_[slots_[k]];
    is_whole_[k] = map.whole_rings == map.ns;
    if (!is_whole_[k]) continue;
    rows_[k] = rows_of(map);
    QuadricSums sums;
    map_kernels().fit(map.middle_row(), map.lanes, whole, sums);
    eight(k).put(place(k), sums, map.at(0, 0), map.at(0, 0), map.sign, whole);
  }
}

const HeightMap& MapGroup::map(std::size_t k) noexcept {
  if (tiles_[k]) {
    HeightMap& map = maps_[filled_];
    map.ns = tiles_[k]->ns;
    map.stride = 1;
    map.sign = axes[k].sign;
    map_kernels().cut(*tiles_[k], at_[k].x(), at_[k].y(), at_[k].z(), trace_, map);
    slots_[k] = filled_++;
    tiles_[k] = nullptr;
  }
  return maps_[slots_[k]];
}

}  // namespace sulcus
