#include "engine/normals/ldm.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/normals/grown_plane.hpp"
#include "engine/normals/half_disc.hpp"
#include "engine/normals/map_group.hpp"
#include "engine/normals/tilted_fit.hpp"

namespace sulcus {

namespace {

using Eigen::Vector3f;

// Each of these is in voxels, or a share.
constexpr float kMostResidual = 0.35f;  // of a whole map, beyond half the cosine of its tilt
constexpr float kMostWideResidual = 0.6f;
constexpr float kMostCubic = 0.2f;     // of the quadric's own part, at the rim of the map
constexpr float kLevelCosine = 0.98f;  // where the surface is so level, a map of stride 2 helps
constexpr float kSecondAxis = 0.55f;   // of the dominant component of the coarse normal
constexpr float kRadii[] = {7.6f, 5.8f, 4.2f, 2.6f};  // at NS = 6
constexpr float kNearEdge = 3.0f;                     // a ball no larger than this
constexpr float kMostBend = 0.2f;                     // of a face, across it, half a map out

/// Whether the quadric of a whole map explains its heights; with what it leaves of them.
bool explains(const MapRows& map, const ColumnQuadric& surface, float cosine,
              ResidualCubes& left) noexcept {
  const auto rim = static_cast<float>(map.ns * map.stride);
  if (!((std::abs(surface.t_x) + std::abs(surface.t_y)) * rim < kMostCubic)) return false;
  const float most = map.stride == 1 ? kMostResidual + 0.5f * cosine : kMostWideResidual;
  return map_kernels().map_residuals(map, surface, left) <= most * most;
}

/// The face that a whole map shows, where its quadric is as good as flat.
std::optional<Foot> flat_face(MapGroup& group, std::size_t k, const ColumnQuadric& surface,
                              const Foot& foot) noexcept {
  const auto& c = surface.c;
  const int ns = group.rows(k).ns;
  const auto rim = static_cast<float>(ns);
  const float bend = (std::abs(c[3]) + std::abs(c[4]) + std::abs(c[5])) * rim * rim;
  if (bend * foot.normal_z > kMostBend) return {};
  return grow_plane(group.map(k), foot, (2 * ns + 1) * (2 * ns + 1), false);
}

/// The surface of a map of stride 2, where that is whole and a quadric explains it.
std::optional<Foot> fit_wide(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                             int neighbourhood, int trace) noexcept {
  HeightMap map;
  map.ns = neighbourhood;
  map.stride = 2;
  trace_along(workpiece, voxel, axes, trace, map);
  if (map.whole_rings < map.ns) return {};
  const QuadricFilter& filter = quadric_filter(map.ns, map.lanes);
  QuadricSums sums;
  map_kernels().fit(map.middle_row(), map.lanes, filter, sums);
  const int level = map.at(0, 0);
  ColumnQuadric surface = column_quadric(quadric_of(sums, level, level, map.sign, filter.solution),
                                         filter.answers, static_cast<float>(map.stride));
  ResidualCubes left;
  if (!explains(rows_of(map), surface, foot_of(surface).normal_z, left)) return {};
  sharpen(filter.solution, left, static_cast<float>(map.stride), surface);
  return foot_of(surface);
}

/// The face nearest to the voxel that its map, or one across the second axis, has. Adds to
/// `windows` where it looked.
std::optional<SurfaceEstimate> nearest_face(const Workpiece& workpiece, const Cell& voxel,
                                            const HeightMap& map, const MapAxes& axes, int trace,
                                            const Vector3f& coarse, const Vector3f& tool,
                                            std::uint8_t& windows) noexcept {
  const std::optional<HalfDisc> nearest =
      nearest_half_disc(map, to_map_space(coarse, axes).normalized(), to_map_space(tool, axes));
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
    const std::optional<HalfDisc> across = nearest_half_disc(
        other, to_map_space(coarse, second).normalized(), to_map_space(tool, second));
    if (across && (!nearest || across->score < nearest->score)) {
      return to_index_space(across->foot, second);
    }
  }
  if (nearest) return to_index_space(nearest->foot, axes);
  return {};
}

/// Where no quadric explains the whole map.
SurfaceEstimate estimate_in_parts(const Workpiece& workpiece, const Cell& voxel,
                                  const HeightMap& map, const MapAxes& axes, int trace,
                                  const Vector3f& coarse, const Vector3f& tool,
                                  std::uint8_t& windows) noexcept {
  std::optional<Foot> in_ball;
  if (const std::optional<Foot> close = close_plane(map)) {
    const Vector3f tilt(close->normal_x, close->normal_y, close->normal_z);
    const float wide = std::max(1.0f, static_cast<float>(map.ns) / 6.0f);
    for (const float at_six : kRadii) {
      // The largest grows with the map; the others are there for what is small.
      const float radius = at_six == kRadii[0] ? at_six * wide : at_six;
      in_ball = fit_tilted(map, tilt, radius);
      if (!in_ball) continue;
      if (radius > kNearEdge) return to_index_space(*in_ball, axes);
      break;
    }
  }
  const std::optional<SurfaceEstimate> face =
      nearest_face(workpiece, voxel, map, axes, trace, coarse, tool, windows);
  if (face) return *face;
  if (in_ball) return to_index_space(*in_ball, axes);
  // Nothing fits, as on the floor of a fissure. The coarse normal errs least there.
  return last_resort(coarse, tool, windows);
}

}  // namespace

void estimate_ldm(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                  int neighbourhood, int trace, std::span<SurfaceEstimate> estimates) noexcept {
  const bool has_wide = lanes_of(neighbourhood) == lanes_of(1);
  MapGroup group;
  LeafTiles tiles(workpiece, queries, neighbourhood);
  for (std::size_t first = 0, count; first < queries.size(); first += count) {
    count = group.take(workpiece, queries, first, neighbourhood, trace, tiles);
    std::array<bool, MapGroup::kSize> explained{};
    for (std::size_t k = 0; k < count; ++k) {
      const int place = static_cast<int>(k);
      ResidualCubes left{};
      explained[k] = group.is_whole(k) && explains(group.rows(k), group.surfaces.surface(place),
                                                   group.surfaces.foot(place).normal_z, left);
      group.surfaces.put_residuals(place, left);
    }
    map_kernels().sharpen_group(group.surfaces);
    for (std::size_t k = 0; k < count; ++k) {
      const Cell& voxel = queries[first + k].voxel;
      const MapAxes& axes = group.axes[k];
      const Vector3f& coarse = group.coarse[k];
      SurfaceEstimate& estimate = estimates[first + k];
      estimate = {};
      if (coarse == Vector3f::Zero()) continue;
      std::uint8_t windows = axes.window();
      const Vector3f tool = heard(queries[first + k].outward, coarse);
      if (explained[k]) {
        const int place = static_cast<int>(k);
        const Foot foot = group.surfaces.foot(place);
        const bool level = foot.normal_z > kLevelCosine && has_wide;
        if (level) windows |= SurfaceEstimate::kWideWindow;
        const std::optional<Foot> wide =
            level ? fit_wide(workpiece, voxel, axes, neighbourhood, trace) : std::optional<Foot>();
        const std::optional<Foot> face =
            wide ? wide : flat_face(group, k, group.surfaces.surface(place), foot);
        estimate = to_index_space(face ? *face : foot, axes);
      } else {
        estimate =
            estimate_in_parts(workpiece, voxel, group.map(k), axes, trace, coarse, tool, windows);
      }
      if (!stands(estimate.normal, coarse, tool)) {
        const std::optional<SurfaceEstimate> face =
            nearest_face(workpiece, voxel, group.map(k), axes, trace, coarse, tool, windows);
        estimate = face ? *face : last_resort(coarse, tool, windows);
      }
      estimate.windows = windows;
    }
  }
}

}  // namespace sulcus
