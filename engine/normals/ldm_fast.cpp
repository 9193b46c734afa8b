#include "engine/normals/ldm_fast.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/normals/coarse_normal.hpp"
#include "engine/normals/grown_plane.hpp"
#include "engine/normals/leaf_tiles.hpp"
#include "engine/normals/map_group.hpp"
#include "engine/normals/tilted_fit.hpp"
#include "engine/normals/wide_map.hpp"

namespace sulcus {

namespace {

/// So many voxels go through each step before the next, which then do not wait for one another.
constexpr std::size_t kBatch = 64;
constexpr std::size_t kLanes = SurfaceGroup::kSize, kGroups = kBatch / kLanes;

/// A map with no more even rings than this lies across an edge.
constexpr int kRingsAtEdge = 2;

/// Bends of what may be a face half a map out, voxels, and where that is level, whose terraces are
/// wide.
constexpr float kMostFaceBend = 0.15f, kMostLevelFaceBend = 0.5f;
constexpr float kLevelCosine = 0.98f;  // cosine to the columns
/// Smaller maps are asked for where that is enough; and all that they see is nearly flat.
constexpr int kLeastForWide = 4;

/// Voxels of a batch, a bit for each.
using Bits = std::uint64_t;
static_assert(kBatch == 64);
constexpr Bits bit_of(std::size_t k) { return Bits{1} << k; }
constexpr Bits first_bits(std::size_t count) { return ~Bits{0} >> (kBatch - count); }
template <class Each>
void for_each(Bits bits, const Each& each) {
  for (; bits != 0; bits &= bits - 1) each(static_cast<std::size_t>(std::countr_zero(bits)));
}

struct Batch {
  std::size_t count = 0;
  std::array<SurfaceGroup, kGroups> surfaces;
  Bits sided = 0;             // that have a coarse normal
  Bits even = 0, partly = 0;  // whose maps are fitted, the whole map or some rings of it
  Bits faces = 0;             // whose feet are on faces instead
  std::array<Foot, kBatch> feet;
  std::array<const HeightTile*, kBatch> tiles;
  std::array<HeightTile::Column, kBatch> columns;
  // What coarse normals are added up from, then what some maps at a time are traced in.
  static constexpr std::size_t kTraced = kMostGrowths;
  std::array<ColumnBits::Windows, kBatch> windows;
  std::array<HeightMap, kTraced> maps;

  std::size_t groups() const { return (count + kLanes - 1) / kLanes; }
  SurfaceGroup& group(std::size_t k) { return surfaces[k / kLanes]; }
  static int place(std::size_t k) { return static_cast<int>(k % kLanes); }
  MapAxes axes(std::size_t k) {
    const SurfaceGroup& g = group(k);
    return {g.axis[place(k)], g.sign[place(k)] > 0.0f ? 1 : -1};
  }
  Eigen::Vector3f coarse(std::size_t k) {
    const SurfaceGroup& g = group(k);
    return {g.coarse[0][place(k)], g.coarse[1][place(k)], g.coarse[2][place(k)]};
  }
  /// In its tile, v kEdge + u.
  unsigned column(std::size_t k) { return static_cast<unsigned>(group(k).column[place(k)]); }
};

/// Coarse normals, of the tool where the solid has none, and the axes of the maps.
void take_axes(const Workpiece& workpiece, std::span<const VoxelQuery> queries, Batch& batch) {
  std::array<std::array<std::int32_t, 3>, kBatch> sums;
  coarse_sums(workpiece, queries, batch.windows.data(), sums.data());
  for (std::size_t k = 0; k < batch.count; ++k) {
    batch.group(k).put_voxel(Batch::place(k), queries[k].voxel.data(), queries[k].outward.data(),
                             sums[k].data());
  }
  batch.sided = map_kernels().aim(batch.surfaces.data(), batch.count);
}

/// Of maps across an edge, the faces that the columns nearest to the voxel and half of the map lie
/// on, where there are any.
void find_faces(std::span<const HeightMap> maps, std::span<const std::size_t> which, Batch& batch) {
  std::array<PlaneGrowth, Batch::kTraced> growths;
  std::array<std::size_t, Batch::kTraced> of;
  std::size_t count = 0;
  for (std::size_t n = 0; n < which.size(); ++n) {
    const HeightMap& map = maps[n];
    if (map.even_rings > kRingsAtEdge || map.even_rings >= map.ns) continue;
    const std::optional<Foot> close = close_plane(map);
    if (!close) continue;
    const int half = (2 * map.ns + 1) * (2 * map.ns + 1) / 2;
    growths[count] = {&map, plane_to_grow(map, *close), half, true, {}};
    of[count++] = which[n];
  }
  grow_planes(std::span(growths).first(count));
  for (std::size_t n = 0; n < count; ++n) {
    if (!growths[n].foot) continue;
    batch.feet[of[n]] = *growths[n].foot;
    batch.faces |= bit_of(of[n]);
  }
}

/// Sums of the maps that the tiles have and that are not across an edge.
void fit_in_tiles(int ns, int trace, LeafTiles& tiles, Batch& batch) {
  for_each(batch.sided, [&](std::size_t k) {
    const HeightTile* const tile = batch.tiles[k] = tiles.find(batch.axes(k));
    batch.columns[k] = tile ? tile->columns[batch.column(k)] : HeightTile::kUnsound;
  });
  const TileMaps maps =
      map_kernels().look_up(batch.columns.data(), tiles.origin().data(), ns, trace,
                            std::min(kRingsAtEdge + 1, ns), batch.surfaces.data(), batch.groups());
  batch.even = maps.even & batch.sided;
  batch.partly = maps.partly & batch.sided;
  const QuadricFilter& whole = quadric_filter(ns, lanes_of(ns));
  for_each(batch.even, [&](std::size_t k) {
    const QuadricSums sums = batch.tiles[k]->sums_of(batch.column(k));
    batch.group(k).put_sums(Batch::place(k), sums, whole);
  });
  for_each(batch.partly, [&](std::size_t k) {
    const auto u = static_cast<int>(batch.column(k) % HeightTile::kEdge),
               v = static_cast<int>(batch.column(k) / HeightTile::kEdge);
    const QuadricFilter& filter = quadric_filter(batch.columns[k].even_rings, lanes_of(ns));
    QuadricSums sums;
    map_kernels().fit(batch.tiles[k]->middle_row(u, v), HeightTile::kLanes, filter, sums);
    batch.group(k).put_sums(Batch::place(k), sums, filter);
  });
}

/// Traces the other maps, side by side, and puts the sums of the largest even window of each;
/// across an edge finds its face instead, where there is one.
void trace_others(const Workpiece& workpiece, std::span<const VoxelQuery> queries, int ns,
                  int trace, Batch& batch) {
  Bits others = batch.sided & ~(batch.even | batch.partly);
  while (others != 0) {
    std::array<std::size_t, Batch::kTraced> which;
    std::size_t count = 0;
    for (; others != 0 && count < Batch::kTraced; others &= others - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(others));
      const MapAxes axes = batch.axes(k);
      batch.windows[count] = columns_about(workpiece, queries[k].voxel, axes);
      batch.maps[count].ns = ns;
      batch.maps[count].sign = axes.sign;
      which[count++] = k;
    }
    map_kernels().trace_all(batch.windows.data(), count, trace, batch.maps.data());
    find_faces(batch.maps, std::span(which).first(count), batch);
    for (std::size_t n = 0; n < count; ++n) {
      const HeightMap& map = batch.maps[n];
      const std::size_t k = which[n];
      if ((batch.faces & bit_of(k)) != 0 || map.even_rings < 1) continue;
      const QuadricFilter& filter = quadric_filter(map.even_rings, map.lanes);
      QuadricSums sums;
      map_kernels().fit(map.middle_row(), map.lanes, filter, sums);
      batch.group(k).put(Batch::place(k), sums, map.at(0, 0), map.at(0, 0), map.sign, filter);
      (map.even_rings == ns ? batch.even : batch.partly) |= bit_of(k);
    }
  }
}

/// Faces as wide maps show them, of the surfaces that are nearly flat. Returns which were looked
/// for.
Bits widen_faces(const Workpiece& workpiece, std::span<const VoxelQuery> queries, int ns, int trace,
                 Batch& batch) {
  const float per = 1.0f / static_cast<float>(ns * ns);
  Bits looked = 0;
  for_each(batch.even, [&](std::size_t k) {
    const SurfaceGroup& group = batch.group(k);
    const int place = Batch::place(k);
    const float most = group.normal_z[place] > kLevelCosine ? kMostLevelFaceBend : kMostFaceBend;
    if (!(group.bend[place] <= most * per)) return;
    looked |= bit_of(k);
    HeightMap map;
    trace_wide(workpiece, queries[k].voxel, batch.axes(k), ns, trace, map);
    if (map.even_rings < ns) return;
    const ColumnQuadric surface = fit_whole(map, quadric_filter(ns, map.lanes));
    const Foot foot = foot_of(surface);
    if (!is_face(surface, foot, ns)) return;
    batch.feet[k] = foot;
    batch.faces |= bit_of(k);
  });
  return looked;
}

}  // namespace

void estimate_ldm_fast(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                       int neighbourhood, int trace,
                       std::span<SurfaceEstimate> estimates) noexcept {
  LeafTiles tiles(workpiece, queries, neighbourhood, true);
  Batch batch;
  for (std::size_t first = 0; first < queries.size(); first += batch.count) {
    batch.count = tiles.come_to(first, kBatch);
    const std::span<const VoxelQuery> taken = queries.subspan(first, batch.count);
    take_axes(workpiece, taken, batch);
    fit_in_tiles(neighbourhood, trace, tiles, batch);
    batch.faces = 0;
    trace_others(workpiece, taken, neighbourhood, trace, batch);
    const Bits stand = map_kernels().feet(batch.surfaces.data(), batch.groups());
    const Bits wide = neighbourhood >= kLeastForWide && has_wide_maps(neighbourhood)
                          ? widen_faces(workpiece, taken, neighbourhood, trace, batch)
                          : 0;

    SurfaceEstimate* const to = estimates.data() + first;
    Bits faces = 0;  // that stand; a surface may where its face does not
    for_each(batch.faces, [&](std::size_t k) {
      const Eigen::Vector3f coarse = batch.coarse(k);
      to[k] = to_index_space(batch.feet[k], batch.axes(k));
      if (stands(to[k].normal, coarse, heard(taken[k].outward, coarse))) faces |= bit_of(k);
    });
    const Bits surfaces = stand & (batch.even | batch.partly) & ~faces;
    for_each(surfaces, [&](std::size_t k) {
      const SurfaceGroup& group = batch.group(k);
      const int place = Batch::place(k);
      to[k] = {group.normal(place), group.offset[place], true, batch.axes(k).window()};
    });
    // No map: an edge sharper than the steps allow. The face of the voxel is the best surface.
    for_each(batch.sided & ~(faces | surfaces), [&](std::size_t k) {
      const Eigen::Vector3f coarse = batch.coarse(k);
      to[k] = last_resort(coarse, heard(taken[k].outward, coarse), batch.axes(k).window());
    });
    for_each(wide, [&](std::size_t k) { to[k].windows |= SurfaceEstimate::kWideWindow; });
    for_each(first_bits(batch.count) & ~batch.sided, [&](std::size_t k) { to[k] = {}; });
  }
}

}  // namespace sulcus
