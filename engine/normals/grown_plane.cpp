#include "engine/normals/grown_plane.hpp"

#include <algorithm>
#include <cmath>

#include "engine/normals/map_kernels.hpp"
#include "engine/normals/plane_solution.hpp"

namespace sulcus {

namespace {

constexpr float kPlaneSlack = 0.1f;      // of a residual beyond half the cosine, voxels
constexpr float kMostPlaneMean = 0.32f;  // of the residuals' root mean square, share of the cosine
constexpr float kBeyond = 1.02f;         // the bound that residuals keep, of the largest of them

/// Adds `share` of what a step's sums give. False where they give nothing, or too steep a
/// plane.
bool add(const PlaneSums& step, float share, float stride, HeightPlane& plane) {
  const std::optional<PlaneSolution> more = solve_plane(step);
  if (!more) return false;
  const float scale = share / plane.cosine;
  plane.c0 += scale * more->c0;
  plane.c1 += scale * more->c1;
  plane.c2 += scale * more->c2;
  const float x = plane.c1 / stride, y = plane.c2 / stride;
  plane.cosine = 1.0f / std::sqrt(1.0f + x * x + y * y);
  return plane.cosine >= kLeastPlaneCosine;
}

}  // namespace

HeightPlane plane_through(const Foot& foot, int stride, float excess) noexcept {
  const float per = 1.0f / foot.normal_z, per_column = per * static_cast<float>(stride);
  return {foot.offset * per, -foot.normal_x * per_column, -foot.normal_y * per_column,
          foot.normal_z, excess + 0.5f * foot.normal_z};
}

std::optional<Foot> grow_plane(const HeightMap& map, const Foot& first, int least,
                               bool fit) noexcept {
  return grow_plane(map, plane_through(first, map.stride, kPlaneSlack), least, fit);
}

std::optional<Foot> grow_plane(const HeightMap& map, const HeightPlane& first, int least,
                               bool fit) noexcept {
  if (first.cosine < kLeastPlaneCosine) return {};
  const MapKernels& kernels = map_kernels();
  const auto stride = static_cast<float>(map.stride);
  HeightPlane plane = first;
  PlaneSums step;
  if (fit) {
    kernels.plane_step(map, plane, PlaneWeight::kTaper, 0.0f, step);
    if (!add(step, 1.0f, stride, plane)) return {};
    plane.slack = kPlaneSlack + 0.5f * plane.cosine;
  }
  kernels.plane_step(map, plane, PlaneWeight::kQuartic, 0.0f, step);
  if (!add(step, 1.0f / 3.0f, stride, plane)) return {};

  PlaneLook look;
  kernels.look_at_plane(map, plane, look);
  const float mean = kMostPlaneMean * plane.cosine;
  if (look.count < least ||
      look.residuals.sum_squares > static_cast<float>(look.count) * mean * mean) {
    return {};
  }
  const float bound = std::max(kBeyond * look.residuals.largest, 0.5f * plane.cosine);
  kernels.plane_step(map, plane, PlaneWeight::kInterior, bound, step);
  if (!add(step, 1.0f, stride, plane)) return {};
  const float per_voxel = plane.cosine / stride;
  return Foot{-plane.c1 * per_voxel, -plane.c2 * per_voxel, plane.cosine, plane.c0 * plane.cosine};
}

}  // namespace sulcus
