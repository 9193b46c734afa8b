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
constexpr float kMostSeemingBend = 0.15f;  // of a face that few terraces make look bent (is_face)
constexpr float kMostCubic = 0.2f;         // of the quadric's own part, at the rim of the map
// Where the surface is so level, a map of stride 2 helps, as on all faces: terraces are wide there,
// on what is nearly a face wider than on what is curved.
constexpr float kNearlyFlat = 1.25f;
constexpr float kLevelFace = 0.98f, kLevelCurved = 0.995f;
// Slopes so near to whole numbers have terraces as wide along diagonals of the grid. Few of them
// lie in a map, and a face may look bent by them.
constexpr float kDiagonal = 0.1f;
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

/// The surface of a map of stride 2: the quadric that explains it, where it is whole, which is
/// `flat` where that is asked for; else, of what may be one, the face near to `first` that all of
/// it lies on.
std::optional<Foot> fit_wide(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                             int neighbourhood, int trace, bool flat, const Foot& first) noexcept {
  HeightMap map;
  trace_wide(workpiece, voxel, axes, neighbourhood, trace, map);
  if (map.whole_rings < map.ns) return face_over(map, first);
  const QuadricFilter& filter = quadric_filter(map.ns, map.lanes);
  ColumnQuadric surface = fit_whole(map, filter);
  const auto rim = static_cast<float>(map.ns * map.stride);
  ResidualCubes left;
  if (!may_explain(surface.t_x, surface.t_y, rim) ||
      !(map_kernels().map_residuals(rows_of(map), surface, left) <=
        kMostWideResidual * kMostWideResidual)) {
    if (!bends_by_no_more(kMostSeemingBend, surface, first, neighbourhood)) return {};
    return face_over(map, first);
  }
  sharpen(filter.solution, left, static_cast<float>(map.stride), surface);
  const Foot foot = foot_of(surface);
  if (flat && !is_face(surface, foot, neighbourhood)) return {};
  return foot;
}

/// The face nearest to the voxel that its map, or one across the second axis, has; `inside`, as a
/// small ball tells. Adds to `windows` where it looked.
std::optional<SurfaceEstimate> nearest_face(const Workpiece& workpiece, const Cell& voxel,
                                            const HeightMap& map, const MapAxes& axes, int trace,
                                            const Vector3f& coarse, const Vector3f& tool,
                                            std::uint8_t& windows, bool inside,
                                            TiltedFitter& fitter) noexcept {
  const std::optional<HalfDisc> nearest = nearest_half_disc(
      map, to_map_space(coarse, axes).normalized(), to_map_space(tool, axes), inside, fitter);
  Vector3f rest = coarse.cwiseAbs();
  const float component = rest[axes.axis];
  rest[axes.axis] = -1.0f;
  MapAxes second;
  if (rest.maxCoeff(&second.axis) > kSecondAxis * component) {
    second.sign = coarse[second.axis] > 0.0f ? 1 : -1;
    windows |= second.window();
    HeightMap other;
    other.ns = map.ns;
    trace_along(workpiece, voxel, second, trace, other);
    const std::optional<HalfDisc> across =
        nearest_half_disc(other, to_map_space(coarse, second).normalized(),
                          to_map_space(tool, second), inside, fitter);
    if (across && (!nearest || across->score < nearest->score)) {
      return to_index_space(across->foot, second);
    }
  }
  if (nearest) return to_index_space(nearest->foot, axes);
  return {};
}

bool is_diagonal(const Foot& foot) noexcept {
  const auto near = [&](float component) {
    const float slope = std::abs(component / foot.normal_z);
    return std::abs(slope - static_cast<float>(static_cast<int>(slope + 0.5f))) <= kDiagonal;
  };
  return foot.normal_z > kLeastPlaneCosine && near(foot.normal_x) && near(foot.normal_y);
}

/// What explains a ball about a voxel.
struct Ball {
  Foot foot;
  float radius = 0.0f;  // at NS = 6
};

/// The largest balls that are explained, of the voxels of a group that `which` has a bit for.
void find_balls(MapGroup& group, std::uint32_t which, int neighbourhood, TiltedFitter& fitter,
                std::array<std::optional<Ball>, MapGroup::kSize>& balls) noexcept {
  const float wide = std::max(1.0f, static_cast<float>(neighbourhood) / 6.0f);
  for (const float at_six : kRadii) {
    // The largest grows with the map; the others are there for what is small.
    const float radius = at_six == kRadii[0] ? at_six * wide : at_six;
    for (std::uint32_t left = which; left != 0;) {
      std::array<TiltedFit, TiltedGroup::kSize> fits;
      std::array<unsigned, TiltedGroup::kSize> of;
      std::size_t count = 0;
      for (; left != 0 && count < fits.size(); left &= left - 1) {
        const auto k = static_cast<unsigned>(std::countr_zero(left));
        const Vector3f tilt = to_map_space(group.coarse[k], group.axes[k]).normalized();
        fits[count] = {&group.map(k), tilt, radius, {}, {}};
        of[count++] = k;
      }
      fitter.fit(std::span(fits).first(count));
      for (std::size_t n = 0; n < count; ++n) {
        if (!fits[n].foot) continue;
        balls[of[n]] = {*fits[n].foot, at_six};
        which &= ~(1u << of[n]);
      }
    }
  }
}

}  // namespace

void estimate_ldm(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                  int neighbourhood, int trace, std::span<SurfaceEstimate> estimates) noexcept {
  const bool has_wide = has_wide_maps(neighbourhood);
  const int columns = (2 * neighbourhood + 1) * (2 * neighbourhood + 1);
  const float flat = kMostBend / static_cast<float>(neighbourhood * neighbourhood);
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
      const Cell& voxel = queries[first + k].voxel;
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
      const bool is_flat = surfaces.bend[place] <= flat;
      const float least_level =
          surfaces.bend[place] <= kNearlyFlat * flat ? kLevelFace : kLevelCurved;
      const bool level = is_explained && surfaces.normal_z[place] > least_level && has_wide;
      const bool as_it_is = is_explained && !level && !is_flat;
      std::uint8_t windows = axes.window();
      if (as_it_is && surfaces.stands[place] != 0) {
        estimate = {surfaces.normal(place), surfaces.offset[place], true, windows};
        continue;
      }
      const Vector3f tool = heard(queries[first + k].outward, coarse);
      if (is_explained) {
        const Foot foot = surfaces.foot(place);
        const bool wide = has_wide && (level || is_flat);
        if (wide) windows |= SurfaceEstimate::kWideWindow;
        std::optional<Foot> face =
            wide ? fit_wide(workpiece, voxel, axes, neighbourhood, trace, !level, foot)
                 : std::nullopt;
        if (!face && is_flat) face = grow_plane(group.map(k), foot, columns, false);
        estimate = to_index_space(face ? *face : foot, axes);
      } else if (balls[k] && balls[k]->radius > kNearEdge) {
        Foot foot = balls[k]->foot;
        if (has_wide && is_diagonal(foot)) {
          windows |= SurfaceEstimate::kWideWindow;
          HeightMap map;
          trace_wide(workpiece, voxel, axes, neighbourhood, trace, map);
          foot = face_over(map, foot).value_or(foot);
        }
        estimate = to_index_space(foot, axes);
      } else {
        const std::optional<SurfaceEstimate> face =
            nearest_face(workpiece, voxel, group.map(k), axes, trace, coarse, tool, windows,
                         balls[k].has_value(), fitter);
        // Where nothing fits, as on the floor of a fissure, the coarse normal errs least.
        estimate = face       ? *face
                   : balls[k] ? to_index_space(balls[k]->foot, axes)
                              : last_resort(coarse, tool, windows);
      }
      if (!stands(estimate.normal, coarse, tool)) {
        const std::optional<SurfaceEstimate> face = nearest_face(
            workpiece, voxel, group.map(k), axes, trace, coarse, tool, windows, false, fitter);
        estimate = face ? *face : last_resort(coarse, tool, windows);
      }
      estimate.windows = windows;
    }
  }
}

}  // namespace sulcus
