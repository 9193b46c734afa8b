#include "engine/normals/ldm_fast.hpp"

#include <array>

#include "engine/normals/equal_axes.hpp"
#include "engine/normals/grown_plane.hpp"
#include "engine/normals/map_batch.hpp"
#include "engine/normals/tilted_fit.hpp"
#include "engine/normals/wide_map.hpp"

namespace sulcus {

namespace {

/// Voxels whose surfaces are faces instead of what was fitted to their maps.
struct Faces {
  VoxelBits found = 0;
  std::array<ClosestPoint, MapBatch::kSize> closest;

  void put(std::size_t k, const ClosestPoint& point) {
    closest[k] = point;
    found |= bit_of(k);
  }
};

/// Of maps across an edge, the faces that the columns nearest to the voxel and half of the map lie
/// on, where there are any.
void find_edge_faces(MapBatch& batch, std::span<const std::size_t> traced, Faces& faces) {
  static_assert(MapBatch::kMaps <= kMostGrowths);
  std::array<PlaneGrowth, kMostGrowths> growths;
  std::array<std::size_t, kMostGrowths> of;
  std::size_t count = 0;
  for (const std::size_t k : traced) {
    const HeightMap& map = batch.map(k);
    if (map.even_rings > kRingsAtEdge || map.even_rings >= map.ns) continue;
    const std::optional<ClosestPoint> close = close_plane(map);
    if (!close) continue;
    const int half = (2 * map.ns + 1) * (2 * map.ns + 1) / 2;
    growths[count] = {&map, plane_to_grow(map, *close), half, PlaneStart::kFit, {}};
    of[count++] = k;
  }
  grow_planes(std::span(growths).first(count));
  for (std::size_t n = 0; n < count; ++n) {
    if (growths[n].closest) faces.put(of[n], *growths[n].closest);
  }
}

/// Faces as wide maps show them, of the surfaces that are nearly flat. Returns which were looked
/// for.
VoxelBits find_wide_faces(MapBatch& batch, Faces& faces) {
  const int ns = batch.neighbourhood();
  if (ns < kLeastForWide || !has_wide_maps(ns)) return 0;
  const float per = 1.0f / static_cast<float>(ns * ns);
  VoxelBits looked = 0;
  for_each(batch.whole, [&](std::size_t k) {
    const SurfaceGroup& group = batch.group(k);
    const int lane = MapBatch::lane(k);
    const float most =
        group.normal_z[lane] > kLevelFaceCosine ? kFastLevelFaceCurvature : kFastFaceCurvature;
    if (!(group.curvature[lane] <= most * per)) return;
    looked |= bit_of(k);
    HeightMap map;
    trace_wide(batch.workpiece(), batch.query(k).voxel, batch.axes(k), batch.coarse(k), ns,
               batch.trace(), map);
    if (map.even_rings < ns) return;
    const ColumnQuadric surface = fit_whole(map, quadric_filter(ns, map.lanes));
    const ClosestPoint closest = closest_point_of(surface);
    if (is_face(surface, closest, ns)) faces.put(k, closest);
  });
  return looked;
}

/// Estimates of the voxels of a batch.
void estimate_batch_fast(MapBatch& batch, SurfaceEstimate* to) noexcept {
  Faces faces;
  for (VoxelBits rest = batch.has_direction & ~batch.in_tile; rest != 0;) {
    const std::span<const std::size_t> traced = batch.trace_some(rest);
    find_edge_faces(batch, traced, faces);
    for (const std::size_t k : traced) {
      if (!has_bit(faces.found, k)) batch.fit_traced(k);
    }
  }
  const VoxelBits consistent = batch.find_surfaces(SurfaceParts::kClosestPoints);
  const VoxelBits wide = find_wide_faces(batch, faces);

  const auto hint = [&](std::size_t k) { return tool_hint(batch.tool(k), batch.coarse(k)); };
  VoxelBits of_faces = 0;  // that are consistent; a surface may be where its face is not
  for_each(faces.found, [&](std::size_t k) {
    to[k] = to_index_space(faces.closest[k], batch.axes(k));
    if (is_consistent(to[k].normal, batch.coarse(k), hint(k))) of_faces |= bit_of(k);
  });
  const VoxelBits of_surfaces = consistent & (batch.whole | batch.partly) & ~of_faces;
  for_each(of_surfaces, [&](std::size_t k) {
    const SurfaceGroup& group = batch.group(k);
    const int lane = MapBatch::lane(k);
    to[k] = {group.normal(lane), group.offset[lane], true, batch.axes(k).window()};
  });
  // No map: an edge sharper than the steps allow. The face of the voxel is the best surface.
  for_each(batch.has_direction & ~(of_faces | of_surfaces), [&](std::size_t k) {
    to[k] = last_resort(batch.coarse(k), hint(k), batch.axes(k).window());
  });
  for_each(wide, [&](std::size_t k) { to[k].windows |= SurfaceEstimate::kWideWindow; });
  for (std::size_t k = 0; k < batch.count(); ++k) {
    if (!has_bit(batch.has_direction, k)) to[k] = {};
  }
}

}  // namespace

void estimate_ldm_fast(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                       int neighbourhood, int trace,
                       std::span<SurfaceEstimate> estimates) noexcept {
  MapBatch batch(workpiece, queries, neighbourhood, trace, FitWindow::kEvenRings);
  for (std::size_t first = 0, count; first < queries.size(); first += count) {
    count = batch.take(first, MapBatch::kSize);
    SurfaceEstimate* const to = estimates.data() + first;
    const auto estimate = [&](SurfaceEstimate* of) { estimate_batch_fast(batch, of); };
    estimate(to);
    estimate_equal_axes(batch, estimate, to);
  }
}

}  // namespace sulcus
