#include "engine/assessment/preparation_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "engine/assessment/cavity_widths.hpp"
#include "engine/assessment/cut_walls.hpp"
#include "engine/assessment/insertion_frame.hpp"
#include "engine/assessment/ray_mask.hpp"
#include "engine/assessment/ray_stack.hpp"
#include "engine/assessment/wall_samples.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

constexpr double kSliver_mm = 0.06;  // half the width of what is cut at least
constexpr double kToCut_mm = 0.5;    // from where it is sure to be cut; overhangs hide that much
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kFloorSlope = 0.84;   // tan 40 degrees
constexpr double kSlopeOver_mm = 0.1;  // to each side
constexpr double kLeastFloor_mm2 = 0.1;
constexpr double kAboveMargin_mm = 0.25;

/// An upright wall hides a ray here and there, which is a pitch from those that can be seen.
double least_overhang_mm(const ShapeSettings& settings, double pitch_mm) {
  return std::max(settings.least_overhang_mm, 2.0 * pitch_mm);
}

class ShapeMeter {
 public:
  ShapeMeter(const TriangleMesh& before, const TriangleMesh& after, const RayLattice& lattice,
             const ShapeSettings& settings)
      : lattice_(lattice),
        settings_(settings),
        before_(before, lattice),
        after_(after, lattice),
        after_mesh_(after),
        m_from_frame_(insertion_frame_from_m(settings.insertion).inverse()) {
    const std::size_t rays = lattice.size();
    cut_ = cut(kToCut_mm);
    // So little was removed that it is not sure anywhere.
    if (!any_of(cut_)) cut_ = cut(std::numeric_limits<double>::infinity());
    top_.assign(rays, kNone);
    depth_.assign(rays, kNone);
    open_.assign(rays, 0);
    hidden_.assign(rays, 0);
    beyond_.assign(rays, 0);
    for (std::size_t place = 0; place < rays; ++place) look_at(place);
    find_hidden();
  }

  std::optional<PreparationShape> shape() {
    if (!any_of(cut_)) return {};
    PreparationShape result;
    result.removed_mm3 = removed_mm3_;
    measure_floor(result);
    measure_walls(result);
    result.undercut_mm2 = undercut();
    if (settings_.kind == AssessedKind::kCavity) {
      measure_widths(result);
    } else {
      measure_margin(result);
    }
    return result;
  }

 private:
  static bool any_of(const RayMask& mask) { return std::ranges::find(mask, char{1}) != mask.end(); }
  RayMask cut(double reach_mm) const {
    return opened(cut_rays(before_, after_, lattice_, reach_mm), kSliver_mm, lattice_);
  }
  void look_at(std::size_t place) {
    const auto now = after_.spans(place);
    const double top = now.empty() ? -std::numeric_limits<double>::infinity() : now.back().top_mm;
    if (!now.empty()) top_[place] = top;
    beyond_[place] = !cut_[place] || now.empty() || was_top(place, top);
    if (!cut_[place]) return;
    for (const RayStack::Span& gone : without(before_.spans(place), now, kSame_mm)) {
      removed_mm3_ += (gone.top_mm - gone.bottom_mm) * lattice_.pitch_mm * lattice_.pitch_mm;
      if (gone.top_mm > top) {
        open_[place] = 1;
        depth_[place] = before_.spans(place).back().top_mm - top;
      }
    }
  }
  /// Below all that can be seen two surfaces of a root may differ: there it counts only beside
  /// where the removed is thicker than that.
  void find_hidden() {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    double lowest_open_mm = kFar;
    for (std::size_t place = 0; place < cut_.size(); ++place) {
      if (!open_[place]) continue;
      lowest_open_mm = std::min(lowest_open_mm, std::isnan(top_[place]) ? -kFar : top_[place]);
    }
    RayMask below(cut_.size()), thick(cut_.size());
    for (std::size_t place = 0; place < cut_.size(); ++place) {
      const auto gone = hidden_span(place);
      if (!gone) continue;
      hidden_[place] = gone->top_mm > lowest_open_mm;
      below[place] = !hidden_[place];
      thick[place] = below[place] && is_thick(before_, after_, lattice_, place, *gone);
    }
    const std::vector<double> to_thick_mm = distances_to(thick, lattice_);
    for (std::size_t place = 0; place < cut_.size(); ++place) {
      if (below[place] && to_thick_mm[place] <= 2.0 * kSame_mm) hidden_[place] = 1;
    }
  }
  /// The highest of what was removed below tooth.
  std::optional<RayStack::Span> hidden_span(std::size_t place) const {
    if (!cut_[place]) return {};
    std::optional<RayStack::Span> highest;
    for (const auto& gone : without(before_.spans(place), after_.spans(place), kSame_mm)) {
      if (gone.top_mm <= top_[place]) highest = gone;
    }
    return highest;
  }

  /// Whether the tooth ended there before, below what was cut off over it.
  bool was_top(std::size_t place, double z_mm) const {
    return std::ranges::any_of(before_.spans(place), [&](const RayStack::Span& was) {
      return std::abs(was.top_mm - z_mm) < kSame_mm;
    });
  }

  Eigen::Vector3d world(const Eigen::Vector3d& p_mm) const { return m_from_frame_ * p_mm; }
  Eigen::Vector3d world(std::size_t place, double z_mm) const {
    const Eigen::Vector2d at = lattice_.at_mm(place);
    return world(Eigen::Vector3d(at.x(), at.y(), z_mm));
  }
  double area_mm2(std::size_t rays) const {
    return static_cast<double>(rays) * lattice_.pitch_mm * lattice_.pitch_mm;
  }
  std::size_t rays_of(double mm2) const {
    return static_cast<std::size_t>(mm2 / (lattice_.pitch_mm * lattice_.pitch_mm));
  }

  /// Rays on which the tooth now ends in what is hardly steep.
  RayMask level_rays() const {
    const int reach = std::max(1, static_cast<int>(std::lround(kSlopeOver_mm / lattice_.pitch_mm)));
    const double over = 2.0 * reach * lattice_.pitch_mm;
    RayMask level(lattice_.size());
    for (std::size_t place = 0; place < lattice_.size(); ++place) {
      if (!open_[place] || std::isnan(top_[place])) continue;
      const int x = lattice_.x_of(place), y = lattice_.y_of(place);
      if (!lattice_.holds(x - reach, y - reach) || !lattice_.holds(x + reach, y + reach)) continue;
      const double dx = top_[lattice_.place(x + reach, y)] - top_[lattice_.place(x - reach, y)];
      const double dy = top_[lattice_.place(x, y + reach)] - top_[lattice_.place(x, y - reach)];
      level[place] = std::hypot(dx, dy) < kFloorSlope * over;  // false where there is no tooth
    }
    return level;
  }

  /// Of a crown: whether a level part is the finish line, which runs along the stump's outer edge.
  bool is_margin(const RayComponent& part, const std::vector<double>& from_beyond) const {
    const auto near = std::ranges::count_if(
        part, [&](std::size_t place) { return from_beyond[place] < 2.5 * kSlopeOver_mm; });
    return 10 * static_cast<std::size_t>(near) > part.size();
  }

  void measure_floor(PreparationShape& result) {
    const std::vector<double> from_beyond = distances_to(beyond_, lattice_);
    std::vector<RayComponent> parts = components(level_rays(), rays_of(kLeastFloor_mm2), lattice_);
    if (settings_.kind == AssessedKind::kCrown) {
      const auto margins = std::stable_partition(
          parts.begin(), parts.end(),
          [&](const RayComponent& part) { return !is_margin(part, from_beyond); });
      constexpr double kRises_mm = 2.0;  // at most, round a tooth
      for (auto margin = margins; margin != parts.end(); ++margin) {
        // Level places at the rim of a top that was not cut lie higher.
        if (std::abs(mean_height(*margin) - mean_height(*margins)) > kRises_mm) continue;
        margin_.insert(margin_.end(), margin->begin(), margin->end());
      }
      if (stump_stands()) {
        parts.erase(margins, parts.end());
      } else {
        margin_.clear();  // it is the top of a small tooth
      }
    }
    if (parts.empty()) return;
    const RayComponent& floor = parts.front();
    double sum = 0.0;
    std::size_t deepest = floor.front(), shallowest = floor.front();
    for (const std::size_t place : floor) {
      sum += depth_[place];
      if (depth_[place] > depth_[deepest]) deepest = place;
      if (depth_[place] < depth_[shallowest]) shallowest = place;
    }
    const Eigen::Vector3d at = world(deepest, top_[deepest]);
    result.depth_mm = {sum / static_cast<double>(floor.size()), at};
    for (const RayComponent& part : parts) {  // a pit has a floor of its own
      for (const std::size_t place : part) {
        if (depth_[place] > depth_[deepest]) deepest = place;
      }
    }
    result.greatest_depth_mm = {depth_[deepest], world(deepest, top_[deepest])};
    result.least_depth_mm = {depth_[shallowest], world(shallowest, top_[shallowest])};
    result.floor_flatness_um = flatness(floor);
  }

  double mean_height(const RayComponent& part) const {
    double sum = 0.0;
    for (const std::size_t place : part) sum += top_[place];
    return sum / static_cast<double>(part.size());
  }
  /// Above what would be the finish line.
  bool stump_stands() const {
    const RayMask core = core_over_margin();
    return any_of(core);
  }
  /// Where the tooth stands a little above the finish line that is nearest, which rises and falls
  /// round a tooth.
  RayMask core_over_margin() const {
    RayMask core(cut_.size());
    std::vector<double> height(cut_.size(), kNone);
    std::vector<std::size_t> reached = margin_;
    for (const std::size_t place : reached) height[place] = top_[place];
    for (std::size_t next = 0; next < reached.size(); ++next) {  // breadth first
      const std::size_t place = reached[next];
      core[place] = after_.contains(place, height[place] + kAboveMargin_mm);
      for (const auto& [dx, dy] : kRaysBeside) {
        const int x = lattice_.x_of(place) + dx, y = lattice_.y_of(place) + dy;
        if (!lattice_.holds(x, y)) continue;
        const std::size_t beside = lattice_.place(x, y);
        if (!std::isnan(height[beside])) continue;
        height[beside] = height[place];
        reached.push_back(beside);
      }
    }
    return core;
  }

  PlacedFigure flatness(const RayComponent& floor) const {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const auto row = [&](std::size_t place) -> Eigen::Vector3d {
      const Eigen::Vector2d at = lattice_.at_mm(place);
      return {at.x(), at.y(), 1.0};
    };
    for (const std::size_t place : floor) {
      normal += row(place) * row(place).transpose();
      right += top_[place] * row(place);
    }
    const Eigen::Vector3d plane = normal.ldlt().solve(right);
    double squares = 0.0, most = -1.0;
    std::size_t worst = floor.front();
    for (const std::size_t place : floor) {
      const double off = std::abs(top_[place] - plane.dot(row(place)));
      squares += off * off;
      if (off > most) most = off, worst = place;
    }
    return {1e3 * std::sqrt(squares / static_cast<double>(floor.size())),
            world(worst, top_[worst])};
  }

  void measure_walls(PreparationShape& result) {
    patches_ = wall_patches(WallFinder(lattice_, before_, top_).samples(after_mesh_));
    const std::vector<WallPatch>& patches = patches_;
    if (patches.empty()) return;
    const Convergence convergence = convergence_of(patches);
    if (convergence.worst) {
      result.convergence_deg = {convergence.mean_deg, world(convergence.worst->at_mm)};
    }
    measure_sides(result);
    const auto roughest = std::ranges::max_element(patches, {}, &WallPatch::roughness_um);
    double rough = 0.0, area = 0.0;
    for (const WallPatch& patch : patches) {
      rough += patch.area_mm2 * patch.roughness_um;
      area += patch.area_mm2;
    }
    result.greatest_roughness_um = {roughest->roughness_um, world(roughest->at_mm)};
    result.roughness_um = {rough / area, result.greatest_roughness_um->at_m};
    if (settings_.kind == AssessedKind::kCavity) result.wall_left_mm = wall_left();
  }

  /// A crown's walls face the sides that they are of, a cavity's face away from them.
  void measure_sides(PreparationShape& result) const {
    const double out = settings_.kind == AssessedKind::kCrown ? 1.0 : -1.0;
    const auto measure = [&](ToothSide side, const Eigen::Vector3d& to) {
      constexpr double kLeastAcross = 0.5;  // sin 30 degrees
      const Eigen::Vector3d in_frame = (m_from_frame_.linear().inverse() * to).normalized();
      const Eigen::Vector2d across = in_frame.head<2>();
      if (across.norm() < kLeastAcross) return;
      const WallTaper taper = taper_facing(patches_, out * across.normalized());
      if (!taper.worst) return;
      result.wall_deg[static_cast<std::size_t>(side)] =
          PlacedFigure{taper.mean_deg, world(taper.worst->at_mm)};
    };
    measure(ToothSide::kMesial, settings_.mesial);
    measure(ToothSide::kDistal, -settings_.mesial);
    measure(ToothSide::kBuccal, settings_.buccal);
    measure(ToothSide::kLingual, -settings_.buccal);
  }

  /// How thick the tooth stands behind the walls, across the path.
  std::optional<PlacedFigure> wall_left() const {
    std::optional<PlacedFigure> least;
    for (const WallPatch& patch : patches_) {
      const auto thickness = tooth_behind(patch);
      if (thickness && (!least || *thickness < least->value)) {
        least = {*thickness, world(patch.at_mm)};
      }
    }
    return least;
  }
  /// Where it stands further than the rays do: as far as these. None where there is none at all.
  std::optional<double> tooth_behind(const WallPatch& patch) const {
    constexpr double kToTooth_mm = 0.15;  // by which a fit may lie before the wall itself
    const double step = 0.5 * lattice_.pitch_mm;
    bool entered = false;
    std::optional<double> left_at;
    for (double way = 0.0;; way += step) {
      const Eigen::Vector2d at = patch.at_mm.head<2>() - way * patch.facing;
      if (!lattice_.covers(at)) return entered ? way : left_at;
      const bool tooth = after_.contains(lattice_.nearest(at), patch.at_mm.z());
      if (entered && !tooth) {
        left_at = way;
        if (way > kToTooth_mm) return left_at;
      }
      entered = tooth;
      // By now it is behind the wall, or that is thinner than the fit is uncertain.
      if (!entered && way > kToTooth_mm) return left_at;
    }
  }

  PlacedFigure undercut() const {
    const double least_mm = least_overhang_mm(settings_, lattice_.pitch_mm);
    // What reaches out from what can be seen; further in than that, it is hidden for sure.
    RayMask seen(cut_.size());
    for (std::size_t i = 0; i < cut_.size(); ++i) seen[i] = open_[i] && !hidden_[i];
    const std::vector<double> from_seen = distances_to(seen, lattice_);
    RayMask deep(cut_.size());
    double furthest = 0.0;
    std::optional<std::size_t> worst;
    for (std::size_t i = 0; i < cut_.size(); ++i) {
      deep[i] = hidden_[i] && from_seen[i] >= least_mm;
      if (deep[i] && (!worst || from_seen[i] > furthest)) furthest = from_seen[i], worst = i;
    }
    if (!worst) return {};
    const std::vector<double> from_deep = distances_to(deep, lattice_);
    std::size_t rays = 0;
    for (std::size_t i = 0; i < cut_.size(); ++i) {
      rays += hidden_[i] && from_deep[i] <= 1.5 * least_mm ? 1u : 0u;
    }
    const RayStack::Span gone = hidden_span(*worst).value();
    return {area_mm2(rays), world(*worst, 0.5 * (gone.bottom_mm + gone.top_mm))};
  }

  /// Of a section halfway between the floor and the tooth as it was.
  void measure_widths(PreparationShape& result) const {
    if (!result.depth_mm) return;
    const Eigen::Vector3d deepest = m_from_frame_.inverse() * result.depth_mm->at_m;
    const double z = deepest.z() + 0.5 * result.depth_mm->value;
    RayMask inside(cut_.size());
    for (std::size_t i = 0; i < cut_.size(); ++i) {
      inside[i] = cut_[i] && !after_.contains(i, z) && before_.contains(i, z);
    }
    inside = part_over(lattice_.nearest(deepest.head<2>()), inside);
    const CavityWidths widths(lattice_, inside, patches_, z);
    const auto placed = [&](const CavityWidth& width) {
      return PlacedFigure{width.mm, world(width.place, z)};
    };
    const std::optional<CavityWidth> widest = widths.widest();
    if (!widest) return;
    result.width_mm = placed(*widest);
    result.isthmus_mm = placed(*widths.isthmus());
  }

  /// The connected part in which a ray is, else the largest: of several cavities the one whose
  /// floor was measured.
  RayMask part_over(std::size_t place, const RayMask& of) const {
    const std::vector<RayComponent> parts = components(of, 1, lattice_);
    if (parts.empty()) return of;
    const auto own = std::ranges::find_if(parts, [&](const RayComponent& part) {
      return std::ranges::find(part, place) != part.end();
    });
    return mask_of(own != parts.end() ? *own : parts.front());
  }

  /// How far the wall stands from the outer edge of what was cut, a little above the finish line.
  void measure_margin(PreparationShape& result) const {
    if (margin_.empty()) return;
    const RayMask core = core_over_margin();
    const std::vector<double> to_core = distances_to(core, lattice_);
    result.margin_slope_deg = margin_slope(to_core);
    const double taper = result.convergence_deg ? 0.5 * result.convergence_deg->value : 0.0;
    const double lean = kAboveMargin_mm * std::tan(taper * kDegree);
    std::vector<std::pair<double, std::size_t>> widths;
    const std::vector<double> from_margin = distances_to(mask_of(margin_), lattice_);
    for (std::size_t place = 0; place < cut_.size(); ++place) {
      if (!is_outer_edge(place, core) || from_margin[place] > 3.0 * kSlopeOver_mm) continue;
      widths.emplace_back(to_core[place] - lean, place);
    }
    if (widths.empty()) return;
    std::ranges::sort(widths);
    result.margin_mm = {widths[widths.size() / 2].first,
                        world(widths.front().second, top_[widths.front().second])};
  }
  /// By how much the finish line sinks over a short way straight from the wall.
  std::optional<PlacedFigure> margin_slope(const std::vector<double>& to_core) const {
    const RayMask margin = mask_of(margin_);
    const int reach = std::max(1, static_cast<int>(std::lround(kSlopeOver_mm / lattice_.pitch_mm)));
    std::vector<std::pair<double, std::size_t>> slopes;
    for (const std::size_t place : margin_) {
      const int x = lattice_.x_of(place), y = lattice_.y_of(place);
      const std::array<std::size_t, 4> around{
          lattice_.place(x + reach, y), lattice_.place(x - reach, y), lattice_.place(x, y + reach),
          lattice_.place(x, y - reach)};
      if (!std::ranges::all_of(around, [&](std::size_t at) { return margin[at] != 0; })) continue;
      const auto rise = [&](const std::vector<double>& of) {
        return Eigen::Vector2d(of[around[0]] - of[around[1]], of[around[2]] - of[around[3]]);
      };
      const double over = 2.0 * reach * lattice_.pitch_mm;
      const double sinks = -rise(top_).dot(rise(to_core).normalized()) / over;
      slopes.emplace_back(std::atan(sinks) / kDegree, place);
    }
    if (slopes.empty()) return {};
    std::ranges::sort(slopes);
    const std::size_t steepest = slopes.back().second;
    return PlacedFigure{slopes[slopes.size() / 2].first, world(steepest, top_[steepest])};
  }
  RayMask mask_of(const RayComponent& part) const {
    RayMask mask(cut_.size());
    for (const std::size_t place : part) mask[place] = 1;
    return mask;
  }
  /// Of the stump, at its side; its core may have a top that was not cut.
  bool is_outer_edge(std::size_t place, const RayMask& core) const {
    if (!open_[place] || beyond_[place] || core[place]) return false;
    const int x = lattice_.x_of(place), y = lattice_.y_of(place);
    return std::ranges::any_of(kRaysBeside, [&](const std::array<int, 2>& side) {
      if (!lattice_.holds(x + side[0], y + side[1])) return false;
      const std::size_t beside = lattice_.place(x + side[0], y + side[1]);
      return beyond_[beside] && !core[beside];
    });
  }

  RayLattice lattice_;
  ShapeSettings settings_;
  RayStack before_, after_;
  const TriangleMesh& after_mesh_;
  Eigen::Affine3d m_from_frame_;
  RayMask cut_, open_, hidden_;      // something was removed; to be seen from above; below tooth
  RayMask beyond_;                   // where the tooth ends in what was not cut, or there is none
  std::vector<double> top_, depth_;  // where the tooth now ends; below where it did
  RayComponent margin_;              // of a crown
  std::vector<WallPatch> patches_;
  double removed_mm3_ = 0.0;
};

}  // namespace

std::optional<PreparationShape> preparation_shape(const TriangleMesh& before,
                                                  const TriangleMesh& after,
                                                  const ShapeSettings& settings) {
  const Eigen::Affine3d frame = insertion_frame_from_m(settings.insertion);
  const TriangleMesh was = moved(before, frame), is = moved(after, frame);
  const Eigen::AlignedBox2d removed = box_of_removed(was, is);
  if (removed.isEmpty()) return {};
  constexpr double kBeside_mm = 6.0;  // as far as the tooth may stand behind a wall
  const Eigen::AlignedBox2d where =
      widened(removed, kBeside_mm).intersection(box_of(was).merged(box_of(is)));
  const RayLattice lattice = lattice_over(where, settings.pitch_mm);
  return ShapeMeter(was, is, lattice, settings).shape();
}

}  // namespace sulcus
