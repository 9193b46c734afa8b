#include "engine/import/volumes/grey_fills.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <tbb/parallel_for.h>

#include "engine/shapes/cell_coverage.hpp"

namespace sulcus {
namespace {

struct GreySample {
  double value;
  Eigen::Vector3d gradient;  // per step of the lattice
};

/// By the spline's kernel; empty where that reaches beyond the lattice. `values`: x fastest.
std::optional<GreySample> sample(std::span<const float> values, const Eigen::Vector3i& sizes,
                                 const Eigen::Vector3d& p) {
  const Eigen::Vector3d floor = p.array().floor();
  if ((floor.array() < 1.0).any() || (floor.array() > sizes.cast<double>().array() - 3.0).any())
    return std::nullopt;
  const Eigen::Vector3i base = floor.cast<int>();
  std::array<std::array<float, 4>, 3> weights, slopes;
  for (int a = 0; a < 3; ++a) {
    const auto t = static_cast<float>(p[a] - floor[a]);
    weights[a] = interpolation_weights(Interpolation::kSpline, t);
    slopes[a] = spline_slopes(t);
  }
  const auto nx = static_cast<std::size_t>(sizes.x()), ny = static_cast<std::size_t>(sizes.y());
  const auto corner = (base - Eigen::Vector3i::Ones()).cast<std::size_t>().eval();
  const float* const first = &values[corner.x() + nx * (corner.y() + ny * corner.z())];
  float value = 0.0f;
  Eigen::Vector3f gradient = Eigen::Vector3f::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    Eigen::Vector3f plane = Eigen::Vector3f::Zero();  // slopes along x and y, value
    for (std::size_t j = 0; j < 4; ++j) {
      const float* const row = first + nx * (j + ny * k);
      float along = 0.0f, slope = 0.0f;
      for (std::size_t i = 0; i < 4; ++i) {
        along += weights[0][i] * row[i];
        slope += slopes[0][i] * row[i];
      }
      plane += Eigen::Vector3f(weights[1][j] * slope, slopes[1][j] * along, weights[1][j] * along);
    }
    value += weights[2][k] * plane.z();
    gradient += Eigen::Vector3f(weights[2][k] * plane.x(), weights[2][k] * plane.y(),
                                slopes[2][k] * plane.z());
  }
  return GreySample{value, gradient.cast<double>()};
}

/// In the grid: gradients per voxel.
std::optional<GreySample> sample(const GreyInGrid& values, const Eigen::Vector3d& p_index) {
  std::optional<GreySample> found =
      sample(values.grey.values, values.grey.sizes, values.linear * p_index + values.offset);
  if (found) found->gradient = values.linear.transpose() * found->gradient;
  return found;
}

/// Share of a voxel about `centre` that is solid; empty where no surface is near.
std::optional<double> share_at(const GreyInGrid& values, const Eigen::Vector3d& centre) {
  // What the half diagonal of a voxel reaches, and twice that: the way need not be the shortest.
  constexpr double kStep = 0.45, kReach = 1.8;
  constexpr int kHalvings = 8;
  const std::optional<GreySample> here = sample(values, centre);
  if (!here || !(here->gradient.norm() > 0.0)) return std::nullopt;
  const bool in = here->value >= values.level;
  const Eigen::Vector3d way = here->gradient.normalized() * (in ? -1.0 : 1.0);
  const auto on_this_side = [&](double t) {
    const std::optional<GreySample> there = sample(values, centre + t * way);
    return !there || (there->value >= values.level) == in;
  };
  double from = 0.0, to = kStep;
  while (to <= kReach && on_this_side(to)) {
    from = to;
    to += kStep;
  }
  if (to > kReach) return std::nullopt;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (from + to);
    (on_this_side(middle) ? from : to) = middle;
  }
  const Eigen::Vector3d to_surface = 0.5 * (from + to) * way;
  const std::optional<GreySample> at = sample(values, centre + to_surface);
  if (!at || !(at->gradient.norm() > 0.0)) return std::nullopt;
  const Eigen::Vector3d outward = -at->gradient.normalized();
  return share_behind_plane(outward, -outward.dot(to_surface));
}

/// Voxels of a leaf of whose 26 neighbours within the grid one is solid and one, or the voxel
/// itself, is not.
LeafBits at_surface(const VoxelModel& model, std::uint32_t leaf) {
  constexpr int kWide = kLeafEdge + 2;
  const auto at = [](const Cell& c) {
    return static_cast<std::size_t>(c.x() + kWide * (c.y() + kWide * c.z()));
  };
  // Bit 0: empty; bit 1: solid. Of the leaf and one voxel around it; beyond the grid neither.
  std::array<std::uint8_t, kWide * kWide * kWide> sides{};
  const Cell first = model.grid.leaf_origin(leaf) - Cell::Ones();
  std::uint8_t all = 0;
  for_each_cell(Cell::Zero(), Cell::Constant(kWide), [&](const Cell& c) {
    if (!model.grid.contains(first + c)) return;
    all |= sides[at(c)] = model.solid(first + c) ? 2 : 1;
  });
  LeafBits found;
  if (all != 3) return found;
  for (int axis = 0; axis < 3; ++axis) {
    const auto before = sides;
    Cell low = Cell::Zero(), high = Cell::Constant(kWide);
    low[axis] = 1;
    high[axis] = kWide - 1;
    for_each_cell(low, high, [&](const Cell& c) {
      const int beside = before[at(c - Cell::Unit(axis))] | before[at(c + Cell::Unit(axis))];
      sides[at(c)] = static_cast<std::uint8_t>(sides[at(c)] | beside);
    });
  }
  for (int place = 0; place < 512; ++place) {
    if (sides[at(cell_in_leaf(place) + Cell::Ones())] == 3) found.set(place);
  }
  return found;
}

}  // namespace

std::vector<LeafLevels> grey_fills(const VoxelModel& solid, const GreyInGrid& values) {
  std::vector<std::vector<LeafLevels>> pages(solid.leaves.size());
  tbb::parallel_for(std::uint32_t{0}, solid.grid.leaf_count(), [&](std::uint32_t leaf) {
    const LeafBits band = at_surface(solid, leaf);
    if (!any(band)) return;
    LeafLevels page{leaf, {}};
    for_each_voxel(solid.leaves[leaf], [&](int place) { page.levels[place] = kFullLevel; });
    const LevelBlock before = page.levels;
    for_each_voxel(band, [&](int place) {
      const Cell c = solid.grid.leaf_origin(leaf) + cell_in_leaf(place);
      const std::optional<double> share = share_at(values, c.cast<double>());
      if (!share) return;
      const auto level = static_cast<FillLevel>(std::lround(kFullLevel * *share));
      page.levels[place] = std::max(level, solid.solid(c) ? FillLevel{1} : FillLevel{0});
    });
    if (page.levels != before) pages[leaf].push_back(page);
  });
  return joined(pages);
}

std::array<double, 2> grey_ramp(std::span<const float> values, const Eigen::Vector3i& sizes,
                                float level) {
  double sum = 0.0;
  std::uint64_t count = 0;
  const auto nx = static_cast<std::size_t>(sizes.x()), ny = static_cast<std::size_t>(sizes.y());
  const std::array<std::size_t, 3> stride = {1, nx, nx * ny};
  for_each_cell(Cell::Ones(), sizes - Cell::Constant(2), [&](const Cell& c) {
    const auto at = c.cast<std::size_t>().eval();
    const std::size_t v = at.x() + nx * (at.y() + ny * at.z());
    for (int axis = 0; axis < 3; ++axis) {
      const double here = values[v], next = values[v + stride[axis]];
      if ((here >= level) == (next >= level)) continue;
      Eigen::Vector3d p = c.cast<double>();
      p[axis] += (level - here) / (next - here);
      const std::optional<GreySample> there = sample(values, sizes, p);
      if (!there) continue;
      sum += there->gradient.norm();
      ++count;
    }
  });
  const double half = count > 0 ? 0.5 * sum / static_cast<double>(count) : 0.0;
  return {level - half, level + half};
}

}  // namespace sulcus
