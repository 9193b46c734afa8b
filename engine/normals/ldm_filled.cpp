#include "engine/normals/ldm_filled.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "engine/normals/equal_axes.hpp"
#include "engine/normals/filled_fit.hpp"
#include "engine/normals/filled_heights.hpp"
#include "engine/normals/ldm.hpp"
#include "engine/normals/map_batch.hpp"
#include "engine/normals/turned_filled_map.hpp"

namespace sulcus {

namespace {

using Eigen::Vector3f;

/// The sides of a ball that are looked at: twelve directions, so that the grid's symmetries turn
/// one into another, each from a little behind the voxel on, and from a column ahead of it on. No
/// column lies on a rim.
constexpr float kBehindRims[] = {0.45f, -0.95f};
constexpr std::size_t kSides = 12 * std::size(kBehindRims);
constexpr std::array<MapSide, kSides> kAllSides = [] {
  constexpr float kHalf = 0.5f, kRoot = 0.8660254f;
  constexpr float kRays[12][2] = {
      {1, 0},  {kRoot, kHalf},   {kHalf, kRoot},   {0, 1},  {-kHalf, kRoot}, {-kRoot, kHalf},
      {-1, 0}, {-kRoot, -kHalf}, {-kHalf, -kRoot}, {0, -1}, {kHalf, -kRoot}, {kRoot, -kHalf}};
  std::array<MapSide, kSides> sides{};
  std::size_t n = 0;
  for (const float behind : kBehindRims) {
    for (const auto& ray : kRays) sides[n++] = {ray[0], ray[1], behind};
  }
  return sides;
}();

/// A surface that may be the voxel's own.
struct FaceCandidate {
  SurfaceEstimate estimate;
  float away = 0.0f;  // from the voxel, voxels
};

/// The nearest of them that the tool does not veto: the mean of equals, so that no order decides.
std::optional<SurfaceEstimate> nearest_candidate(std::span<const FaceCandidate> candidates,
                                                 const Vector3f& hint) noexcept {
  float nearest = std::numeric_limits<float>::infinity();
  const auto is_left = [&](const FaceCandidate& c) {
    return !(c.estimate.normal.dot(hint) < 0.0f);
  };
  for (const FaceCandidate& c : candidates) {
    if (is_left(c)) nearest = std::min(nearest, c.away);
  }
  std::array<SurfaceEstimate, 3 * kSides> equal;
  std::size_t count = 0;
  for (const FaceCandidate& c : candidates) {
    if (is_left(c) && c.away <= nearest + kEqualFace) equal[count++] = c.estimate;
  }
  if (count == 0) return {};
  const SurfaceEstimate mean = mean_of(std::span(equal).first(count));
  return mean.defined ? mean : equal[0];
}

/// Estimates of the voxels of a batch, with what the fits need.
class FilledEstimator {
 public:
  explicit FilledEstimator(MapBatch& batch) : batch_(batch), heights_(batch.workpiece()) {}

  void estimate(SurfaceEstimate* to) noexcept {
    VoxelBits rest = batch_.has_direction;
    while (rest != 0) {
      for (const std::size_t k : batch_.trace_some(rest)) {
        to[k] = estimate_one(k);
        if (map_has_parts_) move_to_own_columns(batch_.query(k).voxel, to[k]);
      }
    }
    for (std::size_t k = 0; k < batch_.count(); ++k) {
      if (!has_bit(batch_.has_direction, k)) to[k] = {};
    }
  }

 private:
  SurfaceEstimate estimate_one(std::size_t k) noexcept {
    const Vector3f coarse = batch_.coarse(k), hint = tool_hint(batch_.tool(k), coarse);
    const MapAxes axes = batch_.axes(k);
    heights_.fill(batch_.query(k).voxel, axes, batch_.map(k), map_);
    map_has_parts_ = map_.has_parts() || is_part_filled(k);
    if (!map_has_parts_) return of_bits(k);
    const auto holds = [&](const std::optional<SurfaceEstimate>& estimate) {
      return estimate && is_consistent(estimate->normal, coarse, hint);
    };
    std::optional<SurfaceEstimate> found = whole(axes);
    if (holds(found)) return *found;
    turn(axes, coarse);
    found = ball(axes);
    if (holds(found)) return *found;
    // What neither a ball nor a side explains: the least squares of all of a ball.
    std::optional<SurfaceEstimate> rough;
    fitter_.gather(turned_.map(), coarse_, kRoughRadius);
    at_edge_ = true;
    if (const auto point = fitter_.fit_ball(kAnyResidual)) {
      rough = estimate_of(*point, axes);
      at_edge_ = point->residual > kEdgeResidual;
    }
    found = nearest_face(k, axes, coarse, hint);
    if (holds(found)) return *found;
    if (!holds(rough)) rough = last_resort(coarse, hint, 0);
    rough->windows = windows_;
    return *rough;
  }

  bool is_part_filled(std::size_t k) const noexcept {
    return batch_.workpiece().level(batch_.query(k).voxel) != kFullLevel;
  }

  /// Moves a surface along its normal to the heights of the voxel's own columns: what is cut of a
  /// voxel must be felt there, or it is cut through while the surface about it says that it still
  /// stands. By the mean over the axes, so that where the normal lies between two of them neither
  /// decides. What rounding and curvature leave moves nothing.
  void move_to_own_columns(const Cell& voxel, SurfaceEstimate& estimate) const noexcept {
    float sum = 0.0f, weights = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      const float along = std::abs(estimate.normal[axis]);
      const float weight = along * along - kLeastOwnAxis * kLeastOwnAxis;
      if (!(weight > 0.0f)) continue;
      estimate.windows |= static_cast<std::uint8_t>(1 << axis);
      const auto height = own_height(batch_.workpiece().model(), voxel,
                                     {axis, estimate.normal[axis] > 0.0f ? 1 : -1});
      if (!height) continue;
      sum += weight * (*height * along);
      weights += weight;
    }
    if (weights == 0.0f) {
      // None along the normal; what others say it is at most.
      const float most = farthest_surface(batch_.workpiece().model(), voxel)
                             .value_or(std::numeric_limits<float>::infinity());
      estimate.offset = std::clamp(estimate.offset, -most, most);
      estimate.windows |= 7;
      return;
    }
    const float off = sum / weights - estimate.offset;
    const float beyond = std::max(0.0f, std::abs(off) - kSameOffset);
    estimate.offset += off < 0.0f ? -beyond : beyond;
  }

  /// Where no voxel is part-filled it is a binary solid.
  SurfaceEstimate of_bits(std::size_t k) noexcept {
    SurfaceEstimate estimate;
    const VoxelQuery query = batch_.query(k);
    estimate_ldm(batch_.workpiece(), {&query, 1}, batch_.neighbourhood(), batch_.trace(),
                 {&estimate, 1});
    estimate.windows |= batch_.axes(k).window();
    return estimate;
  }

  SurfaceEstimate estimate_of(const FilledPoint& point, const MapAxes& axes) const noexcept {
    return to_index_space(turned_.back(point.closest), axes);
  }
  /// The map as its symmetries leave it, and the coarse normal over it, unit.
  void turn(const MapAxes& axes, const Vector3f& coarse) noexcept {
    const Vector3f over_map = to_map_space(coarse, axes);
    turned_.turn(map_, over_map);
    coarse_ = turned_.of(over_map).normalized();
  }

  /// What explains the whole map.
  std::optional<SurfaceEstimate> whole(const MapAxes& axes) noexcept {
    tolerance_ = kFilledResidual;
    std::optional<FilledPoint> point = fit_whole_filled(map_, kWholeFilledResidual);
    if (!point) {
      tolerance_ =
          std::max(tolerance_, kNoiseResidual * height_noise(map_, tolerance_ / kNoiseResidual));
      if (tolerance_ > kWholeFilledResidual) point = fit_whole_filled(map_, tolerance_);
    }
    if (!point) return {};
    return to_index_space(point->closest, axes);
  }
  /// What explains the largest ball.
  std::optional<SurfaceEstimate> ball(const MapAxes& axes) noexcept {
    for (const float radius : kFilledBallRadii) {
      fitter_.gather(turned_.map(), coarse_, radius);
      std::optional<FilledPoint> point = fitter_.fit_ball(tolerance_);
      if (!point) continue;
      // Once more in the surface's own frame, where it is straightest.
      const Vector3f own = normal_of(*point);
      if (own.dot(coarse_) < kSameFrame) {
        fitter_.gather(turned_.map(), own, radius);
        if (const auto again = fitter_.fit_ball(tolerance_)) point = again;
      }
      return estimate_of(*point, axes);
    }
    return {};
  }

  /// The nearest face of the sides of balls of this map, and of those along the other axes.
  std::optional<SurfaceEstimate> nearest_face(std::size_t k, const MapAxes& axes,
                                              const Vector3f& coarse,
                                              const Vector3f& hint) noexcept {
    candidate_count_ = 0;
    windows_ = axes.window();
    add_sides(axes);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == axes.axis || std::abs(coarse[axis]) < kOtherAxis * std::abs(coarse[axes.axis])) {
        continue;
      }
      const MapAxes other{axis, coarse[axis] > 0.0f ? 1 : -1};
      windows_ |= other.window();
      HeightMap traced;
      traced.ns = batch_.neighbourhood();
      trace_along(batch_.workpiece(), batch_.query(k).voxel, other, coarse, batch_.trace(), traced);
      heights_.fill(batch_.query(k).voxel, other, traced, map_);
      turn(other, coarse);
      add_sides(other);
    }
    auto nearest = nearest_candidate(std::span(candidates_).first(candidate_count_), hint);
    if (nearest) nearest->windows = windows_;
    return nearest;
  }

  void add_sides(const MapAxes& axes) noexcept {
    const Vector3f& normal = coarse_;
    fitter_.gather(turned_.map(), normal, kFilledSideRadii[0]);
    std::array<SideFit, kSides> fits;
    constexpr std::size_t kRays = kSides / std::size(kBehindRims);
    fitter_.fit_sides(std::span(kAllSides).first(kRays), tolerance_, std::span(fits).first(kRays));
    // Ahead of the voxel only where nothing explains it together with what is beside the voxel.
    std::array<MapSide, kRays> ahead;
    std::array<SideFit, kRays> ahead_fits;
    std::array<std::size_t, kRays> of;
    std::size_t count = 0;
    for (std::size_t n = 0; n < kRays; ++n) {
      if (fits[n].explains == SideFit::Explains::kAll) continue;
      ahead[count] = kAllSides[kRays + n];
      of[count++] = kRays + n;
    }
    fitter_.fit_sides(std::span(ahead).first(count), tolerance_,
                      std::span(ahead_fits).first(count));
    for (std::size_t n = 0; n < count; ++n) fits[of[n]] = ahead_fits[n];
    float nearest = std::numeric_limits<float>::infinity();
    for (const SideFit& fit : fits) {
      if (fit.explains == SideFit::Explains::kAll && may_be_face(fit.point, normal)) {
        nearest = std::min(nearest, std::abs(fit.point.closest.offset));
      }
    }
    for (std::size_t n = 0; n < kSides; ++n) {
      SideFit& fit = fits[n];
      // What curves is a quadric in its own frame, which is far from the coarse normal's.
      if (std::abs(fit.point.closest.offset) < nearest + kRefittedWithin) refit(kAllSides[n], fit);
      if (!may_be_face(fit.point, normal)) continue;
      const float away = std::abs(fit.point.closest.offset);
      if (fit.explains == SideFit::Explains::kAll) {
        candidates_[candidate_count_++] = {estimate_of(fit.point, axes), away};
      } else if (fit.explains == SideFit::Explains::kNearly && at_edge_) {
        candidates_[candidate_count_++] = {estimate_of(fit.point, axes), away + kOnlyNearly};
      }
    }
  }
  /// By the largest part of a ball that is explained in the frame of what nearly was.
  void refit(const MapSide& side, SideFit& fit) noexcept {
    for (const float radius : kFilledSideRadii) {
      if (fit.explains != SideFit::Explains::kNearly) return;
      fitter_.gather(turned_.map(), normal_of(fit.point), radius);
      SideFit again;
      fitter_.fit_sides({&side, 1}, tolerance_, {&again, 1});
      if (again.explains != SideFit::Explains::kNothing) fit = again;
    }
  }
  static bool may_be_face(const FilledPoint& point, const Vector3f& coarse) noexcept {
    return point.closest.normal_z >= kLeastFilledCosine &&
           normal_of(point).dot(coarse) >= kLeastFilledCosineToCoarse;
  }
  static Vector3f normal_of(const FilledPoint& point) {
    return {point.closest.normal_x, point.closest.normal_y, point.closest.normal_z};
  }

  MapBatch& batch_;
  FilledHeights heights_;
  FilledMap map_;
  TurnedFilledMap turned_;
  Vector3f coarse_ = Vector3f::Zero();  // as turned_ sees it, unit
  FilledFitter fitter_;
  float tolerance_ = 0.0f;
  bool map_has_parts_ = false;  // of the first axis
  bool at_edge_ = false;        // what nothing explains is no rough surface
  std::array<FaceCandidate, 3 * kSides> candidates_;
  std::size_t candidate_count_ = 0;
  std::uint8_t windows_ = 0;  // of the maps that nearest_face looked at
};

}  // namespace

void estimate_ldm_filled(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                         int neighbourhood, int trace,
                         std::span<SurfaceEstimate> estimates) noexcept {
  MapBatch batch(workpiece, queries, neighbourhood, trace, FitWindow::kNone);
  FilledEstimator estimator(batch);
  for (std::size_t first = 0, count; first < queries.size(); first += count) {
    count = batch.take(first, MapBatch::kMaps);
    SurfaceEstimate* const to = estimates.data() + first;
    const auto estimate = [&](SurfaceEstimate* of) { estimator.estimate(of); };
    estimate(to);
    estimate_equal_axes(batch, estimate, to);
  }
}

}  // namespace sulcus
