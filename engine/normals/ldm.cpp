#include "engine/normals/ldm.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/normals/equal_axes.hpp"
#include "engine/normals/grown_plane.hpp"
#include "engine/normals/half_disc.hpp"
#include "engine/normals/map_batch.hpp"
#include "engine/normals/rough_columns.hpp"
#include "engine/normals/tilted_fit.hpp"
#include "engine/normals/turned_map.hpp"
#include "engine/normals/wide_map.hpp"

namespace sulcus {

namespace {

using Eigen::Vector3f;

/// Whether a quadric may explain the heights of a whole map, judged without them.
bool may_explain(float t_x, float t_y, float rim) noexcept {
  return (std::abs(t_x) + std::abs(t_y)) * rim < kMostCubic;
}

/// Which of a batch's whole maps their quadrics explain; with what those leave in its groups.
VoxelBits find_explained(MapBatch& batch) noexcept {
  constexpr std::size_t kLanes = SurfaceGroup::kSize;
  const auto rim = static_cast<float>(batch.neighbourhood());
  VoxelBits explained = 0;
  for (std::size_t g = 0; g < batch.group_count(); ++g) {
    SurfaceGroup& group = batch.groups[g];
    std::array<MapRows, kLanes> rows;
    unsigned may = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t k = g * kLanes + lane;
      if (!has_bit(batch.whole, k) || !may_explain(group.t_x[lane], group.t_y[lane], rim)) continue;
      may |= 1u << lane;
      rows[lane] = batch.rows(k);
    }
    map_kernels().group_residuals(rows.data(), may, group);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float most = kMapResidual + 0.5f * group.normal_z[lane];
      const bool is_explained = (may >> lane & 1) != 0 && group.largest2[lane] <= most * most;
      if (is_explained) explained |= bit_of(g * kLanes + lane);
    }
  }
  return explained;
}

/// The closest points of voxels on what explains a ball about each.
struct Balls {
  VoxelBits found = 0, small = 0;  // small: the voxel is near to an edge
  VoxelBits rough = 0;  // nothing does, and the surface is rough: the largest ball's mean
  std::array<ClosestPoint, MapBatch::kMaps> closest;
};

/// Whether a ball's quadric fits but for columns out of line with their neighbours: a surface as
/// burrs leave it, where smaller balls and halves of them find edges that are none.
bool is_rough(const HeightMap& map, const TiltedFit& ball) noexcept {
  return map.ns >= kLeastForRough && ball.sagitta <= kMostRoughSagitta &&
         ball.scatter <= kMostRoughScatter && has_rough_columns(map);
}

/// The largest balls that are explained, of so many voxels, no more than kMaps. None smaller is
/// looked for where the surface is rough.
void find_balls(MapBatch& batch, VoxelBits which, TiltedFitter& fitter, Balls& balls) noexcept {
  std::array<TurnedMap, MapBatch::kMaps> maps;
  std::array<TiltedFit, MapBatch::kMaps> fits;
  std::array<std::size_t, MapBatch::kMaps> of;
  std::size_t count = 0;
  for_each(which, [&](std::size_t k) {
    const Vector3f coarse = to_map_space(batch.coarse(k), batch.axes(k));
    TurnedMap& turned = maps[k];
    turned.turn(batch.map(k), coarse);
    fits[count] = {&turned.map(), turned.turns()[0].of(coarse).normalized(), 0.0f, {}, {}};
    of[count++] = k;
  });
  const float wide = std::max(1.0f, static_cast<float>(batch.neighbourhood()) / 6.0f);
  for (const float at_six : kBallRadii) {
    // The largest grows with the map; the others are there for what is small.
    const float radius = at_six == kBallRadii[0] ? at_six * wide : at_six;
    for (std::size_t n = 0; n < count; ++n) fits[n].radius = radius;
    fitter.fit(std::span(fits).first(count));
    std::size_t left = 0;
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t k = of[n];
      if (fits[n].closest) {
        balls.closest[k] = maps[k].back(*fits[n].closest);
        balls.found |= bit_of(k);
        if (radius < kNearEdge) balls.small |= bit_of(k);
        continue;
      }
      if (at_six == kBallRadii[0] && is_rough(batch.map(k), fits[n])) {
        balls.closest[k] = maps[k].back(fits[n].unexplained);
        balls.rough |= bit_of(k);
        continue;
      }
      fits[left] = fits[n];
      of[left++] = k;
    }
    count = left;
  }
}

bool is_vetoed(const ClosestPoint& closest, const Vector3f& outward) {
  return Vector3f(closest.normal_x, closest.normal_y, closest.normal_z).dot(outward) < 0.0f;
}

/// How the quadric of a whole map lies, where a wide map may see more.
struct Flatness {
  bool planar = false, level = false;
};
Flatness flatness_of(float curvature, float cosine, int neighbourhood) noexcept {
  const float planar = kFaceCurvature / static_cast<float>(neighbourhood * neighbourhood);
  const float least_level =
      curvature <= kNearlyFlat * planar ? kLevelFaceCosine : kLevelCurvedCosine;
  return {curvature <= planar, cosine > least_level && has_wide_maps(neighbourhood)};
}

/// Whether a face has wide terraces, along an axis or a diagonal.
bool has_near_whole_slopes(const ClosestPoint& closest) noexcept {
  const auto near = [&](float component) {
    const float slope = std::abs(component / closest.normal_z);
    const float over = slope - static_cast<float>(static_cast<int>(slope));
    return std::min(over, 1.0f - over) <= kNearWhole;
  };
  return closest.normal_z > kLeastPlaneCosine && near(closest.normal_x) && near(closest.normal_y);
}

/// nearest_half_disc on a map as TurnedMap sees it. Where that is symmetric itself, the mean of
/// what it finds in each of its turns, which the tool vetoes first; `coarse` of any length.
std::optional<HalfDisc> nearest_turned(const HeightMap& map, const Vector3f& coarse,
                                       const Vector3f& outward, VoxelPlace place,
                                       TiltedFitter& fitter) noexcept {
  TurnedMap turned;
  turned.turn(map, coarse);
  const auto turns = turned.turns();
  const Vector3f turned_coarse = turns[0].of(coarse).normalized();
  const auto nearest = [&](const Vector3f& says) {
    return nearest_half_disc(turned.map(), turned_coarse, says, place, fitter);
  };
  const bool ask_tool = turns.size() == 1;
  std::optional<HalfDisc> mean =
      nearest(ask_tool ? turns[0].of(outward) : Vector3f(Vector3f::Zero()));
  if (mean) mean->closest = turned.back(mean->closest);
  if (ask_tool || !mean || !is_vetoed(mean->closest, outward)) return mean;
  Vector3f normal = Vector3f::Zero();
  float offset = 0.0f, score = 0.0f, count = 0.0f;
  for (const MapTurn& turn : turns) {
    const std::optional<HalfDisc> one = nearest(turn.of(outward));
    if (!one) continue;
    const ClosestPoint closest = turn.back(one->closest);
    normal += Vector3f(closest.normal_x, closest.normal_y, closest.normal_z);
    offset += closest.offset;
    score = count == 0.0f ? one->score : std::min(score, one->score);
    count += 1.0f;
  }
  if (count == 0.0f) return {};
  normal.normalize();
  return HalfDisc{{normal.x(), normal.y(), normal.z(), offset / count}, score};
}

/// Looks farther than the batch did for the surface of one of its voxels.
class Refinement {
 public:
  Refinement(MapBatch& batch, std::size_t k, TiltedFitter& fitter)
      : batch_(batch),
        fitter_(fitter),
        k_(k),
        axes_(batch.axes(k)),
        coarse_(batch.coarse(k)),
        hint_(tool_hint(batch.tool(k), coarse_)),
        windows_(axes_.window()) {}

  /// From the closest point on the quadric that explains the whole map.
  SurfaceEstimate from_map(const ClosestPoint& closest, const Flatness& flatness) noexcept {
    const int ns = batch_.neighbourhood();
    std::optional<ClosestPoint> better;
    if (has_wide_maps(ns) && (flatness.level || flatness.planar)) {
      better = fit_wide(flatness.level ? WideSurface::kAny : WideSurface::kFace, closest);
    }
    if (!better && flatness.planar) {
      const int columns = (2 * ns + 1) * (2 * ns + 1);
      better = grow_plane(batch_.map(k_), closest, columns, PlaneStart::kAsGiven);
    }
    return checked(to_index_space(better.value_or(closest), axes_));
  }
  /// From the closest point on what explains a ball that is not small; where a face may be, on
  /// that.
  SurfaceEstimate from_ball(const ClosestPoint& closest) noexcept {
    if (!has_wide_maps(batch_.neighbourhood()) || !has_near_whole_slopes(closest)) {
      return checked(to_index_space(closest, axes_));
    }
    HeightMap map;
    trace_wide_map(map);
    return checked(to_index_space(extended_plane(map, closest).value_or(closest), axes_));
  }
  /// From the closest point on the mean of a rough surface.
  SurfaceEstimate on_rough(const ClosestPoint& closest) noexcept {
    return checked(to_index_space(closest, axes_));
  }
  /// Near an edge, where a small ball, or none, is explained.
  SurfaceEstimate near_edge(const std::optional<ClosestPoint>& ball) noexcept {
    if (const auto face = nearest_face(ball ? VoxelPlace::kInsideFace : VoxelPlace::kAnywhere))
      return checked(*face);
    // Where nothing fits, as on the floor of a fissure, the coarse normal errs least.
    return checked(ball ? to_index_space(*ball, axes_) : last_resort(coarse_, hint_, 0));
  }

 private:
  enum class WideSurface : std::uint8_t { kFace, kAny };

  void trace_wide_map(HeightMap& map) noexcept {
    windows_ |= SurfaceEstimate::kWideWindow;
    trace_wide(batch_.workpiece(), batch_.query(k_).voxel, axes_, coarse_, batch_.neighbourhood(),
               batch_.trace(), map);
  }
  std::optional<ClosestPoint> fit_wide(WideSurface wanted, const ClosestPoint& first) noexcept;
  std::optional<SurfaceEstimate> nearest_face(VoxelPlace place) noexcept;
  std::optional<SurfaceEstimate> nearest_face(VoxelPlace place, std::span<const MapAxes> others,
                                              const Vector3f& hint) noexcept;
  /// What is not consistent gives way to the nearest face, or to the last resort.
  SurfaceEstimate checked(SurfaceEstimate estimate) noexcept {
    if (!is_consistent(estimate.normal, coarse_, hint_)) {
      estimate = nearest_face(VoxelPlace::kAnywhere).value_or(last_resort(coarse_, hint_, 0));
    }
    estimate.windows = windows_;
    return estimate;
  }

  MapBatch& batch_;
  TiltedFitter& fitter_;
  std::size_t k_;
  MapAxes axes_;
  Vector3f coarse_, hint_;
  std::uint8_t windows_;  // looked at
};

/// The surface of a map of stride 2: the quadric that explains it, where it is whole and that is a
/// face, or any is wanted. Where the map is not whole, or a face may only look curved, the face
/// near to `first` that all of it lies on.
std::optional<ClosestPoint> Refinement::fit_wide(WideSurface wanted,
                                                 const ClosestPoint& first) noexcept {
  HeightMap map;
  trace_wide_map(map);
  if (map.whole_rings < map.ns) return extended_plane(map, first);
  const QuadricFilter& filter = quadric_filter(map.ns, map.lanes);
  ColumnQuadric surface = fit_whole(map, filter);
  const auto rim = static_cast<float>(map.ns * map.stride);
  ResidualCubes left;
  if (!may_explain(surface.t_x, surface.t_y, rim) ||
      !(map_kernels().map_residuals(rows_of(map), surface, left) <=
        kWideMapResidual * kWideMapResidual)) {
    if (!is_curved_at_most(kApparentCurvature, surface, first, map.ns)) return {};
    return extended_plane(map, first);
  }
  sharpen(filter.solution, left, static_cast<float>(map.stride), surface);
  const ClosestPoint closest = closest_point_of(surface);
  if (wanted == WideSurface::kFace && !is_face(surface, closest, map.ns)) return {};
  return closest;
}

/// The face nearest to the voxel that its map, or one across the second axis, has.
std::optional<SurfaceEstimate> Refinement::nearest_face(VoxelPlace place) noexcept {
  Vector3f rest = coarse_.cwiseAbs();
  const float component = rest[axes_.axis];
  rest[axes_.axis] = -1.0f;
  const float largest = rest.maxCoeff();
  std::array<MapAxes, 2> others;  // both, where they are equal
  std::size_t count = 0;
  for (int axis = 0; axis < 3 && largest > kSecondAxis * component; ++axis) {
    if (rest[axis] == largest) others[count++] = {axis, coarse_[axis] > 0.0f ? 1 : -1};
  }
  if (count == 2 && !hint_.isZero()) {
    // What the tool vetoes first is the mean of equals.
    const auto face = nearest_face(place, others, Vector3f::Zero());
    if (!face || !(face->normal.dot(hint_) < 0.0f)) return face;
  }
  return nearest_face(place, std::span(others).first(count), hint_);
}

std::optional<SurfaceEstimate> Refinement::nearest_face(VoxelPlace place,
                                                        std::span<const MapAxes> others,
                                                        const Vector3f& hint) noexcept {
  const auto nearest_on = [&](const HeightMap& map, const MapAxes& along) {
    return nearest_turned(map, to_map_space(coarse_, along), to_map_space(hint, along), place,
                          fitter_);
  };
  const HeightMap& map = batch_.map(k_);
  std::optional<SurfaceEstimate> face, across_first;
  float score = 0.0f;
  if (const auto nearest = nearest_on(map, axes_)) {
    face = to_index_space(nearest->closest, axes_);
    score = nearest->score;
  }
  for (const MapAxes& other : others) {
    windows_ |= other.window();
    HeightMap other_map;
    other_map.ns = map.ns;
    trace_along(batch_.workpiece(), batch_.query(k_).voxel, other, coarse_, batch_.trace(),
                other_map);
    const auto across = nearest_on(other_map, other);
    if (!across) continue;
    const SurfaceEstimate estimate = to_index_space(across->closest, other);
    if (across_first && std::abs(across->score - score) <= kEqualScore) {
      const SurfaceEstimate mean = mean_of(std::array{*across_first, estimate});
      if (mean.defined) face = mean;
    } else if (!face || across->score < score) {
      face = across_first = estimate;
      score = across->score;
    }
  }
  return face;
}

/// Estimates of the voxels of a batch.
void estimate_batch(MapBatch& batch, TiltedFitter& fitter, SurfaceEstimate* to) noexcept {
  VoxelBits rest = batch.has_direction & ~batch.in_tile;
  for (const std::size_t k : batch.trace_some(rest)) batch.fit_traced(k);
  batch.find_surfaces(SurfaceParts::kAll);
  const VoxelBits explained = find_explained(batch);
  Balls balls;
  find_balls(batch, batch.has_direction & ~explained, fitter, balls);
  for (std::size_t g = 0; g < batch.group_count(); ++g) {
    map_kernels().sharpen_group(batch.groups[g]);
  }
  for (std::size_t k = 0; k < batch.count(); ++k) {
    if (!has_bit(batch.has_direction, k)) {
      to[k] = {};
      continue;
    }
    const SurfaceGroup& group = batch.group(k);
    const int lane = MapBatch::lane(k);
    const bool is_explained = has_bit(explained, k);
    const Flatness flatness =
        flatness_of(group.curvature[lane], group.normal_z[lane], batch.neighbourhood());
    if (is_explained && !flatness.level && !flatness.planar && group.consistent[lane] != 0) {
      to[k] = {group.normal(lane), group.offset[lane], true, batch.axes(k).window()};
      continue;
    }
    Refinement refinement(batch, k, fitter);
    const bool has_ball = has_bit(balls.found, k);
    if (is_explained) {
      to[k] = refinement.from_map(group.closest_point(lane), flatness);
    } else if (has_bit(balls.rough, k)) {
      to[k] = refinement.on_rough(balls.closest[k]);
    } else if (has_ball && !has_bit(balls.small, k)) {
      to[k] = refinement.from_ball(balls.closest[k]);
    } else {
      to[k] = refinement.near_edge(has_ball ? std::optional(balls.closest[k]) : std::nullopt);
    }
  }
}

}  // namespace

void estimate_ldm(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                  int neighbourhood, int trace, std::span<SurfaceEstimate> estimates) noexcept {
  MapBatch batch(workpiece, queries, neighbourhood, trace, FitWindow::kWholeMap);
  TiltedFitter fitter;
  for (std::size_t first = 0, count; first < queries.size(); first += count) {
    count = batch.take(first, MapBatch::kMaps);
    SurfaceEstimate* const to = estimates.data() + first;
    const auto estimate = [&](SurfaceEstimate* of) { estimate_batch(batch, fitter, of); };
    estimate(to);
    estimate_equal_axes(batch, estimate, to);
  }
}

}  // namespace sulcus
