#include "engine/normals/half_disc.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "engine/normals/grown_plane.hpp"
#include "engine/normals/ldm_tuning.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

std::optional<HeightPlane> plane_of(const PlaneSums& s) {
  if (s.n < kFewestInHalf) return {};
  const std::optional<PlaneSolution> twice = solve_plane(s);
  if (!twice) return {};
  HeightPlane plane{0.5f * twice->c0, 0.5f * twice->c1, 0.5f * twice->c2};
  plane.cosine = 1.0f / std::sqrt(1.0f + plane.c1 * plane.c1 + plane.c2 * plane.c2);
  plane.slack = kPlaneInHalf.beyond_half_cosine + 0.5f * plane.cosine;
  return plane;
}

/// A half and the plane of what lies on its first one, as far as the voxel may be of it.
struct Candidate {
  int half = 0;
  HeightPlane first, plane;
  float inliers = 0.0f;
  HalfDisc disc;
};

/// What half `d` has to offer.
std::optional<Candidate> candidate_of(const HeightMap& map, int d, const PlaneSums& sums,
                                      const Eigen::Vector3f& coarse) {
  const std::optional<HeightPlane> first = plane_of(sums);
  if (!first || first->cosine * std::abs(first->c0) > kMostAway) return {};
  PlaneSums inliers;
  map_kernels().on_plane(map, d, *first, inliers);
  const std::optional<HeightPlane> plane = plane_of(inliers);
  if (!plane) return {};
  const Eigen::Vector3f normal(-plane->c1 * plane->cosine, -plane->c2 * plane->cosine,
                               plane->cosine);
  if (normal.dot(coarse) < kLeastCosineToCoarse) return {};
  const float offset = plane->cosine * plane->c0;
  if (offset < kMostInside || offset > kMostOutside) return {};
  const float score = std::abs(offset) - kScorePerColumn * inliers.n;
  return Candidate{
      d, *first, *plane, inliers.n, {{normal.x(), normal.y(), normal.z(), offset}, score}};
}

/// Whether its plane explains what lies on the first.
bool holds(const HeightMap& map, const Candidate& c) {
  Residuals residuals;
  map_kernels().plane_residuals(map, c.half, c.first, c.plane, residuals);
  const float mean = kPlaneInHalf.rms_by_cosine * c.plane.cosine;
  return residuals.largest <= c.plane.slack && residuals.sum_squares <= c.inliers * mean * mean;
}

/// The side that half `d` is on.
MapSide side_of(int d, float behind) {
  constexpr float kDiagonal = 0.70710678f;
  constexpr float kRays[kHalves][2] = {
      {1.0f, 0.0f},  {kDiagonal, kDiagonal},   {0.0f, 1.0f},  {-kDiagonal, kDiagonal},
      {-1.0f, 0.0f}, {-kDiagonal, -kDiagonal}, {0.0f, -1.0f}, {kDiagonal, -kDiagonal}};
  return {kRays[d][0], kRays[d][1], behind};
}

/// What explains a part of a ball about the voxel on the side of a candidate's half.
struct CurvedSide {
  const Candidate* candidate = nullptr;
  bool settled = false;          // of this side: something does
  std::optional<HalfDisc> disc;  // that may be the voxel's
};

/// Looks for one radius at the sides that nothing has explained, side by side.
void look_at_sides(const HeightMap& map, const Eigen::Vector3f& coarse, float behind, float radius,
                   std::span<CurvedSide> sides, TiltedFitter& fitter) {
  std::array<TiltedFit, kMostSides> fits;
  std::array<CurvedSide*, kMostSides> of;
  std::size_t count = 0;
  for (CurvedSide& side : sides) {
    if (side.settled) continue;
    const ClosestPoint& plane = side.candidate->disc.closest;
    fits[count] = {&map,
                   {plane.normal_x, plane.normal_y, plane.normal_z},
                   radius,
                   side_of(side.candidate->half, behind),
                   {}};
    of[count++] = &side;
  }
  fitter.fit(std::span(fits).first(count));
  for (std::size_t k = 0; k < count; ++k) {
    if (!fits[k].closest) continue;
    of[k]->settled = true;
    const ClosestPoint& closest = *fits[k].closest;
    const Eigen::Vector3f normal(closest.normal_x, closest.normal_y, closest.normal_z);
    if (normal.dot(coarse) < kLeastCosineToCoarse || closest.offset < kMostInside ||
        closest.offset > kMostOutside) {
      continue;
    }
    of[k]->disc = {closest,
                   std::abs(closest.offset) - kScorePerBehind * behind - kScorePerRadius * radius};
  }
}

/// Of candidates' sides, the largest part of a ball that is explained. A little behind the voxel
/// first, since at its rim a fit looks ahead only.
void find_curved(const HeightMap& map, const Eigen::Vector3f& coarse,
                 std::span<const float> behinds, std::span<CurvedSide> sides,
                 TiltedFitter& fitter) {
  for (const float behind : behinds) {
    for (CurvedSide& side : sides) side.settled = side.disc.has_value();
    for (const float radius : kSideRadii) {
      look_at_sides(map, coarse, behind, radius, sides, fitter);
    }
  }
}

}  // namespace

std::optional<HalfDisc> nearest_half_disc(const HeightMap& map, const Eigen::Vector3f& coarse,
                                          const Eigen::Vector3f& outward, VoxelPlace place,
                                          TiltedFitter& fitter) noexcept {
  std::array<PlaneSums, kHalves> halves;
  map_kernels().halves(map, halves);
  // The best first, and the first of equals.
  std::array<Candidate, kHalves> candidates;
  auto end = candidates.begin();
  for (int d = 0; d < kHalves; ++d) {
    const auto c = candidate_of(map, d, halves[static_cast<std::size_t>(d)], coarse);
    if (!c) continue;
    const auto at = std::find_if(candidates.begin(), end, [&](const Candidate& other) {
      return c->disc.score < other.disc.score;
    });
    std::move_backward(at, end, end + 1);
    *at = *c;
    ++end;
  }
  // The tool may only reject final candidates; a rejected one is replaced by one of its own kind,
  // so that no answer without a veto depends on the tool.
  bool any = false;
  const auto curved_sides = [&](std::span<const float> behinds) {
    std::array<CurvedSide, kMostSides> sides;
    std::size_t count = 0;
    for (auto c = candidates.begin(); c != end && count < sides.size(); ++c) {
      if (c->inliers < kLeastShareInHalf * halves[static_cast<std::size_t>(c->half)].n) continue;
      sides[count++].candidate = &*c;
    }
    find_curved(map, coarse, behinds, std::span(sides).first(count), fitter);
    std::optional<HalfDisc> nearest;
    for (const CurvedSide& side : sides) {
      if (!side.disc) continue;
      any = true;
      if (nearest && !(side.disc->score < nearest->score)) continue;
      const ClosestPoint& closest = side.disc->closest;
      const Eigen::Vector3f normal(closest.normal_x, closest.normal_y, closest.normal_z);
      if (!(normal.dot(outward) < 0.0f)) nearest = side.disc;
    }
    return nearest;
  };
  if (place == VoxelPlace::kInsideFace) {
    const std::optional<HalfDisc> nearest = curved_sides(kBehindInside);
    if (any) return nearest;
  }
  for (auto c = candidates.begin(); c != end; ++c) {
    if (!holds(map, *c)) continue;
    any = true;
    HalfDisc disc = c->disc;
    if (const std::optional<ClosestPoint> face =
            grow_plane(map, disc.closest, kFewestOnGrown, PlaneStart::kFit)) {
      disc.closest = *face;
    }
    const Eigen::Vector3f normal(disc.closest.normal_x, disc.closest.normal_y,
                                 disc.closest.normal_z);
    if (!(normal.dot(outward) < 0.0f)) return disc;
  }
  if (any) return {};
  return curved_sides(kBehindElse);
}

}  // namespace sulcus
