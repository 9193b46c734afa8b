#include "engine/normals/ldm.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "engine/normals/grown_plane.hpp"
#include "engine/normals/half_disc.hpp"
#include "engine/normals/map_group.hpp"
#include "engine/normals/tilted_fit.hpp"
#include "engine/normals/wide_map.hpp"

namespace sulcus {

namespace {

using Eigen::Vector3f;

// Each of these is in voxels, or a share.
constexpr float kMostResidual = 0.35f;  // of a whole map, beyond half the cosine of its tilt
constexpr float kMostWideResidual = 0.6f;
constexpr float kMostSeemingBend = 0.15f;  // half a map out, of what may be a face all the same
constexpr float kMostCubic = 0.2f;         // of the quadric's own part, at the rim of the map
// Where the surface is so level, a map of stride 2 helps, as on all faces: terraces are wide there,
// on what is nearly a face wider than on what is curved.
constexpr float kNearlyFlat = 1.25f;
constexpr float kLevelFace = 0.98f, kLevelCurved = 0.995f;
// Slopes so near to whole numbers have wide terraces along diagonals of the grid, too. Few of them
// lie in a map, and a face may look bent by them.
constexpr float kNearWhole = 0.1f;
constexpr float kSecondAxis = 0.55f;  // of the dominant component of the coarse normal
constexpr float kRadii[] = {7.6f, 5.8f, 4.2f, 2.6f};  // at NS = 6
constexpr float kNearEdge = 3.0f;                     // a ball no larger than this
constexpr float kMostBend = 0.2f;                     // of a face, across it, half a map out

/// Whether a quadric may explain the heights of a whole map, as far as it can be told without them.
bool may_explain(float t_x, float t_y, float rim) noexcept {
  return (std::abs(t_x) + std::abs(t_y)) * rim < kMostCubic;
}
float most_residual2(float cosine) noexcept {
  const float most = kMostResidual + 0.5f * cosine;
  return most * most;
}

/// Which of a group's whole maps their quadrics explain, a bit for each; with what those leave.
std::uint32_t explained_of(MapGroup& group, int neighbourhood) noexcept {
  static_assert(MapGroup::kSize <= 32);
  const auto rim = static_cast<float>(neighbourhood);
  std::uint32_t explained = 0;
  for (std::size_t e = 0; e < group.eights(); ++e) {
    SurfaceGroup& surfaces = group.surfaces[e];
    unsigned may = 0, does = 0;
    for (unsigned k = 0; k < SurfaceGroup::kSize; ++k) {
      const bool asked = group.is_whole(e * SurfaceGroup::kSize + k) &&
                         may_explain(surfaces.t_x[k], surfaces.t_y[k], rim);
      may |= (asked ? 1u : 0u) << k;
    }
    map_kernels().group_residuals(group.rows(e), may, surfaces);
    for (unsigned k = 0; k < SurfaceGroup::kSize; ++k) {
      const bool within = surfaces.largest2[k] <= most_residual2(surfaces.normal_z[k]);
      does |= (within ? 1u : 0u) << k;
    }
    explained |= (may & does) << (e * SurfaceGroup::kSize);
  }
  return explained;
}

/// A voxel, and what its surface is looked for with.
struct Target {
  const Workpiece& workpiece;
  const Cell& voxel;
  const MapAxes& axes;
  const Vector3f& coarse;
  Vector3f tool;
  int neighbourhood, trace;
  std::uint8_t windows;  // where was looked
};

void trace_wide(Target& target, HeightMap& map) noexcept {
  target.windows |= SurfaceEstimate::kWideWindow;
  trace_wide(target.workpiece, target.voxel, target.axes, target.neighbourhood, target.trace, map);
}

/// The surface of a map of stride 2: the quadric that explains it, where it is whole and that is a
/// face, or where it need not be (`or_curved`). Where the map is not whole, or a face may only look
/// bent, the face near to `first` that all of it lies on.
std::optional<Foot> fit_wide(Target& target, bool or_curved, const Foot& first) noexcept {
  HeightMap map;
  trace_wide(target, map);
  if (map.whole_rings < map.ns) return face_over(map, first);
  const QuadricFilter& filter = quadric_filter(map.ns, map.lanes);
  ColumnQuadric surface = fit_whole(map, filter);
  const auto rim = static_cast<float>(map.ns * map.stride);
  ResidualCubes left;
  if (!may_explain(surface.t_x, surface.t_y, rim) ||
      !(map_kernels().map_residuals(rows_of(map), surface, left) <=
        kMostWideResidual * kMostWideResidual)) {
    if (!bends_by_no_more(kMostSeemingBend, surface, first, map.ns)) return {};
    return face_over(map, first);
  }
  sharpen(filter.solution, left, static_cast<float>(map.stride), surface);
  const Foot foot = foot_of(surface);
  if (!or_curved && !is_face(surface, foot, map.ns)) return {};
  return foot;
}

/// The face nearest to the voxel that its map, or one across the second axis, has; `inside`, as a
/// small ball tells.
std::optional<SurfaceEstimate> nearest_face(Target& target, const HeightMap& map, bool inside,
                                            TiltedFitter& fitter) noexcept {
  const MapAxes& axes = target.axes;
  const auto nearest_on = [&](const HeightMap& of, const MapAxes& along) {
    return nearest_half_disc(of, to_map_space(target.coarse, along).normalized(),
                             to_map_space(target.tool, along), inside, fitter);
  };
  const std::optional<HalfDisc> nearest = nearest_on(map, axes);
  Vector3f rest = target.coarse.cwiseAbs();
  const float component = rest[axes.axis];
  rest[axes.axis] = -1.0f;
  MapAxes second;
  if (rest.maxCoeff(&second.axis) > kSecondAxis * component) {
    second.sign = target.coarse[second.axis] > 0.0f ? 1 : -1;
    target.windows |= second.window();
    HeightMap other;
    other.ns = map.ns;
    trace_along(target.workpiece, target.voxel, second, target.trace, other);
    const std::optional<HalfDisc> across = nearest_on(other, second);
    if (across && (!nearest || across->score < nearest->score)) {
      return to_index_space(across->foot, second);
    }
  }
  if (nearest) return to_index_space(nearest->foot, axes);
  return {};
}

/// How the quadric of a whole map lies, where a wide map may see more.
struct Lie {
  bool flat = false, level = false;
};
Lie lie_of(float bend, float cosine, int neighbourhood) noexcept {
  const float flat = kMostBend / static_cast<float>(neighbourhood * neighbourhood);
  const float least_level = bend <= kNearlyFlat * flat ? kLevelFace : kLevelCurved;
  return {bend <= flat, cosine > least_level && has_wide_maps(neighbourhood)};
}

/// The foot on the quadric that explains a whole map, or on what it is taken for.
Foot explained_foot(Target& target, const Foot& foot, const Lie& lie, MapGroup& group,
                    std::size_t k) noexcept {
  std::optional<Foot> better;
  if (has_wide_maps(target.neighbourhood) && (lie.level || lie.flat)) {
    better = fit_wide(target, lie.level, foot);
  }
  if (!better && lie.flat) {
    const int columns = (2 * target.neighbourhood + 1) * (2 * target.neighbourhood + 1);
    better = grow_plane(group.map(k), foot, columns, false);
  }
  return better.value_or(foot);
}

/// Whether a face has wide terraces, along an axis or a diagonal.
bool has_near_whole_slopes(const Foot& foot) noexcept {
  const auto near = [&](float component) {
    const float slope = std::abs(component / foot.normal_z);
    const float over = slope - static_cast<float>(static_cast<int>(slope));
    return std::min(over, 1.0f - over) <= kNearWhole;
  };
  return foot.normal_z > kLeastPlaneCosine && near(foot.normal_x) && near(foot.normal_y);
}

/// The foot on what explains a ball about a voxel.
struct Ball {
  Foot foot;
  bool is_small = false;  // the voxel is near to an edge
};

/// The largest balls that are explained, of the voxels of a group that `which` has a bit for.
void find_balls(MapGroup& group, std::uint32_t which, int neighbourhood, TiltedFitter& fitter,
                std::array<std::optional<Ball>, MapGroup::kSize>& balls) noexcept {
  if (which == 0) return;
  std::array<TiltedFit, MapGroup::kSize> fits;
  std::array<unsigned, MapGroup::kSize> of;
  std::size_t count = 0;
  for (; which != 0; which &= which - 1) {
    const auto k = static_cast<unsigned>(std::countr_zero(which));
    const Vector3f tilt = to_map_space(group.coarse[k], group.axes[k]).normalized();
    fits[count] = {&group.map(k), tilt, 0.0f, {}, {}};
    of[count++] = k;
  }
  const float wide = std::max(1.0f, static_cast<float>(neighbourhood) / 6.0f);
  for (const float at_six : kRadii) {
    // The largest grows with the map; the others are there for what is small.
    const float radius = at_six == kRadii[0] ? at_six * wide : at_six;
    for (std::size_t n = 0; n < count; ++n) fits[n].radius = radius;
    fitter.fit(std::span(fits).first(count));
    std::size_t left = 0;
    for (std::size_t n = 0; n < count; ++n) {
      if (fits[n].foot) {
        balls[of[n]] = {*fits[n].foot, radius < kNearEdge};
      } else {
        fits[left] = fits[n];
        of[left++] = of[n];
      }
    }
    count = left;
  }
}

/// The same where a face may be, on that.
Foot ball_foot(Target& target, const Ball& ball) noexcept {
  if (!has_wide_maps(target.neighbourhood) || !has_near_whole_slopes(ball.foot)) return ball.foot;
  HeightMap map;
  trace_wide(target, map);
  return face_over(map, ball.foot).value_or(ball.foot);
}

}  // namespace

void estimate_ldm(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                  int neighbourhood, int trace, std::span<SurfaceEstimate> estimates) noexcept {
  MapGroup group;
  TiltedFitter fitter;
  LeafTiles tiles(workpiece, queries, neighbourhood, false);
  for (std::size_t first = 0, count; first < queries.size(); first += count) {
    count = group.take(workpiece, queries, first, neighbourhood, trace, tiles);
    const std::uint32_t explained = explained_of(group, neighbourhood);
    std::array<std::optional<Ball>, MapGroup::kSize> balls;
    find_balls(group, group.sided() & ~explained, neighbourhood, fitter, balls);
    for (std::size_t e = 0; e < group.eights(); ++e) map_kernels().sharpen_group(group.surfaces[e]);
    for (std::size_t k = 0; k < count; ++k) {
      const VoxelQuery& query = queries[first + k];
      const MapAxes& axes = group.axes[k];
      const Vector3f& coarse = group.coarse[k];
      SurfaceEstimate& estimate = estimates[first + k];
      if (coarse == Vector3f::Zero()) {
        estimate = {};
        continue;
      }
      const SurfaceGroup& surfaces = group.eight(k);
      const int place = MapGroup::place(k);
      const bool is_explained = (explained >> k & 1u) != 0;
      const Lie lie = lie_of(surfaces.bend[place], surfaces.normal_z[place], neighbourhood);
      if (is_explained && !lie.level && !lie.flat && surfaces.stands[place] != 0) {
        estimate = {surfaces.normal(place), surfaces.offset[place], true, axes.window()};
        continue;
      }
      const Vector3f tool = heard(query.outward, coarse);
      Target target{workpiece, query.voxel,   axes,  coarse,
                    tool,      neighbourhood, trace, axes.window()};
      const std::optional<Ball>& ball = balls[k];
      if (is_explained) {
        estimate =
            to_index_space(explained_foot(target, surfaces.foot(place), lie, group, k), axes);
      } else if (ball && !ball->is_small) {
        estimate = to_index_space(ball_foot(target, *ball), axes);
      } else if (const auto face = nearest_face(target, group.map(k), ball.has_value(), fitter)) {
        estimate = *face;
      } else {
        // Where nothing fits, as on the floor of a fissure, the coarse normal errs least.
        estimate = ball ? to_index_space(ball->foot, axes) : last_resort(coarse, tool, 0);
      }
      if (!stands(estimate.normal, coarse, tool)) {
        const auto face = nearest_face(target, group.map(k), false, fitter);
        estimate = face ? *face : last_resort(coarse, tool, 0);
      }
      estimate.windows = target.windows;
    }
  }
}

}  // namespace sulcus
