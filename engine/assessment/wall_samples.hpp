#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/assessment/cut_walls.hpp"
#include "engine/assessment/insertion_frame.hpp"
#include "engine/assessment/ray_stack.hpp"

namespace sulcus {

/// Which pieces of a cut tooth's surface are walls of what was cut. Frame: mm, z is the path of
/// insertion. Refers to what it is made of.
class WallFinder {
 public:
  /// `top_mm`: where the tooth now ends on each ray, NaN where there is none.
  WallFinder(const RayLattice& lattice, const RayStack& before, const std::vector<double>& top_mm)
      : lattice_(lattice), before_(before), top_mm_(top_mm) {}

  /// Pieces of the walls of `after`, without what lies near their foot and their upper edge. A
  /// large triangle counts where each of its pieces lies.
  std::vector<WallSample> samples(const TriangleMesh& after) const;

 private:
  bool is_of_wall(const WallSample& sample) const;
  /// Of what was cut right through: the lower end of the tooth as it was. NaN where there was none.
  double foot(const WallSample& sample, const Eigen::Vector2d& facing) const;
  /// The highest behind the wall, however thin that is.
  double upper_edge(const WallSample& sample, const Eigen::Vector2d& facing) const;
  /// Further before the wall than two surfaces of one tooth differ, and beside that: the tooth's
  /// own outside is no wall. Nothing is asked of what stands behind it, however thin.
  bool was_tooth_before(const WallSample& sample, const Eigen::Vector2d& facing) const;

  const RayLattice& lattice_;
  const RayStack& before_;
  const std::vector<double>& top_mm_;
};

}  // namespace sulcus
