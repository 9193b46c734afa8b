#include "engine/normals/ldm.hpp"

#include <cmath>
#include <optional>

#include "engine/normals/coarse_normal.hpp"
#include "engine/normals/column_quadric.hpp"
#include "engine/normals/half_disc.hpp"
#include "engine/normals/map_kernels.hpp"
#include "engine/normals/tilted_fit.hpp"

namespace sulcus {

namespace {
using Eigen::Vector3f;

// Each of these is in voxels, or a share.
constexpr float kMostResidual = 0.35f;  // of a whole map, beyond half the cosine of its tilt
constexpr float kMostWideResidual = 0.6f;
constexpr float kMostCubic = 0.13f;    // of the quadric's own part, at the rim of the map
constexpr float kLevelCosine = 0.98f;  // where the surface is so level, a map of stride 2 helps
constexpr float kSecondAxis = 0.55f;   // of the dominant component of the coarse normal
constexpr float kRadii[] = {8.0f, 6.0f, 4.2f, 2.6f};
constexpr float kNearEdge = 3.0f;  // a ball no larger than this

void trace_along(const Workpiece& workpiece, const Cell& voxel, int axis, int trace,
                 HeightMap& map) noexcept {
  map_kernels().trace(workpiece.columns().around(axis, voxel[(axis + 1) % 3], voxel[(axis + 2) % 3],
                                                 voxel[axis] - kLevel),
                      trace, map);
}

/// One quadric over a whole map, where it explains all heights.
std::optional<Foot> fit_whole(const HeightMap& map) noexcept {
  if (map.whole_rings < map.ns) return {};
  const QuadricFilter& filter = quadric_filter(map.ns, map.lanes);
  Quadric fitted;
  map_kernels().fit(map, filter, fitted);
  const ColumnQuadric surface = column_quadric(fitted, filter, map.stride);
  const auto rim = static_cast<float>(map.ns * map.stride);
  if (!((std::abs(surface.t_x) + std::abs(surface.t_y)) * rim < kMostCubic)) return {};
  const float cosine =
      1.0f / std::sqrt(1.0f + surface.c[1] * surface.c[1] + surface.c[2] * surface.c[2]);
  const float most = map.stride == 1 ? kMostResidual + 0.5f * cosine : kMostWideResidual;
  if (map_kernels().largest_residual(map, surface) > most) return {};
  return foot_of(surface);
}

SurfaceEstimate estimate_along(const Workpiece& workpiece, const Cell& voxel, int neighbourhood,
                               int trace, const Vector3f& coarse) noexcept {
  int axis = 0;
  const float component = coarse.cwiseAbs().maxCoeff(&axis);
  HeightMap map;
  map.ns = neighbourhood;
  map.sign = coarse[axis] > 0.0f ? 1 : -1;
  trace_along(workpiece, voxel, axis, trace, map);

  if (const std::optional<Foot> whole = fit_whole(map)) {
    if (whole->normal.z() > kLevelCosine && lanes_of(neighbourhood) == 16) {
      HeightMap wide;
      wide.ns = neighbourhood;
      wide.stride = 2;
      wide.sign = map.sign;
      trace_along(workpiece, voxel, axis, trace, wide);
      if (const std::optional<Foot> wider = fit_whole(wide)) {
        return from_map_space(*wider, axis, map.sign);
      }
    }
    return from_map_space(*whole, axis, map.sign);
  }

  std::optional<Foot> in_ball;
  if (const std::optional<Vector3f> tilt = first_tilt(map)) {
    for (const float radius : kRadii) {
      in_ball = fit_tilted(map, *tilt, radius);
      if (!in_ball) continue;
      if (radius > kNearEdge) return from_map_space(*in_ball, axis, map.sign);
      break;
    }
  }

  std::optional<HalfDisc> nearest = nearest_half_disc(map);
  Vector3f rest = coarse.cwiseAbs();
  rest[axis] = -1.0f;
  int second = 0;
  if (rest.maxCoeff(&second) > kSecondAxis * component) {
    HeightMap other;
    other.ns = neighbourhood;
    other.sign = coarse[second] > 0.0f ? 1 : -1;
    trace_along(workpiece, voxel, second, trace, other);
    const std::optional<HalfDisc> across = nearest_half_disc(other);
    if (across && (!nearest || across->score < nearest->score)) {
      return from_map_space(across->foot, second, other.sign);
    }
  }
  if (nearest) {
    return from_map_space(nearest->foot, axis, map.sign);
  }
  if (in_ball) return from_map_space(*in_ball, axis, map.sign);
  // Nothing fits, as on the floor of a fissure. The coarse normal errs least there.
  return {coarse.normalized(), 0.5f, true};
}

}  // namespace

SurfaceEstimate estimate_ldm(const Workpiece& workpiece, const Cell& voxel, int neighbourhood,
                             int trace, const Vector3f& outward) noexcept {
  Vector3f coarse = coarse_normal(workpiece, voxel).cast<float>();
  if (coarse == Vector3f::Zero()) coarse = outward;
  if (coarse == Vector3f::Zero()) return {};
  const SurfaceEstimate estimate = estimate_along(workpiece, voxel, neighbourhood, trace, coarse);
  if (estimate.normal.dot(coarse) > 0.0f) return estimate;
  return {coarse.normalized(), 0.5f, true};
}

}  // namespace sulcus
