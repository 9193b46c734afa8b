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
  plane.cosine = 1.0f / std::sqrt(1.0f + (plane.c1 * plane.c1 + plane.c2 * plane.c2));
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

/// Cosine of a normal to a direction, summed alike for both axes across the columns.
float along(const ClosestPoint& closest, const Eigen::Vector3f& direction) {
  return (closest.normal_x * direction.x() + closest.normal_y * direction.y()) +
         closest.normal_z * direction.z();
}

/// The nearest of those that the tool does not veto: the mean of equals, and where that is vetoed,
/// of those of them that are not.
std::optional<HalfDisc> nearest_of(std::span<const HalfDisc> discs,
                                   const Eigen::Vector3f& outward) {
  for (const bool by_disc : {false, true}) {
    const auto is_left = [&](const HalfDisc& disc) {
      return !(by_disc && along(disc.closest, outward) < 0.0f);
    };
    const HalfDisc* nearest = nullptr;
    for (const HalfDisc& disc : discs) {
      if (is_left(disc) && (!nearest || disc.score < nearest->score)) nearest = &disc;
    }
    if (!nearest) return {};
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float offset = 0.0f, count = 0.0f;
    for (const HalfDisc& disc : discs) {
      if (!is_left(disc) || disc.score > nearest->score + kEqualScore) continue;
      normal +=
          Eigen::Vector3f(disc.closest.normal_x, disc.closest.normal_y, disc.closest.normal_z);
      offset += disc.closest.offset;
      count += 1.0f;
    }
    HalfDisc mean = *nearest;
    if (count > 1.0f) {
      normal.normalize();
      mean.closest = {normal.x(), normal.y(), normal.z(), offset / count};
    }
    if (!(along(mean.closest, outward) < 0.0f)) return mean;
  }
  return {};
}

/// What half `d` has to offer.
std::optional<Candidate> candidate_of(const HeightMap& map, int d, const PlaneSums& sums,
                                      const Eigen::Vector3f& coarse) {
  const std::optional<HeightPlane> first = plane_of(sums);
  if (!first || first->cosine * std::abs(first->c0) > kMostAway) return {};
  PlaneSums inliers;
  map_kernels().on_plane(map, d, *first, inliers);
  const std::optional<HeightPlane> plane = plane_of(inliers);
  if (!plane) return {};
  const ClosestPoint closest{-plane->c1 * plane->cosine, -plane->c2 * plane->cosine, plane->cosine,
                             plane->cosine * plane->c0};
  if (along(closest, coarse) < kLeastCosineToCoarse) return {};
  if (closest.offset < kMostInside || closest.offset > kMostOutside) return {};
  const float score = std::abs(closest.offset) - kScorePerColumn * inliers.n;
  return Candidate{d, *first, *plane, inliers.n, {closest, score}};
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
  std::array<TiltedFit, kHalves> fits;
  std::array<CurvedSide*, kHalves> of;
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
    if (along(closest, coarse) < kLeastCosineToCoarse || closest.offset < kMostInside ||
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
  // The best first; equals are taken together, so that the order of the halves does not matter.
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
    std::array<CurvedSide, kHalves> sides;
    std::size_t count = 0;
    for (auto c = candidates.begin(); c != end; ++c) {
      if (c->inliers < kLeastShareInHalf * halves[static_cast<std::size_t>(c->half)].n) continue;
      if (count >= kMostSides &&
          c->disc.score > sides[count - 1].candidate->disc.score + kEqualScore) {
        break;
      }
      sides[count++].candidate = &*c;
    }
    find_curved(map, coarse, behinds, std::span(sides).first(count), fitter);
    std::array<HalfDisc, kHalves> discs;
    std::size_t found = 0;
    for (const CurvedSide& side : sides) {
      if (side.disc) discs[found++] = *side.disc;
    }
    any |= found > 0;
    return nearest_of(std::span(discs).first(found), outward);
  };
  if (place == VoxelPlace::kInsideFace) {
    const std::optional<HalfDisc> nearest = curved_sides(kBehindInside);
    if (any) return nearest;
  }
  for (auto c = candidates.begin(); c != end;) {
    const float score = c->disc.score;
    std::array<HalfDisc, kHalves> discs;
    std::size_t found = 0;
    for (; c != end && c->disc.score <= score + kEqualScore; ++c) {
      if (!holds(map, *c)) continue;
      discs[found++] = {grow_plane(map, c->disc.closest, kFewestOnGrown, PlaneStart::kFit)
                            .value_or(c->disc.closest),
                        score};
    }
    any |= found > 0;
    if (const auto nearest = nearest_of(std::span(discs).first(found), outward)) return nearest;
  }
  if (any) return {};
  return curved_sides(kBehindElse);
}

}  // namespace sulcus
