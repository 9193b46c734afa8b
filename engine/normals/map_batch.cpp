#include "engine/normals/map_batch.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "engine/normals/coarse_normal.hpp"

namespace sulcus {

std::size_t MapBatch::take(std::size_t first, std::size_t most) noexcept {
  first_ = first;
  count_ = tiles_.advance_to(first, most);
  for (std::size_t k = 0; k < count_; ++k) {
    of_taken_[k] = k;
    windows_[k] = coarse_rows(workpiece_, query(k).voxel);
  }
  map_kernels().coarse(windows_.data(), count_, sums_.data());
  for (std::size_t k = 0; k < count_; ++k) {
    group_of(k).put_voxel(lane(k), query(k).voxel.data(), query(k).outward.data(), sums_[k].data());
  }
  choose_axes(EqualAxes::kFirst);
  if (two_equal != 0) {
    for_each(two_equal, [&](std::size_t k) { tell_apart(k); });
    choose_axes(EqualAxes::kFirst);
  }
  fit_in_tiles(Tiles::kAny);
  return count_;
}

void MapBatch::retake(VoxelBits which, EqualAxes equal, UseOfTool use) noexcept {
  count_ = 0;
  for_each(which, [&](std::size_t taken) {
    const std::size_t k = count_++;
    of_taken_[k] = taken;
    const std::array<std::int32_t, 3>& sums = sums_[taken];
    const bool has_side = (sums[0] | sums[1] | sums[2]) != 0;
    const bool has_tool = use == UseOfTool::kAlways || !has_side;
    const Eigen::Vector3f tool =
        has_tool ? query(k).outward : Eigen::Vector3f(Eigen::Vector3f::Zero());
    group_of(k).put_voxel(lane(k), query(k).voxel.data(), tool.data(), sums.data());
  });
  choose_axes(equal);
  fit_in_tiles(Tiles::kMade);
}

void MapBatch::tell_apart(std::size_t k) noexcept {
  std::array<std::int32_t, 3>& sums = sums_[k];
  if ((sums[0] | sums[1] | sums[2]) == 0) return;  // the tool's direction stands in
  const Eigen::Vector3i offsets = solid_offsets(workpiece_, query(k).voxel, neighbourhood_);
  const auto size = [&](int axis) { return std::abs(sums[static_cast<std::size_t>(axis)]); };
  const auto solid = [&](int axis) {
    return sums[static_cast<std::size_t>(axis)] < 0 ? -offsets[axis] : offsets[axis];
  };
  const int largest = std::max({size(0), size(1), size(2)});
  int most = std::numeric_limits<int>::min(), of_most = 0, how_many = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (size(axis) != largest || solid(axis) < most) continue;
    how_many = solid(axis) == most ? how_many + 1 : 1;
    most = solid(axis);
    of_most = axis;
  }
  if (how_many > 1) return;
  std::int32_t& sum = sums[static_cast<std::size_t>(of_most)];
  sum += sum < 0 ? -1 : 1;  // a part in 120 of a voxel's
  group_of(k).put_voxel(lane(k), query(k).voxel.data(), query(k).outward.data(), sums.data());
}

void MapBatch::choose_axes(EqualAxes equal) noexcept {
  map_count_ = 0;
  const VoxelAxes axes = map_kernels().choose_axes(groups.data(), count_, equal);
  has_direction = axes.has_direction;
  two_equal = axes.two_equal;
  three_equal = axes.three_equal;
}

void MapBatch::fit_in_tiles(Tiles tiles) noexcept {
  if (window_ == FitWindow::kNone) {
    whole = partly = in_tile = 0;
    return;
  }
  const int ns = neighbourhood_, lanes = lanes_of(ns);
  for_each(has_direction, [&](std::size_t k) {
    const HeightTile* const tile = tile_of_[k] =
        tiles == Tiles::kAny ? tiles_.find(axes(k)) : tiles_.find_made(axes(k));
    columns_[k] = tile ? tile->columns[column(k)] : HeightTile::kUnsound;
  });
  const int least_rings = window_ == FitWindow::kWholeMap ? 0 : std::min(kRingsAtEdge + 1, ns);
  const TileMaps maps = map_kernels().look_up(columns_.data(), tiles_.origin().data(), ns, trace_,
                                              least_rings, groups.data(), group_count());
  whole = maps.even & has_direction;
  partly = maps.partly & has_direction;
  in_tile = whole | partly;
  if (window_ == FitWindow::kWholeMap) whole = in_tile, partly = 0;
  const QuadricFilter& filter = quadric_filter(ns, lanes);
  for_each(whole, [&](std::size_t k) {
    group_of(k).put_sums(lane(k), tile_of_[k]->sums_of(column(k)), filter);
  });
  for_each(partly, [&](std::size_t k) {
    const auto u = static_cast<int>(column(k) % HeightTile::kEdge),
               v = static_cast<int>(column(k) / HeightTile::kEdge);
    const QuadricFilter& inner = quadric_filter(columns_[k].even_rings, lanes);
    QuadricSums sums;
    map_kernels().fit(tile_of_[k]->middle_row(u, v), HeightTile::kLanes, inner, sums);
    group_of(k).put_sums(lane(k), sums, inner);
  });
}

std::span<const std::size_t> MapBatch::trace_some(VoxelBits& rest) noexcept {
  map_count_ = 0;
  for (; rest != 0 && map_count_ < kMaps; rest &= rest - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(rest));
    windows_[map_count_] = columns_about(workpiece_, query(k).voxel, axes(k));
    HeightMap& map = maps_[map_count_];
    map.ns = neighbourhood_;
    map.sign = axes(k).sign;
    map.order = trace_order(coarse(k), axes(k));
    traced_[map_count_] = k;
    slots_[k] = map_count_++;
  }
  if (map_count_ > 0) map_kernels().trace(windows_.data(), map_count_, trace_, maps_.data());
  return std::span(traced_).first(map_count_);
}

void MapBatch::fit_traced(std::size_t k) noexcept {
  const HeightMap& map = maps_[slots_[k]];
  const bool is_whole = map.whole_rings == map.ns;
  const int rings = window_ == FitWindow::kEvenRings ? map.even_rings : is_whole ? map.ns : 0;
  if (rings < 1) return;
  const QuadricFilter& filter = quadric_filter(rings, map.lanes);
  QuadricSums sums;
  map_kernels().fit(map.middle_row(), map.lanes, filter, sums);
  group_of(k).put(lane(k), sums, map.at(0, 0), map.at(0, 0), map.sign, filter);
  (rings == map.ns ? whole : partly) |= bit_of(k);
}

MapRows MapBatch::rows(std::size_t k) const noexcept {
  if (!has_bit(in_tile, k)) return rows_of(maps_[slots_[k]]);
  return rows_of(*tile_of_[k], static_cast<int>(column(k) % HeightTile::kEdge),
                 static_cast<int>(column(k) / HeightTile::kEdge), group(k).layer[lane(k)]);
}

const HeightMap& MapBatch::map(std::size_t k) noexcept {
  if (has_bit(in_tile, k)) {
    HeightMap& map = maps_[map_count_];
    map.ns = neighbourhood_;
    map.sign = axes(k).sign;
    map_kernels().cut(*tile_of_[k], static_cast<int>(column(k) % HeightTile::kEdge),
                      static_cast<int>(column(k) / HeightTile::kEdge), group(k).layer[lane(k)],
                      trace_, map);
    slots_[k] = map_count_++;
    in_tile &= ~bit_of(k);
  }
  return maps_[slots_[k]];
}

}  // namespace sulcus
