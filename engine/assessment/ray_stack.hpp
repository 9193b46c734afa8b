#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// From a ray to those beside it, in rays.
inline constexpr std::array<std::array<int, 2>, 4> kRaysBeside{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// Parallel rays along +z on a square lattice, mm, in a frame whose z is the path of insertion.
struct RayLattice {
  Eigen::Vector2d first_mm{0, 0};  // of the ray (0, 0)
  double pitch_mm = 0.0;
  int nx = 0, ny = 0;

  std::size_t size() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(x);
  }
  int x_of(std::size_t place) const {
    return static_cast<int>(place % static_cast<std::size_t>(nx));
  }
  int y_of(std::size_t place) const {
    return static_cast<int>(place / static_cast<std::size_t>(nx));
  }
  bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < nx && y < ny; }
  Eigen::Vector2d at_mm(std::size_t place) const {
    return first_mm + pitch_mm * Eigen::Vector2d(x_of(place), y_of(place));
  }
  /// Whether a point lies among the rays.
  bool covers(const Eigen::Vector2d& p_mm) const {
    const Eigen::Array2d at = (p_mm - first_mm) / pitch_mm;
    return (at >= 0.0).all() && at.x() <= nx - 1 && at.y() <= ny - 1;
  }
  /// The ray nearest to a point; clamped to the lattice.
  std::size_t nearest(const Eigen::Vector2d& p_mm) const;
};

/// Where a closed mesh is solid along each ray of a lattice, exactly, whatever the size of its
/// triangles. A ray through a shared edge or vertex meets exactly one of the triangles there, so
/// that none leaks. Shells that overlap count as one solid. Immutable.
class RayStack {
 public:
  struct Span {
    double bottom_mm, top_mm;
  };

  /// `mesh`: positions in mm, in the lattice's frame; triangles counter-clockwise from outside.
  RayStack(const TriangleMesh& mesh, const RayLattice& lattice);

  /// Rising, apart.
  std::span<const Span> spans(std::size_t place) const {
    return std::span(spans_).subspan(begin_[place], begin_[place + 1] - begin_[place]);
  }
  bool contains(std::size_t place, double z_mm) const;

 private:
  std::vector<Span> spans_;
  std::vector<std::size_t> begin_;
};

/// What of `a` is not in `b`; parts shorter than `least_mm` left out.
std::vector<RayStack::Span> without(std::span<const RayStack::Span> a,
                                    std::span<const RayStack::Span> b, double least_mm);

}  // namespace sulcus
