#include "engine/normals/half_disc.hpp"

#include <cmath>

#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

constexpr float kFewestPoints = 40;
constexpr float kSlack = 0.4f;      // of a residual beyond half the cosine, voxels
constexpr float kMostMean = 0.35f;  // of the residuals' root mean square, share of the cosine
constexpr float kMostAway = 2.0f;  // of the first plane from the voxel: fitting again mends no more
constexpr float kMostInside = -0.25f, kMostOutside = 1.0f;  // offset of the voxel's own face
constexpr float kLeastCosine = 0.42f;                       // to the coarse normal
constexpr float kPerPoint = 0.004f;                         // of the score, voxels

std::optional<HeightPlane> plane_of(const PlaneSums& s) {
  if (s.n < kFewestPoints) return {};
  // About the mean, n times the covariances; z was twice itself.
  const float ii = s.n * s.ii - s.i * s.i, ij = s.n * s.ij - s.i * s.j, jj = s.n * s.jj - s.j * s.j;
  const float iz = s.n * s.iz - s.i * s.z, jz = s.n * s.jz - s.j * s.z;
  const float determinant = ii * jj - ij * ij;
  if (determinant <= 0.0f) return {};
  HeightPlane plane;
  plane.c1 = 0.5f * (jj * iz - ij * jz) / determinant;
  plane.c2 = 0.5f * (ii * jz - ij * iz) / determinant;
  plane.c0 = (0.5f * s.z - plane.c1 * s.i - plane.c2 * s.j) / s.n;
  plane.cosine = 1.0f / std::sqrt(1.0f + plane.c1 * plane.c1 + plane.c2 * plane.c2);
  plane.slack = kSlack + 0.5f * plane.cosine;
  return plane;
}

}  // namespace

std::optional<HalfDisc> nearest_half_disc(const HeightMap& map, const Eigen::Vector3f& coarse,
                                          const Eigen::Vector3f& outward) noexcept {
  const MapKernels& kernels = map_kernels();
  std::array<PlaneSums, kHalves> halves;
  kernels.halves(map, halves);
  std::optional<HalfDisc> best;
  for (int d = 0; d < kHalves; ++d) {
    const std::optional<HeightPlane> first = plane_of(halves[static_cast<std::size_t>(d)]);
    if (!first || first->cosine * std::abs(first->c0) > kMostAway) continue;
    PlaneSums inliers;
    kernels.on_plane(map, d, *first, inliers);
    const std::optional<HeightPlane> plane = plane_of(inliers);
    if (!plane) continue;
    const Eigen::Vector3f normal(-plane->c1 * plane->cosine, -plane->c2 * plane->cosine,
                                 plane->cosine);
    if (normal.dot(coarse) < kLeastCosine || normal.dot(outward) < 0.0f) continue;
    const float offset = plane->cosine * plane->c0;
    if (offset < kMostInside || offset > kMostOutside) continue;
    const float score = std::abs(offset) - kPerPoint * inliers.n;
    if (best && best->score <= score) continue;

    Residuals residuals;
    kernels.plane_residuals(map, d, *first, *plane, residuals);
    const float mean = kMostMean * plane->cosine;
    if (residuals.largest > plane->slack || residuals.sum_squares > inliers.n * mean * mean) {
      continue;
    }
    best = HalfDisc{{normal.x(), normal.y(), normal.z(), offset}, score};
  }
  return best;
}

}  // namespace sulcus
