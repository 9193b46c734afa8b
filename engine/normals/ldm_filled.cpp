#include "engine/normals/ldm_filled.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/normals/equal_axes.hpp"
#include "engine/normals/filled_columns.hpp"
#include "engine/normals/filled_tile.hpp"
#include "engine/normals/ldm.hpp"
#include "engine/normals/map_batch.hpp"

namespace sulcus {

namespace {

using Eigen::Vector3f;

/// The directions in which windows are moved aside, so that the symmetries of the columns turn one
/// into another.
constexpr std::array<std::array<int, 2>, 8> kRays{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

/// The surface that is most likely the voxel's own, of those that the tool does not veto: the mean
/// of equals, so that no order decides.
class NearestFace {
 public:
  explicit NearestFace(const Vector3f& hint) : hint_(hint) {}

  /// Whether a surface whose score is at least this much may still be it.
  bool may_be(float least_score) const { return least_score <= nearest_ + kEqualFace; }
  void add(const SurfaceEstimate& estimate, float score) noexcept {
    if (!may_be(score) || estimate.normal.dot(hint_) < 0.0f) return;
    nearest_ = std::min(nearest_, score);
    std::size_t left = 0;
    for (std::size_t n = 0; n < count_; ++n) {
      if (may_be(scores_[n])) scores_[left] = scores_[n], faces_[left++] = faces_[n];
    }
    count_ = left;
    if (count_ < kMost) scores_[count_] = score, faces_[count_++] = estimate;
  }
  std::optional<SurfaceEstimate> get() const noexcept {
    if (count_ == 0) return {};
    const SurfaceEstimate mean = mean_of(std::span(faces_).first(count_));
    return mean.defined ? mean : faces_[0];
  }

 private:
  static constexpr std::size_t kMost = 24;

  const Vector3f& hint_;
  float nearest_ = std::numeric_limits<float>::infinity();
  std::size_t count_ = 0;
  std::array<float, kMost> scores_;  // of the faces
  std::array<SurfaceEstimate, kMost> faces_;
};

/// The tiles of the leaf whose voxels are estimated.
class FilledTiles {
 public:
  FilledTiles(const Workpiece& workpiece, int ns, int reach)
      : workpiece_(workpiece), ns_(ns), reach_(reach) {}

  /// A voxel in a tile: of its leaf, or of its layer of that, where it sees other surfaces than
  /// those of other layers. Valid until the next.
  struct Place {
    FilledTile* tile = nullptr;
    int u = 0, v = 0, level = 0;  // parts
  };
  Place find(const Cell& voxel, const MapAxes& axes) noexcept {
    const Cell origin = voxel.unaryExpr([](int c) { return c & -kLeafEdge; });
    if (origin != origin_) {
      origin_ = origin;
      begun_ = {};
      layer_ = -1;
    }
    const auto number = static_cast<std::size_t>(2 * axes.axis + (axes.sign > 0 ? 1 : 0));
    FilledTile& tile = tiles_[number];
    if (!begun_[number]) {
      begun_[number] = true;
      tile.begin(workpiece_, origin, kLeafEdge, axes, ns_, reach_);
    }
    const int u = voxel[axes.first()] - origin[axes.first()],
              v = voxel[axes.second()] - origin[axes.second()],
              w = voxel[axes.axis] - origin[axes.axis];
    tile.read_about(v);
    if (tile.is_single(u, v)) {
      return {&tile, u, v, kHeightParts * (axes.sign > 0 ? w : kLeafEdge - 1 - w)};
    }
    const int layer = kLeafEdge * static_cast<int>(number) + w;
    if (layer != layer_) {
      layer_ = layer;
      Cell first = origin;
      first[axes.axis] += w;
      of_layer_.begin(workpiece_, first, 1, axes, ns_, reach_);
    }
    of_layer_.read_about(v);
    return {&of_layer_, u, v, 0};
  }

 private:
  const Workpiece& workpiece_;
  int ns_, reach_;
  Cell origin_ = Cell::Constant(-1);
  std::array<bool, 6> begun_{};  // by axis and sign
  std::array<FilledTile, 6> tiles_;
  int layer_ = -1;  // that of_layer_ is of, counted through all tiles
  FilledTile of_layer_;
};

/// The quadric as it is seen from the column (x, y) of its own.
ColumnQuadric seen_from(const ColumnQuadric& q, float x, float y) noexcept {
  const Quadric& c = q.c;
  const float more = 1.0f + (q.t_x * x + q.t_y * y);
  const float z2 = (c[3] * x * x + c[5] * y * y) + c[4] * (x * y);
  const float dx = 2.0f * c[3] * x + c[4] * y, dy = c[4] * x + 2.0f * c[5] * y;
  ColumnQuadric to;
  to.c = {c[0] + (c[1] * x + c[2] * y) + z2 * more,
          c[1] + dx * more + z2 * q.t_x,
          c[2] + dy * more + z2 * q.t_y,
          c[3] * more + dx * q.t_x,
          c[4] * more + (dx * q.t_y + dy * q.t_x),
          c[5] * more + dy * q.t_y};
  complete(to);
  return to;
}

/// Estimates of the voxels of a batch, with what the fits need.
class FilledEstimator {
 public:
  FilledEstimator(MapBatch& batch, int ns, int reach)
      : batch_(batch),
        tiles_(batch.workpiece(), ns, reach),
        levels_(batch.workpiece().model()),
        reach_(kHeightParts * reach) {}

  void estimate(SurfaceEstimate* to) noexcept {
    for (std::size_t k = 0; k < batch_.count(); ++k) {
      to[k] = has_bit(batch_.has_direction, k) ? estimate_one(k) : SurfaceEstimate{};
    }
  }

 private:
  using Place = FilledTiles::Place;

  SurfaceEstimate estimate_one(std::size_t k) noexcept {
    const Vector3f coarse = batch_.coarse(k), hint = tool_hint(batch_.tool(k), coarse);
    const MapAxes axes = batch_.axes(k);
    const Cell& voxel = batch_.query(k).voxel;
    const Place place = tiles_.find(voxel, axes);
    if (!place.tile->has_parts(place.u, place.v) && batch_.workpiece().level(voxel) == kFullLevel) {
      return of_bits(k);
    }
    const auto holds = [&](const std::optional<SurfaceEstimate>& estimate) {
      return estimate && is_consistent(estimate->normal, coarse, hint);
    };
    windows_ = axes.window();
    std::optional<SurfaceEstimate> found = middle(place, axes);
    if (!holds(found)) {
      found = face(voxel, place, axes, coarse, hint);
      if (!holds(found)) found = last_resort(coarse, hint, 0);
    }
    found->windows = windows_;
    move_to_own_columns(voxel, *found);
    return *found;
  }

  /// The surface of a fit about the column (a, b) from the voxel's; none where it lies farther than
  /// is looked.
  std::optional<ClosestPoint> surface_of(const Place& place, const FilledTile::Fit& fit, int a,
                                         int b) const noexcept {
    const WindowFits& of = *fit.of;
    const int lane = fit.lane;
    if (of.lowest[lane] - place.level < -reach_ || of.highest[lane] - place.level > reach_) {
      return {};
    }
    ColumnQuadric q;
    for (std::size_t f = 0; f < kQuadric; ++f) q.c[f] = of.c[f][lane];
    q.c[0] += static_cast<float>(of.centre[lane] - place.level) * (1.0f / kHeightParts) + 0.5f;
    complete(q);
    if (a != 0 || b != 0) q = seen_from(q, static_cast<float>(-a), static_cast<float>(-b));
    return closest_point_of(q);
  }

  /// What explains the largest window about the voxel.
  std::optional<SurfaceEstimate> middle(const Place& place, const MapAxes& axes) noexcept {
    FilledTile& tile = *place.tile;
    const auto surface = [&](const FilledTile::Fit& fit) -> std::optional<SurfaceEstimate> {
      const auto closest = surface_of(place, fit, 0, 0);
      if (!closest) return {};
      return to_index_space(*closest, axes);
    };
    const FilledTile::Fit whole = tile.fit(tile.ns(), place.u, place.v);
    if (whole.mean_square() <= kWholeResidual * kWholeResidual) {
      if (const auto found = surface(whole)) return found;
    }
    // What scatters alike everywhere, as greys do, is no edge.
    const float noise = tile.fit(2, place.u, place.v).mean_square();
    const float within_noise = noise <= kMostNoise * kMostNoise ? kMoreThanNoise * noise : 0.0f;
    if (whole.mean_square() <= within_noise) {
      if (const auto found = surface(whole)) return found;
    }
    const float most = std::max(kWindowResidual * kWindowResidual, within_noise);
    for (const int rings : FilledTile::kSmallRings) {
      if (rings >= tile.ns()) continue;
      const FilledTile::Fit fit = tile.fit(rings, place.u, place.v);
      if (fit.mean_square() > (rings == 2 ? kSettled * kSettled : most)) continue;
      if (const auto found = surface(fit)) return found;
    }
    return {};
  }

  /// The nearest face of the windows about the voxel and aside, along every axis that the coarse
  /// normal leaves.
  std::optional<SurfaceEstimate> face(const Cell& voxel, const Place& place, const MapAxes& axes,
                                      const Vector3f& coarse, const Vector3f& hint) noexcept {
    NearestFace nearest(hint);
    add_faces(place, axes, coarse, nearest);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == axes.axis || std::abs(coarse[axis]) < kOtherAxis * std::abs(coarse[axes.axis])) {
        continue;
      }
      const MapAxes other{axis, coarse[axis] > 0.0f ? 1 : -1};
      windows_ |= other.window();
      const Place there = tiles_.find(voxel, other);
      const auto found = middle(there, other);
      if (found && may_be_face(*found, other, coarse)) {
        nearest.add(*found, std::abs(found->offset));
      } else {
        add_faces(there, other, coarse, nearest);
      }
    }
    return nearest.get();
  }

  /// The windows about the voxel, and in each direction those aside up to the first that is
  /// explained.
  void add_faces(const Place& place, const MapAxes& axes, const Vector3f& coarse,
                 NearestFace& nearest) noexcept {
    FilledTile& tile = *place.tile;
    const auto look = [&](int rings, int a, int b, float by_step) {
      if (rings <= 3 && !tile.is_nearly_explained(rings, place.u + a, place.v + b)) return false;
      const FilledTile::Fit fit = tile.fit(rings, place.u + a, place.v + b);
      const float left = fit.mean_square();
      if (!(left < kNearlyExplained * kNearlyExplained)) return false;
      const float least = by_step + kPerResidual * std::sqrt(left);
      if (nearest.may_be(least)) {
        if (const auto closest = surface_of(place, fit, a, b)) {
          const SurfaceEstimate estimate = to_index_space(*closest, axes);
          if (may_be_face(estimate, axes, coarse)) {
            nearest.add(estimate, std::abs(estimate.offset) + least);
          }
        }
      }
      return left <= kSideResidual * kSideResidual;
    };
    for (const int rings : FilledTile::kSmallRings) {
      if (rings <= tile.ns()) look(rings, 0, 0, 0.0f);
    }
    for (const auto& [x, y] : kRays) {
      bool found = false;
      for (int step = 1; !found && step <= FilledTile::kMostAside; ++step) {
        const float by_step = kPerStep * static_cast<float>(step);
        if (!nearest.may_be(by_step)) break;
        for (const int rings : {3, 2}) {
          if (!found && rings + step <= tile.ns()) {
            found = look(rings, step * x, step * y, by_step);
          }
        }
      }
    }
  }

  static bool may_be_face(const SurfaceEstimate& estimate, const MapAxes& axes,
                          const Vector3f& coarse) noexcept {
    return std::abs(estimate.normal[axes.axis]) >= kLeastFilledCosine &&
           estimate.normal.dot(coarse) >= kLeastFilledCosineToCoarse * coarse.norm();
  }

  /// Moves a surface along its normal to the heights of the voxel's own columns: what is cut of a
  /// voxel must be felt there, or it is cut through while the surface about it says that it still
  /// stands. By the mean over the axes, so that where the normal lies between two of them neither
  /// decides. A column with nothing full in it counts where all are such, as of a thin wall: else
  /// it is a rest beside what has been cut away behind it, and felt where it is, it would be a jump
  /// of the force. What rounding and curvature leave moves nothing.
  void move_to_own_columns(const Cell& voxel, SurfaceEstimate& estimate) noexcept {
    float sum = 0.0f, weights = 0.0f;
    bool has_full = false;
    for (int axis = 0; axis < 3; ++axis) {
      const float along = std::abs(estimate.normal[axis]);
      const float weight = along * along - kLeastOwnAxis * kLeastOwnAxis;
      if (!(weight > 0.0f)) continue;
      estimate.windows |= static_cast<std::uint8_t>(1 << axis);
      const auto height = own_height(batch_.workpiece(), levels_, voxel,
                                     {axis, estimate.normal[axis] > 0.0f ? 1 : -1});
      if (!height || (has_full && height->is_wall)) continue;
      if (!has_full && !height->is_wall) {
        has_full = true;
        sum = weights = 0.0f;
      }
      sum += weight * (height->voxels * along);
      weights += weight;
    }
    if (weights == 0.0f) {
      // None along the normal; what others say it is at most.
      const float most = farthest_surface(batch_.workpiece(), levels_, voxel)
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

  MapBatch& batch_;
  FilledTiles tiles_;
  LevelReader levels_;
  int reach_;                 // parts
  std::uint8_t windows_ = 0;  // that were looked at
};

}  // namespace

void estimate_ldm_filled(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                         int neighbourhood, int trace,
                         std::span<SurfaceEstimate> estimates) noexcept {
  MapBatch batch(workpiece, queries, neighbourhood, trace, FitWindow::kNone);
  FilledEstimator estimator(batch, std::clamp(neighbourhood, 2, FilledTile::kMaxNs),
                            std::min(trace, FilledTile::kMostReach));
  for (std::size_t first = 0, count; first < queries.size(); first += count) {
    count = batch.take(first, MapBatch::kSize);
    SurfaceEstimate* const to = estimates.data() + first;
    const auto estimate = [&](SurfaceEstimate* of) { estimator.estimate(of); };
    estimate(to);
    estimate_equal_axes(batch, estimate, to);
  }
}

}  // namespace sulcus
