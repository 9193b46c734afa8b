#include "app/pictures/section_range.hpp"

#include <bit>
#include <limits>

#include <Eigen/Geometry>

#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/volume/leaf_bits.hpp"

namespace sulcus {
namespace {

/// First and last voxel of a leaf that is not empty, along each axis.
Eigen::AlignedBox3i box_of(const LeafBits& leaf) {
  std::uint64_t all = 0;
  int first = kLeafEdge, last = 0;
  for (int k = 0; k < kLeafEdge; ++k) {
    const std::uint64_t slice = leaf.words[static_cast<std::size_t>(k)];
    if (slice == 0) continue;
    if (first == kLeafEdge) first = k;
    last = k;
    all |= slice;
  }
  std::uint64_t row = all | all >> 32;  // those of all y
  row |= row >> 16;
  row = (row | row >> 8) & 0xff;
  const auto highest = [](std::uint64_t word) { return 63 - std::countl_zero(word); };
  return {Eigen::Vector3i(std::countr_zero(row), std::countr_zero(all) / kLeafEdge, first),
          Eigen::Vector3i(highest(row), highest(all) / kLeafEdge, last)};
}

Eigen::AlignedBox3d box_of(const VoxelModel& model) {
  const VoxelGrid& grid = model.grid;
  Eigen::AlignedBox3i cells;
  for (std::uint32_t leaf = 0; leaf < grid.leaf_count(); ++leaf) {
    if (!any(model.leaves[leaf])) continue;
    const Eigen::AlignedBox3i box = box_of(model.leaves[leaf]);
    cells.extend(grid.leaf_origin(leaf) + box.min());
    cells.extend(grid.leaf_origin(leaf) + box.max());
  }
  if (cells.isEmpty()) return {};
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5);
  return {grid.world_from_index(cells.min().cast<double>() - half),
          grid.world_from_index(cells.max().cast<double>() + half)};
}

}  // namespace

Extent extent_along(int axis, std::span<const RenderedBody> bodies) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Extent extent{kFar, -kFar};
  for (const RenderedBody& body : bodies) {
    const Eigen::AlignedBox3d box = box_of(body.model);
    if (box.isEmpty()) continue;
    for (int c = 0; c < 8; ++c) {
      const Eigen::Vector3d corner =
          body.world_from_grid.point(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c)));
      extent.low_m = std::min(extent.low_m, corner[axis]);
      extent.high_m = std::max(extent.high_m, corner[axis]);
    }
  }
  return extent;
}

void check_section(const Section& section, std::span<const RenderedBody> bodies,
                   const std::string& text) {
  const Extent extent = extent_along(section.axis, bodies);
  if (section.at_m > extent.low_m && section.at_m < extent.high_m) return;
  throw InputError(
      "", "--section", "'" + text + "'",
      formatted("%c=%.4g to %.4g, where there is something to cut open", "xyz"[section.axis],
                extent.low_m / kMillimetre, extent.high_m / kMillimetre));
}

}  // namespace sulcus
