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
  for (std::size_t k = 0; k < count_; ++k) {
    const VoxelQuery& query = queries[first + k];
    eight(k).put_voxel(place(k), query.voxel.data(), query.outward.data(), sums[k].data());
  }
  sided_ = map_kernels().aim(surfaces.data(), count_);

  for (std::size_t k = 0; k < count_; ++k) {
    const SurfaceGroup& group = eight(k);
    const int p = place(k);
    coarse[k] = {group.coarse[0][p], group.coarse[1][p], group.coarse[2][p]};
    axes[k] = {group.axis[p], group.sign[p] > 0.0f ? 1 : -1};
    tiles_[k] = (sided_ >> k & 1) != 0 ? tiles.find(axes[k]) : nullptr;
    tile_columns_[k] = tiles_[k] ? tiles_[k]->columns[group.column[p]] : HeightTile::kUnsound;
  }
  const TileMaps in_tiles =
      map_kernels().look_up(tile_columns_.data(), tiles.origin().data(), neighbourhood, trace, 0,
                            surfaces.data(), eights());
  const std::uint64_t tiled = in_tiles.even | in_tiles.partly;

  const QuadricFilter& whole = quadric_filter(neighbourhood, lanes_of(neighbourhood));
  filled_ = 0;
  is_whole_.fill(false);
  for (std::size_t k = 0; k < count_; ++k) {
    is_whole_[k] = (tiled & sided_) >> k & 1;
    if (is_whole_[k]) {
      const HeightTile& tile = *tiles_[k];
      const auto column = static_cast<unsigned>(eight(k).column[place(k)]);
      eight(k).put_sums(place(k), tile.sums_of(column), whole);
      at_[k] = {static_cast<int>(column % HeightTile::kEdge),
                static_cast<int>(column / HeightTile::kEdge), eight(k).layer[place(k)]};
      rows_[k] = rows_of(tile, at_[k].x(), at_[k].y(), at_[k].z());
      continue;
    }
    tiles_[k] = nullptr;
    if ((sided_ >> k & 1) == 0) continue;
    HeightMap& map = maps_[filled_];
    map.ns = neighbourhood;
    map.stride = 1;
    map.sign = axes[k].sign;
    columns_[filled_] = columns_about(workpiece, queries[first + k].voxel, axes[k]);
    slots_[k] = filled_++;
  }
  if (filled_ > 0) fit_traced(whole);
  for (std::size_t e = 0; e < eights(); ++e) map_kernels().surfaces(surfaces[e], 1);
  return count_;
}

void MapGroup::fit_traced(const QuadricFilter& whole) noexcept {
  map_kernels().trace_all(columns_.data(), filled_, trace_, maps_.data());
  for (std::size_t k = 0; k < count_; ++k) {
    if (tiles_[k] || (sided_ >> k & 1) == 0) continue;
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
