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

HeightPlane plane_through(const Foot& foot) {
  const float per = 1.0f / foot.normal_z;
  return {foot.offset * per, -foot.normal_x * per, -foot.normal_y * per, foot.normal_z,
          kPlaneSlack + 0.5f * foot.normal_z};
}

/// Adds `share` of what a step's sums give. False where they give nothing, or too steep a
/// plane.
bool add(const PlaneSums& step, float share, HeightPlane& plane) {
  const std::optional<PlaneSolution> more = solve_plane(step);
  if (!more) return false;
  const float scale = share / plane.cosine;
  plane.c0 += scale * more->c0;
  plane.c1 += scale * more->c1;
  plane.c2 += scale * more->c2;
  plane.cosine = 1.0f / std::sqrt(1.0f + plane.c1 * plane.c1 + plane.c2 * plane.c2);
  return plane.cosine >= kLeastPlaneCosine;
}

}  // namespace

std::optional<Foot> grow_plane(const HeightMap& map, const Foot& first, int least,
                               bool fit) noexcept {
  if (first.normal_z < kLeastPlaneCosine) return {};
  const MapKernels& kernels = map_kernels();
  HeightPlane plane = plane_through(first);
  PlaneSums step;
  if (fit) {
    kernels.plane_step(map, plane, PlaneWeight::kTaper, 0.0f, step);
    if (!add(step, 1.0f, plane)) return {};
    plane.slack = kPlaneSlack + 0.5f * plane.cosine;
  }
  kernels.plane_step(map, plane, PlaneWeight::kQuartic, 0.0f, step);
  if (!add(step, 1.0f / 3.0f, plane)) return {};

  PlaneLook look;
  kernels.look_at_plane(map, plane, look);
  const float mean = kMostPlaneMean * plane.cosine;
  if (look.count < least ||
      look.residuals.sum_squares > static_cast<float>(look.count) * mean * mean) {
    return {};
  }
  const float bound = std::max(kBeyond * look.residuals.largest, 0.5f * plane.cosine);
  kernels.plane_step(map, plane, PlaneWeight::kInterior, bound, step);
  if (!add(step, 1.0f, plane)) return {};
  return Foot{-plane.c1 * plane.cosine, -plane.c2 * plane.cosine, plane.cosine,
              plane.c0 * plane.cosine};
}

}  // namespace sulcus
