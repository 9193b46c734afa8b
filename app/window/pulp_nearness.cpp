#include "app/window/pulp_nearness.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace sulcus {

namespace {

bool is_outer(const VoxelModel& model, const Cell& c, std::uint8_t pulp) {
  for (int side = 0; side < 6; ++side) {
    Cell beside = c;
    beside[side / 2] += side % 2 == 0 ? 1 : -1;
    if (!model.solid(beside) || model.tissue(beside) != pulp) return true;
  }
  return false;
}

}  // namespace

PulpNearness::PulpNearness(const VoxelModel& start, std::span<const TissueSettings> tissues) {
  const auto found = std::ranges::find(tissues, "pulp", &TissueSettings::name);
  if (found == tissues.end() || !start.tissues) return;
  const auto pulp = static_cast<std::uint8_t>(found - tissues.begin());
  for (std::uint32_t leaf = 0; leaf < start.grid.leaf_count(); ++leaf) {
    for_each_voxel(start.leaves[leaf], [&](int place) {
      const Cell c = start.grid.leaf_origin(leaf) + cell_in_leaf(place);
      if (start.tissue(c) != pulp || !is_outer(start, c, pulp)) return;
      outer_world_.emplace_back(start.grid.centre_world(c).cast<float>());
    });
  }
}

std::optional<double> PulpNearness::distance_m(const Eigen::Vector3d& point_world) const {
  if (outer_world_.empty()) return {};
  const Eigen::Vector3f point = point_world.cast<float>();
  float least = std::numeric_limits<float>::max();
  for (const Eigen::Vector3f& p : outer_world_) least = std::min(least, (p - point).squaredNorm());
  return std::sqrt(static_cast<double>(least));
}

/// By the burr's field, which beyond its box gives more than there is; so the nearest by that are
/// also measured to the corners of the burr's mesh, which give more only close by.
std::optional<double> PulpNearness::distance_m(const Burr& burr,
                                               const Pose& world_from_tool) const {
  if (outer_world_.empty()) return {};
  std::vector<std::pair<float, Eigen::Vector3f>> by_field;
  by_field.reserve(outer_world_.size());
  for (const Eigen::Vector3f& p : outer_world_) {
    const Eigen::Vector3d p_tool = world_from_tool.inverse_point(p.cast<double>());
    by_field.emplace_back(burr.field.sample(burr.field.field_from_tool(p_tool).cast<float>()),
                          p_tool.cast<float>());
  }
  constexpr std::size_t kMeasured = 64;
  const std::size_t count = std::min(kMeasured, by_field.size());
  const auto measured = by_field.begin() + static_cast<std::ptrdiff_t>(count);
  std::partial_sort(by_field.begin(), measured, by_field.end(),
                    [](const auto& a, const auto& b) { return a.first < b.first; });
  float least = by_field.front().first;
  if (least <= 0.0f) return static_cast<double>(least);
  for (auto point = by_field.begin(); point != measured; ++point) {
    for (const Eigen::Vector3f& corner : burr.mesh_tool.positions) {
      least = std::min(least, (corner - point->second).norm());
    }
  }
  return static_cast<double>(least);
}

}  // namespace sulcus
