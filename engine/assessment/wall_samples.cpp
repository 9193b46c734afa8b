#include "engine/assessment/wall_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "engine/assessment/surface_pieces.hpp"

namespace sulcus {
namespace {

constexpr double kBeside_mm = 0.3;

}  // namespace

std::vector<WallSample> WallFinder::samples(const TriangleMesh& after) const {
  constexpr double kSteep = 0.6;  // of the normal's part along the path
  constexpr double kPiece_mm = 0.1;
  std::vector<WallSample> found;
  for (const auto& triangle : after.triangles) {
    const auto corner = corners_of(after, triangle);
    const Eigen::Vector3d twice = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    if (twice.isZero(0.0) || std::abs(twice.z()) > kSteep * twice.norm()) continue;
    for_each_piece(corner, kPiece_mm, [&](const SurfacePiece& piece) {
      const WallSample sample{piece.middle(), piece.normal(), piece.area()};
      if (is_of_wall(sample)) found.push_back(sample);
    });
  }
  return found;
}

bool WallFinder::is_of_wall(const WallSample& sample) const {
  const Eigen::Vector2d facing = sample.normal.head<2>().normalized();
  if (!lattice_.covers(sample.at_mm.head<2>())) return false;  // no ray is near
  const double low = foot(sample, facing), high = upper_edge(sample, facing);
  const double edge = std::max(0.1, 0.15 * (high - low));
  return sample.at_mm.z() > low + edge && sample.at_mm.z() < high - edge &&
         was_tooth_before(sample, facing);
}

double WallFinder::foot(const WallSample& sample, const Eigen::Vector2d& facing) const {
  const std::size_t place = lattice_.nearest(sample.at_mm.head<2>() + kBeside_mm * facing);
  if (!std::isnan(top_mm_[place])) return top_mm_[place];
  const double z = sample.at_mm.z();
  for (const RayStack::Span& was : before_.spans(place)) {
    if (was.bottom_mm <= z && z <= was.top_mm) return was.bottom_mm;
  }
  return top_mm_[place];
}

double WallFinder::upper_edge(const WallSample& sample, const Eigen::Vector2d& facing) const {
  const double step = 0.5 * lattice_.pitch_mm;
  const int steps = std::max(1, static_cast<int>(std::ceil(kBeside_mm / step)));
  double high = -std::numeric_limits<double>::infinity();
  for (int i = 0; i <= steps; ++i) {
    const double way = kBeside_mm * i / steps;
    const double top = top_mm_[lattice_.nearest(sample.at_mm.head<2>() - way * facing)];
    if (top > high) high = top;  // false where there is none
  }
  return high;
}

bool WallFinder::was_tooth_before(const WallSample& sample, const Eigen::Vector2d& facing) const {
  const Eigen::Vector2d along(-facing.y(), facing.x());
  return std::ranges::all_of(
      std::array{facing, along, Eigen::Vector2d(-along)}, [&](const Eigen::Vector2d& to) {
        const std::size_t place = lattice_.nearest(sample.at_mm.head<2>() + 1.2 * kSame_mm * to);
        return before_.contains(place, sample.at_mm.z() - kSame_mm) &&
               before_.contains(place, sample.at_mm.z() + kSame_mm);
      });
}

}  // namespace sulcus
