#include "engine/normals/half_disc.hpp"

#include <cmath>

#include "engine/normals/grown_plane.hpp"
#include "engine/normals/map_kernels.hpp"
#include "engine/normals/plane_solution.hpp"

namespace sulcus {

namespace {

constexpr float kFewestPoints = 40;
constexpr float kSlack = 0.4f;      // of a residual beyond half the cosine, voxels
constexpr float kMostMean = 0.35f;  // of the residuals' root mean square, share of the cosine
constexpr float kMostAway = 2.0f;  // of the first plane from the voxel: fitting again mends no more
constexpr float kMostInside = -0.25f, kMostOutside = 1.0f;  // offset of the voxel's own face
constexpr float kLeastCosine = 0.42f;                       // to the coarse normal
constexpr float kPerPoint = 0.004f;                         // of the score, voxels
constexpr int kFewestGrown = 12;

std::optional<HeightPlane> plane_of(const PlaneSums& s) {
  if (s.n < kFewestPoints) return {};
  const std::optional<PlaneSolution> twice = solve_plane(s);
  if (!twice) return {};
  HeightPlane plane{0.5f * twice->c0, 0.5f * twice->c1, 0.5f * twice->c2};
  plane.cosine = 1.0f / std::sqrt(1.0f + plane.c1 * plane.c1 + plane.c2 * plane.c2);
  plane.slack = kSlack + 0.5f * plane.cosine;
  return plane;
}

struct Choice {
  int half = 0;
  HalfDisc disc;
};

/// The best of the halves that are not among `vetoed`, a bit for each.
std::optional<Choice> best_of(const HeightMap& map, const std::array<PlaneSums, kHalves>& halves,
                              const Eigen::Vector3f& coarse, unsigned vetoed) {
  const MapKernels& kernels = map_kernels();
  std::optional<Choice> best;
  for (int d = 0; d < kHalves; ++d) {
    if ((vetoed >> d & 1u) != 0) continue;
    const std::optional<HeightPlane> first = plane_of(halves[static_cast<std::size_t>(d)]);
    if (!first || first->cosine * std::abs(first->c0) > kMostAway) continue;
    PlaneSums inliers;
    kernels.on_plane(map, d, *first, inliers);
    const std::optional<HeightPlane> plane = plane_of(inliers);
    if (!plane) continue;
    const Eigen::Vector3f normal(-plane->c1 * plane->cosine, -plane->c2 * plane->cosine,
                                 plane->cosine);
    if (normal.dot(coarse) < kLeastCosine) continue;
    const float offset = plane->cosine * plane->c0;
    if (offset < kMostInside || offset > kMostOutside) continue;
    const float score = std::abs(offset) - kPerPoint * inliers.n;
    if (best && best->disc.score <= score) continue;

    Residuals residuals;
    kernels.plane_residuals(map, d, *first, *plane, residuals);
    const float mean = kMostMean * plane->cosine;
    if (residuals.largest > plane->slack || residuals.sum_squares > inliers.n * mean * mean) {
      continue;
    }
    best = Choice{d, {{normal.x(), normal.y(), normal.z(), offset}, score}};
  }
  return best;
}

}  // namespace

std::optional<HalfDisc> nearest_half_disc(const HeightMap& map, const Eigen::Vector3f& coarse,
                                          const Eigen::Vector3f& outward) noexcept {
  std::array<PlaneSums, kHalves> halves;
  map_kernels().halves(map, halves);
  // The veto is on what a half-disc has grown to, so that it changes no other answer.
  unsigned vetoed = 0;
  while (const std::optional<Choice> best = best_of(map, halves, coarse, vetoed)) {
    HalfDisc disc = best->disc;
    if (const std::optional<Foot> face = grow_plane(map, disc.foot, kFewestGrown, true)) {
      disc.foot = *face;
    }
    const Eigen::Vector3f normal(disc.foot.normal_x, disc.foot.normal_y, disc.foot.normal_z);
    if (!(normal.dot(outward) < 0.0f)) return disc;
    vetoed |= 1u << best->half;
  }
  return {};
}

}  // namespace sulcus
