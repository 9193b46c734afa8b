#include "haptics/contact/broad_phase.hpp"

#include <algorithm>
#include <array>

namespace sulcus {

namespace {

/// The capsule in index space.
struct IndexCapsule {
  Eigen::Vector3d a, ab;  // segment from a to a + ab, voxels
  double radius = 0.0;
  double per_length2 = 0.0;  // 1 / |ab|^2; 0 of a ball
};

/// Whether a box (centre, half edges) comes within the capsule's radius of its segment.
bool reaches(const IndexCapsule& capsule, const Eigen::Vector3d& centre,
             const Eigen::Vector3d& half) {
  // Mostly the balls in and about the box settle it.
  const Eigen::Vector3d to_centre = centre - capsule.a;
  const double along = std::clamp(to_centre.dot(capsule.ab) * capsule.per_length2, 0.0, 1.0);
  const double away2 = (to_centre - along * capsule.ab).squaredNorm();
  const double in = capsule.radius + half.minCoeff();
  if (away2 <= in * in) return true;
  const double about = capsule.radius + half.norm();
  if (away2 > about * about) return false;
  // The squared distance of the segment's point t to the box is convex in t and its derivative
  // piecewise linear: bisect on the sign of the derivative. 12 halvings place t to 1/4096 of the
  // segment, and as the function is flat at its minimum the distance far better than that.
  const Eigen::Vector3d from = capsule.a - centre;
  double t0 = 0.0, t1 = 1.0;
  const double radius2 = capsule.radius * capsule.radius;
  for (int step = 0; step < 12; ++step) {
    const double t = 0.5 * (t0 + t1);
    double distance2 = 0.0, slope = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double p = from[a] + t * capsule.ab[a];
      const double excess = p > half[a] ? p - half[a] : p < -half[a] ? p + half[a] : 0.0;
      distance2 += excess * excess;
      slope += excess * capsule.ab[a];
    }
    if (distance2 <= radius2) return true;
    (slope > 0 ? t1 : t0) = t;
  }
  return false;
}

}  // namespace

Eigen::AlignedBox3d capsule_bounds(const Capsule& capsule_tool, const Pose& world_from_tool,
                                   double margin_m) noexcept {
  Eigen::AlignedBox3d box(world_from_tool.point(capsule_tool.a_tool));
  box.extend(world_from_tool.point(capsule_tool.b_tool));
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(capsule_tool.radius_m + margin_m);
  return {box.min() - reach, box.max() + reach};
}

bool broad_phase(const Workpiece& workpiece, const Capsule& capsule_tool,
                 const Pose& world_from_tool, double margin_m, ContactScratch& scratch) noexcept {
  scratch.leaves.clear();
  scratch.emptied_nodes.clear();
  const VoxelGrid& grid = workpiece.grid();
  const Octree& octree = workpiece.octree();
  const Eigen::Vector3d a = grid.index_from_world(world_from_tool.point(capsule_tool.a_tool));
  const Eigen::Vector3d b = grid.index_from_world(world_from_tool.point(capsule_tool.b_tool));
  const double length2 = (b - a).squaredNorm();
  const IndexCapsule capsule{a, b - a, (capsule_tool.radius_m + margin_m) / grid.voxel_m,
                             length2 > 0.0 ? 1.0 / length2 : 0.0};

  // Pre-order with a stack of our own: at most 7 siblings wait on each of at most 8 levels.
  struct Visit {
    Octree::Place place;
    std::uint32_t index;  // of a node with something below it
  };
  std::array<Visit, 64> stack;
  std::size_t depth = 0;
  const auto push = [&](const Octree::Place& place, std::uint32_t index) {
    if (octree.node(index).status == ChildStatus::kNone) return false;
    stack[depth++] = {place, index};
    return true;
  };
  push({}, octree.index({}));
  while (depth > 0) {
    const auto [place, index] = stack[--depth];
    const OctreeNode& node = octree.node(index);
    Eigen::Vector3d lower, upper;  // voxel cubes reach half a voxel beyond their centres
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = node.lower[axis] - 0.5;
      upper[axis] = node.upper[axis] - 0.5;
    }
    if (!reaches(capsule, 0.5 * (lower + upper), 0.5 * (upper - lower))) continue;

    if (octree.is_leaf_level(place.level)) {
      const std::uint32_t leaf = octree.leaf_number(index);
      if (!any(workpiece.surface(leaf))) continue;  // wholly inside the solid
      if (scratch.leaves.size() == scratch.leaves.capacity()) return false;
      scratch.leaves.push_back(leaf);
      continue;
    }
    bool any_child = false;
    const Octree::Place first{place.level + 1, 2 * place.at};
    const Eigen::Vector3i& n = octree.dims(first.level);
    const std::uint32_t first_index = octree.index(first);
    const bool to_leaves = octree.is_leaf_level(first.level);
    const auto to_next_y = static_cast<std::uint32_t>(n.x());
    const auto to_next_z = to_next_y * static_cast<std::uint32_t>(n.y());
    for (std::uint32_t c = 8; c-- > 0;) {  // pushed in reverse, so that they are visited in order
      const std::uint32_t x = c & 1, y = c >> 1 & 1, z = c >> 2;
      const Octree::Place child{first.level,
                                first.at + Eigen::Vector3i(static_cast<int>(x), static_cast<int>(y),
                                                           static_cast<int>(z))};
      if (child.at.x() >= n.x() || child.at.y() >= n.y() || child.at.z() >= n.z()) continue;
      const std::uint32_t child_index = first_index + x + y * to_next_y + z * to_next_z;
      if (!push(child, child_index)) continue;
      any_child = true;
      // Outputs for here, it is there when its turn comes.
      if (to_leaves) __builtin_prefetch(&workpiece.surface(octree.leaf_number(child_index)));
    }
    if (!any_child && scratch.emptied_nodes.size() < scratch.emptied_nodes.capacity()) {
      scratch.emptied_nodes.push_back(index);
    }
  }
  return true;
}

}  // namespace sulcus
