#include "engine/normals/grown_plane.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "engine/normals/ldm_tuning.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

/// Adds `share` of what a step's sums give. False where they give nothing, or too steep a
/// plane.
bool add(const PlaneSums& step, float share, int stride, HeightPlane& plane) {
  const std::optional<PlaneSolution> more = solve_plane(step);
  if (!more) return false;
  const float scale = share / plane.cosine;
  plane.c0 += scale * more->c0;
  plane.c1 += scale * more->c1;
  plane.c2 += scale * more->c2;
  const auto voxels = static_cast<float>(stride);
  const float x = plane.c1 / voxels, y = plane.c2 / voxels;
  plane.cosine = 1.0f / std::sqrt(1.0f + (x * x + y * y));
  return plane.cosine >= kLeastPlaneCosine;
}

/// Stage by stage, all planes in each, so that none waits for what it has just solved.
template <std::size_t kMost>
void grow(std::span<PlaneGrowth> growths) {
  assert(growths.size() <= kMost);
  const MapKernels& kernels = map_kernels();
  struct Growing {
    PlaneGrowth* of;
    HeightPlane plane;
    float bound;  // that residuals keep
  };
  std::array<Growing, kMost> growing;
  std::array<PlaneSums, kMost> sums;
  std::size_t count = 0;
  for (PlaneGrowth& growth : growths) {
    growth.closest.reset();
    if (growth.first.cosine < kLeastPlaneCosine) continue;
    growing[count++] = {&growth, growth.first, 0.0f};
  }
  // What does not hold is left out of what follows.
  const auto keep = [&](const auto& holds) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < count; ++k) {
      if (holds(growing[k], sums[k])) growing[kept++] = growing[k];
    }
    count = kept;
  };
  const auto step = [&](PlaneWeight weight, float share, const auto& is_asked) {
    for (std::size_t k = 0; k < count; ++k) {
      const Growing& g = growing[k];
      if (is_asked(g)) kernels.plane_step(*g.of->map, g.plane, weight, g.bound, sums[k]);
    }
    keep([&](Growing& g, const PlaneSums& of) {
      return !is_asked(g) || add(of, share, g.of->map->stride, g.plane);
    });
  };
  const auto all = [](const Growing&) { return true; };

  step(PlaneWeight::kWindow, 1.0f,
       [](const Growing& g) { return g.of->start == PlaneStart::kFit; });
  for (std::size_t k = 0; k < count; ++k) {
    Growing& g = growing[k];
    if (g.of->start == PlaneStart::kFit) g.plane.slack = kGrownSlack + 0.5f * g.plane.cosine;
  }
  step(PlaneWeight::kQuartic, 1.0f / 3.0f, all);
  keep([&](Growing& g, const PlaneSums&) {
    PlaneLook look;
    kernels.look_at_plane(*g.of->map, g.plane, look);
    const float mean = kGrownRms * g.plane.cosine;
    g.bound = std::max(kCentreBound * look.residuals.largest, 0.5f * g.plane.cosine);
    return look.count >= g.of->least &&
           look.residuals.sum_squares <= static_cast<float>(look.count) * mean * mean;
  });
  step(PlaneWeight::kInterior, 1.0f, all);
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [of, plane, bound] = growing[k];
    const float per_voxel = plane.cosine / static_cast<float>(of->map->stride);
    of->closest = ClosestPoint{-plane.c1 * per_voxel, -plane.c2 * per_voxel, plane.cosine,
                               plane.c0 * plane.cosine};
  }
}

}  // namespace

HeightPlane plane_through(const ClosestPoint& closest, int stride, float excess) noexcept {
  const float per = 1.0f / closest.normal_z, per_column = per * static_cast<float>(stride);
  return {closest.offset * per, -closest.normal_x * per_column, -closest.normal_y * per_column,
          closest.normal_z, excess + 0.5f * closest.normal_z};
}

HeightPlane plane_to_grow(const HeightMap& map, const ClosestPoint& first) noexcept {
  return plane_through(first, map.stride, kGrownSlack);
}

void grow_planes(std::span<PlaneGrowth> growths) noexcept {
  growths.size() == 1 ? grow<1>(growths) : grow<kMostGrowths>(growths);
}

std::optional<ClosestPoint> grow_plane(const HeightMap& map, const ClosestPoint& first, int least,
                                       PlaneStart start) noexcept {
  PlaneGrowth growth{&map, plane_to_grow(map, first), least, start, {}};
  grow_planes({&growth, 1});
  return growth.closest;
}

}  // namespace sulcus
