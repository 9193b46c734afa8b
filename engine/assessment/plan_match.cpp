#include "engine/assessment/plan_match.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <unsupported/Eigen/BVH>

#include "engine/assessment/insertion_frame.hpp"
#include "engine/assessment/ray_mask.hpp"
#include "engine/assessment/ray_stack.hpp"
#include "engine/assessment/surface_pieces.hpp"
#include "engine/core/nearest_on_triangle.hpp"
#include "engine/core/parallel.hpp"

namespace sulcus {

namespace {

constexpr double kPiece_mm = 0.1;
constexpr double kToWalls_mm = 3.0 * kSame_mm;  // from where a cut is sure to be one

/// Triangles, and a tree of boxes over them.
class Walls {
 public:
  void add(const TriangleCorners& triangle) { triangles_.push_back(triangle); }
  bool empty() const { return triangles_.empty(); }
  /// After the last of them.
  void build() {
    std::vector<std::size_t> numbers(triangles_.size());
    std::vector<Eigen::AlignedBox3d> boxes(triangles_.size());
    for (std::size_t n = 0; n < triangles_.size(); ++n) {
      numbers[n] = n;
      for (const Eigen::Vector3d& corner : triangles_[n]) boxes[n].extend(corner);
    }
    tree_.init(numbers.begin(), numbers.end(), boxes.begin(), boxes.end());
  }
  double distance(const Eigen::Vector3d& p) const {
    FromPoint question{triangles_, p};
    return std::sqrt(Eigen::BVMinimize(tree_, question));
  }

 private:
  /// BVMinimize's question, by squared distances.
  struct FromPoint {
    using Scalar = double;
    const std::vector<TriangleCorners>& triangles;
    const Eigen::Vector3d p;

    // NOLINTNEXTLINE(readability-identifier-naming): Eigen's
    double minimumOnVolume(const Eigen::AlignedBox3d& box) const {
      return box.squaredExteriorDistance(p);
    }
    // NOLINTNEXTLINE(readability-identifier-naming): Eigen's
    double minimumOnObject(std::size_t n) const {
      const auto& [a, b, c] = triangles[n];
      return (p - nearest_on_triangle(p, a, b, c)).squaredNorm();
    }
  };
  std::vector<TriangleCorners> triangles_;
  Eigen::KdBVH<double, 3, std::size_t> tree_;
};

/// A piece of the surface that is held against the plan.
struct Sample {
  Eigen::Vector3d at_mm;
  double area_mm2;
  bool beyond;          // the plan: over, else under
  double off_mm = 0.0;  // from its walls
};

double length_of(std::span<const RayStack::Span> spans) {
  double sum = 0.0;
  for (const RayStack::Span& span : spans) sum += span.top_mm - span.bottom_mm;
  return sum;
}

class PlanMeter {
 public:
  PlanMeter(const TriangleMesh& before, const TriangleMesh& after, const TriangleMesh& plan,
            const RayLattice& lattice)
      : lattice_(lattice),
        before_mesh_(before),
        after_mesh_(after),
        plan_mesh_(plan),
        before_(before, lattice),
        after_(after, lattice),
        plan_(plan, lattice),
        removed_(cut_rays(before_, after_, lattice, kToWalls_mm)),
        wanted_(cut_rays(before_, plan_, lattice, kToWalls_mm)),
        to_removed_mm_(distances_to(removed_, lattice)),
        to_wanted_mm_(distances_to(wanted_, lattice)) {}

  /// Places in the space of the rays, mm.
  std::optional<PlanMatch> match(double tolerance_mm) {
    find_walls();
    if (walls_.empty()) return {};
    PlanMatch result;
    std::vector<Sample> cut = cut_samples();
    measure(cut);
    set_errors(cut, tolerance_mm, result);
    std::vector<Sample> gone = gone_samples();
    measure(gone);
    cut.insert(cut.end(), gone.begin(), gone.end());
    for (const Sample& sample : cut) {
      PlacedFigure& most = sample.beyond ? result.over_mm : result.under_mm;
      if (sample.off_mm > most.value) most = {sample.off_mm, sample.at_mm};
    }
    result.dice = dice();
    return result;
  }

 private:
  /// Calls `visit` for the pieces of a mesh over which there are rays.
  template <class Visit>
  void for_pieces(const TriangleMesh& mesh, const Visit& visit) const {
    const Eigen::Vector2d last(lattice_.nx - 1, lattice_.ny - 1);
    const Eigen::AlignedBox2d rays(lattice_.first_mm, lattice_.first_mm + lattice_.pitch_mm * last);
    for (const auto& triangle : mesh.triangles) {
      const TriangleCorners corner = corners_of(mesh, triangle);
      Eigen::AlignedBox2d box;
      for (const Eigen::Vector3d& p : corner) box.extend(p.head<2>());
      if (!box.intersects(rays)) continue;
      for_each_piece(corner, kPiece_mm, [&](const SurfacePiece& piece) {
        if (lattice_.covers(piece.middle().head<2>())) visit(piece);
      });
    }
  }

  /// Up to their rims: a piece counts as soon as a corner of it was inside.
  void find_walls() {
    for_pieces(plan_mesh_, [&](const SurfacePiece& piece) {
      if (std::ranges::any_of(piece.corner, [&](const Eigen::Vector3d& p) {
            return was_bared(to_wanted_mm_, p);
          })) {
        walls_.add(piece.corner);
      }
    });
    walls_.build();
  }
  /// Where rays met a cut, whose upright walls stand beside them. In a narrow fissure there is
  /// tooth all round a place, too.
  bool is_near(const std::vector<double>& to_cut_mm, const Eigen::Vector3d& p_mm) const {
    return to_cut_mm[lattice_.nearest(p_mm.head<2>())] < 2.0 * kSame_mm;
  }
  bool was_bared(const std::vector<double>& to_cut_mm, const Eigen::Vector3d& p_mm) const {
    return is_near(to_cut_mm, p_mm) && is_deep_in(before_, lattice_, p_mm);
  }
  bool in_plan(const Eigen::Vector3d& p_mm) const {
    return plan_.contains(lattice_.nearest(p_mm.head<2>()), p_mm.z());
  }
  /// The tooth's surface where it was cut or where the plan takes it away.
  std::vector<Sample> cut_samples() const {
    std::vector<Sample> samples;
    for_pieces(after_mesh_, [&](const SurfacePiece& piece) {
      const Eigen::Vector3d at = piece.middle();
      const bool left = is_near(to_wanted_mm_, at) && is_clear_of(plan_, lattice_, at);
      if (left || was_bared(to_removed_mm_, at)) samples.push_back({at, piece.area(), in_plan(at)});
    });
    return samples;
  }
  /// The tooth's old surface where it went without the plan.
  std::vector<Sample> gone_samples() const {
    std::vector<Sample> samples;
    for_pieces(before_mesh_, [&](const SurfacePiece& piece) {
      const Eigen::Vector3d at = piece.middle();
      if (is_near(to_removed_mm_, at) && is_clear_of(after_, lattice_, at) &&
          !is_clear_of(plan_, lattice_, at)) {
        samples.push_back({at, piece.area(), true});
      }
    });
    return samples;
  }
  void measure(std::vector<Sample>& samples) const {
    parallel_for(std::size_t{0}, samples.size(),
                 [&](std::size_t n) { samples[n].off_mm = walls_.distance(samples[n].at_mm); });
  }

  static void set_errors(std::vector<Sample> cut, double tolerance_mm, PlanMatch& result) {
    std::ranges::sort(cut, {}, &Sample::off_mm);
    double area = 0.0, sum = 0.0, within = 0.0;
    for (const Sample& sample : cut) {
      area += sample.area_mm2;
      sum += sample.area_mm2 * sample.off_mm;
      if (sample.off_mm <= tolerance_mm) within += sample.area_mm2;
    }
    if (area == 0.0) return;
    result.error_mm = sum / area;
    result.within_tolerance = within / area;
    double so_far = 0.0;
    for (const Sample& sample : cut) {
      result.error_95_mm = sample.off_mm;
      if ((so_far += sample.area_mm2) >= 0.95 * area) break;
    }
  }

  double dice() const {
    double sum = 0.0, both = 0.0;
    for (std::size_t place = 0; place < lattice_.size(); ++place) {
      using Spans = std::vector<RayStack::Span>;
      const auto gone = [&](bool counts, const RayStack& now) {
        return counts ? without(before_.spans(place), now.spans(place), kSame_mm) : Spans{};
      };
      const Spans r = gone(removed_[place], after_), t = gone(wanted_[place], plan_);
      sum += length_of(r) + length_of(t);
      both += length_of(r) - length_of(without(r, t, 0.0));
    }
    return sum > 0.0 ? 2.0 * both / sum : 0.0;
  }

  RayLattice lattice_;
  const TriangleMesh &before_mesh_, &after_mesh_, &plan_mesh_;
  RayStack before_, after_, plan_;
  RayMask removed_, wanted_;
  std::vector<double> to_removed_mm_, to_wanted_mm_;  // of each ray
  Walls walls_;
};

}  // namespace

std::optional<PlanMatch> plan_match(const TriangleMesh& before, const TriangleMesh& after,
                                    const TriangleMesh& plan, const PlanSettings& settings) {
  const Eigen::Affine3d frame = insertion_frame_from_m(settings.insertion);
  const TriangleMesh was = moved(before, frame), is = moved(after, frame);
  const TriangleMesh wanted = moved(plan, frame);
  const Eigen::AlignedBox2d where = box_of_removed(was, is).merged(box_of_removed(was, wanted));
  if (where.isEmpty()) return {};
  constexpr double kBeside_mm = 0.5;
  const RayLattice lattice = lattice_over(widened(where, kBeside_mm), settings.pitch_mm);
  std::optional<PlanMatch> result =
      PlanMeter(was, is, wanted, lattice).match(settings.tolerance_mm);
  if (!result) return {};
  for (PlacedFigure* const figure : {&result->over_mm, &result->under_mm}) {
    figure->at_m = frame.inverse() * figure->at_m;
  }
  return result;
}

}  // namespace sulcus
