#include "engine/normals/ldm_fast.hpp"

#include <algorithm>
#include <array>

#include "engine/normals/coarse_normal.hpp"
#include "engine/normals/grown_plane.hpp"
#include "engine/normals/leaf_tiles.hpp"
#include "engine/normals/map_group.hpp"
#include "engine/normals/tilted_fit.hpp"

namespace sulcus {

namespace {

/// So many voxels go through each step before the next, which then do not wait for one another.
constexpr std::size_t kBatch = 64;
constexpr std::size_t kLanes = SurfaceGroup::kSize;

/// A map with no more even rings than this lies across an edge.
constexpr int kRingsAtEdge = 2;

enum class Found : std::uint8_t { kNothing, kSurface, kFace };

struct Batch {
  std::size_t count = 0;
  std::array<ColumnBits::Windows, kBatch> rows;  // that the coarse normals are added up from
  std::array<Eigen::Vector3f, kBatch> coarse;
  std::array<MapAxes, kBatch> axes;
  std::array<Found, kBatch> found;
  std::array<Foot, kBatch> face;  // where one is found
  std::array<SurfaceGroup, kBatch / kLanes> surfaces;
  // Of those whose maps are traced, a few at a time.
  static constexpr std::size_t kTraced = 16;
  std::array<ColumnBits::Windows, kTraced> columns;
  std::array<HeightMap, kTraced> maps;

  SurfaceGroup& group(std::size_t k) { return surfaces[k / kLanes]; }
  static int place(std::size_t k) { return static_cast<int>(k % kLanes); }
};

/// Coarse normals, of the tool where the solid has none, and the axes of the maps.
void take_axes(const Workpiece& workpiece, std::span<const VoxelQuery> queries, Batch& batch) {
  std::array<std::array<std::int32_t, 3>, kBatch> sums;
  coarse_sums(workpiece, queries.first(batch.count), batch.rows.data(), sums.data());
  for (std::size_t k = 0; k < batch.count; ++k) {
    Eigen::Vector3f& coarse = batch.coarse[k] = coarse_of(sums[k]);
    if ((sums[k][0] | sums[k][1] | sums[k][2]) == 0) coarse = queries[k].outward;
    batch.axes[k] = dominant_axes(coarse);
    batch.group(k).put_axes(Batch::place(k), batch.axes[k].axis, coarse.data(),
                            queries[k].outward.data());
  }
}

/// Whether a map of so many even rings of `ns` lies across an edge.
bool is_at_edge(int even_rings, int ns) { return even_rings <= kRingsAtEdge && even_rings < ns; }

/// The face that the columns nearest to the voxel and half of the map lie on, where there is one.
std::optional<Foot> face_of(const HeightMap& map) {
  const std::optional<Foot> close = close_plane(map);
  if (!close) return {};
  const int half = (2 * map.ns + 1) * (2 * map.ns + 1) / 2;
  return grow_plane(map, *close, half, true);
}

/// Sums of the largest even window of a traced map; across an edge its `face` instead, where there
/// is one.
Found fit_map(const HeightMap& map, int sign, SurfaceGroup& group, int place, Foot& face) {
  if (is_at_edge(map.even_rings, map.ns)) {
    if (const std::optional<Foot> grown = face_of(map)) {
      face = *grown;
      return Found::kFace;
    }
  }
  if (map.even_rings < 1) return Found::kNothing;
  const QuadricFilter& filter = quadric_filter(map.even_rings, map.lanes);
  QuadricSums sums;
  map_kernels().fit(map.middle_row(), map.lanes, filter, sums);
  group.put(place, sums, map.at(0, 0), map.at(0, 0), sign, filter);
  return Found::kSurface;
}

/// The same from a tile that has the map, which is not across an edge; `whole` is the filter of all
/// rings.
void fit_in_tile(const HeightTile& tile, const Eigen::Vector3i& at, const QuadricFilter& whole,
                 SurfaceGroup& group, int place) {
  const int u = at.x(), v = at.y(), rings = tile.even_rings[v][u];
  if (rings == tile.ns) {
    put_tile_sums(tile, at, whole, group, place);
    return;
  }
  const QuadricFilter& filter = quadric_filter(rings, lanes_of(tile.ns));
  QuadricSums sums;
  map_kernels().fit(tile.middle_row(u, v), HeightTile::kLanes, filter, sums);
  group.put(place, sums, tile.at(u, v), tile.at(u, v) - at.z(), tile.sign, filter);
}

/// Fits the maps of a batch, of queries from `first` on: those that the tiles have at once, and the
/// others, which are traced, after that, side by side.
void fit(const Workpiece& workpiece, std::span<const VoxelQuery> queries, std::size_t first,
         int neighbourhood, int trace, LeafTiles& tiles, Batch& batch) {
  const QuadricFilter& whole = quadric_filter(neighbourhood, lanes_of(neighbourhood));
  std::array<std::uint8_t, kBatch> traced;
  std::size_t to_trace = 0;
  for (std::size_t k = 0; k < batch.count; ++k) {
    batch.found[k] = Found::kNothing;
    if (batch.coarse[k] == Eigen::Vector3f::Zero()) continue;
    const MapAxes& axes = batch.axes[k];
    const HeightTile* const tile = tiles.find(first + k, axes);
    const Eigen::Vector3i at = in_tile(queries[first + k].voxel, axes);
    if (tile && tile->has_map(at.x(), at.y(), at.z(), trace) &&
        !is_at_edge(tile->even_rings[at.y()][at.x()], tile->ns)) {
      fit_in_tile(*tile, at, whole, batch.group(k), Batch::place(k));
      batch.found[k] = Found::kSurface;
    } else {
      traced[to_trace++] = static_cast<std::uint8_t>(k);
    }
  }
  for (std::size_t begin = 0; begin < to_trace; begin += Batch::kTraced) {
    const std::size_t count = std::min(to_trace - begin, Batch::kTraced);
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t k = traced[begin + n];
      batch.columns[n] = columns_about(workpiece, queries[first + k].voxel, batch.axes[k]);
      batch.maps[n].ns = neighbourhood;
      batch.maps[n].sign = batch.axes[k].sign;
    }
    map_kernels().trace_all(batch.columns.data(), count, trace, batch.maps.data());
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t k = traced[begin + n];
      batch.found[k] = fit_map(batch.maps[n], batch.axes[k].sign, batch.group(k), Batch::place(k),
                               batch.face[k]);
    }
  }
}

}  // namespace

void estimate_ldm_fast(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                       int neighbourhood, int trace,
                       std::span<SurfaceEstimate> estimates) noexcept {
  LeafTiles tiles(workpiece, queries, neighbourhood, true);
  Batch batch;
  for (std::size_t first = 0; first < queries.size(); first += kBatch) {
    batch.count = std::min(queries.size() - first, kBatch);
    take_axes(workpiece, queries.subspan(first, batch.count), batch);
    fit(workpiece, queries, first, neighbourhood, trace, tiles, batch);
    map_kernels().feet(batch.surfaces.data(), (batch.count + kLanes - 1) / kLanes);
    for (std::size_t k = 0; k < batch.count; ++k) {
      SurfaceEstimate& estimate = estimates[first + k];
      const Eigen::Vector3f& coarse = batch.coarse[k];
      const Eigen::Vector3f& outward = queries[first + k].outward;
      const SurfaceGroup& group = batch.group(k);
      const int place = Batch::place(k);
      if (batch.found[k] == Found::kFace) {
        estimate = to_index_space(batch.face[k], batch.axes[k]);
        if (stands(estimate.normal, coarse, heard(outward, coarse))) continue;
      }
      if (batch.found[k] == Found::kSurface && group.stands[place] != 0) {
        estimate = {group.normal(place), group.offset[place], true, batch.axes[k].window()};
        continue;
      }
      // No map: an edge sharper than the steps allow. The face of the voxel is the best surface.
      estimate = coarse == Eigen::Vector3f::Zero()
                     ? SurfaceEstimate{}
                     : last_resort(coarse, heard(outward, coarse), batch.axes[k].window());
    }
  }
}

}  // namespace sulcus
