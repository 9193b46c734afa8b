#include "haptics/contact/broad_phase.hpp"

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::broad_phase_test {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kVoxel = 50e-6;
const Capsule kCapsule{{0, 0.3e-3, 0}, {0, 1.5e-3, 0}, 0.35e-3};

double distance_to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

/// The distance of a segment's point to a box is convex along it: thirds close in on the least.
double distance_to_segment(const AlignedBox3d& box, const Vector3d& a, const Vector3d& b) {
  const auto at = [&](double t) { return box.exteriorDistance(Vector3d(a + t * (b - a))); };
  double low = 0.0, high = 1.0;
  for (int step = 0; step < 100; ++step) {
    const double t0 = low + (high - low) / 3, t1 = high - (high - low) / 3;
    (at(t0) <= at(t1) ? high : low) = at(t0) <= at(t1) ? t1 : t0;
  }
  return std::min({at(0.0), at(low), at(1.0)});
}

Pose random_pose(std::mt19937& random, double reach_m) {
  const auto unit = [&] { return static_cast<double>(random() % 2000001) * 1e-6 - 1.0; };
  Pose pose;
  pose.position = Vector3d(unit(), unit(), unit()) * reach_m;
  pose.orientation = Eigen::Quaterniond(unit(), unit(), unit(), unit() + 0.01).normalized();
  return pose;
}

std::uint64_t morton(const Vector3i& at) {
  std::uint64_t key = 0;
  for (int bit = 0; bit < 7; ++bit) {
    for (int a = 0; a < 3; ++a) {
      key |= static_cast<std::uint64_t>(at[a] >> bit & 1) << (3 * bit + a);
    }
  }
  return key;
}

struct Query {
  Pose pose;
  double margin_m;
};

std::vector<Query> queries(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<Query> all;
  for (int q = 0; q < count; ++q) {
    all.push_back({random_pose(random, 2e-3), q % 3 == 0 ? 0.0 : kVoxel * (q % 3)});
  }
  return all;
}

TEST(BroadPhase, NeverMissesASurfaceVoxelWithinTheMargin) {
  for (const Vector3i& cells : {Vector3i(64, 64, 64), Vector3i(40, 24, 72)}) {
    const Workpiece workpiece(test::random_blobs(cells, 8, kVoxel));
    const std::vector<Cell> surface = test::surface_cells(workpiece);
    ContactScratch scratch{HapticsSettings{}};
    std::size_t near = 0;
    for (const Query& q : queries(200, 1)) {
      ASSERT_TRUE(broad_phase(workpiece, kCapsule, q.pose, q.margin_m, scratch));
      const std::set<std::uint32_t> found(scratch.leaves.begin(), scratch.leaves.end());
      const Vector3d a = q.pose.point(kCapsule.a_tool), b = q.pose.point(kCapsule.b_tool);
      for (const Cell& c : surface) {
        const double distance_m = distance_to_segment(workpiece.grid().centre_world(c), a, b);
        if (distance_m > kCapsule.radius_m + q.margin_m) continue;
        ++near;
        ASSERT_TRUE(found.contains(workpiece.grid().leaf_of(c))) << c.transpose();
      }
    }
    EXPECT_GT(near, 10000u);
  }
}

TEST(BroadPhase, FindsTheLeavesWhoseBoxTheCapsuleReaches) {
  const Workpiece workpiece(test::random_blobs({64, 64, 64}, 9, kVoxel));
  const VoxelGrid& grid = workpiece.grid();
  const Octree& octree = workpiece.octree();
  ContactScratch scratch{HapticsSettings{}};
  std::size_t total = 0;
  for (const Query& q : queries(300, 2)) {
    broad_phase(workpiece, kCapsule, q.pose, q.margin_m, scratch);
    const std::set<std::uint32_t> found(scratch.leaves.begin(), scratch.leaves.end());
    ASSERT_EQ(found.size(), scratch.leaves.size()) << "a leaf twice";
    const Vector3d a = grid.index_from_world(q.pose.point(kCapsule.a_tool));
    const Vector3d b = grid.index_from_world(q.pose.point(kCapsule.b_tool));
    const double radius = (kCapsule.radius_m + q.margin_m) / kVoxel;
    for (std::uint32_t leaf = 0; leaf < grid.leaf_count(); ++leaf) {
      const OctreeNode& node =
          octree.node(octree.index({octree.levels() - 1, grid.leaf_origin(leaf) / 8}));
      if (node.status == ChildStatus::kNone || workpiece.surface(leaf) == LeafBits{}) {
        ASSERT_FALSE(found.contains(leaf));
        continue;
      }
      AlignedBox3d box;
      for (int axis = 0; axis < 3; ++axis) {
        box.min()[axis] = node.lower[axis] - 0.5;
        box.max()[axis] = node.upper[axis] - 0.5;
      }
      const double distance = distance_to_segment(box, a, b);
      // At the segment's ends the search stops 1/8192 of its length (24 voxels) short.
      if (distance < radius - 0.004) {
        ASSERT_TRUE(found.contains(leaf)) << distance - radius;
      }
      if (distance > radius + 1e-9) {
        ASSERT_FALSE(found.contains(leaf)) << distance - radius;
      }
    }
    total += found.size();
  }
  EXPECT_GT(total, 3000u);
}

TEST(BroadPhase, LeavesComeInPreOrder) {
  const Workpiece workpiece(test::random_blobs({64, 64, 64}, 10, kVoxel));
  ContactScratch scratch{HapticsSettings{}};
  for (const Query& q : queries(50, 3)) {
    broad_phase(workpiece, kCapsule, q.pose, q.margin_m, scratch);
    for (std::size_t i = 1; i < scratch.leaves.size(); ++i) {
      ASSERT_LT(morton(workpiece.grid().leaf_origin(scratch.leaves[i - 1]) / 8),
                morton(workpiece.grid().leaf_origin(scratch.leaves[i]) / 8));
    }
  }
}

TEST(BroadPhase, PassesOverLeavesWhollyInside) {
  const Workpiece workpiece(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {64, 64, 64}));
  ContactScratch scratch{HapticsSettings{}};
  Pose middle;
  middle.position.y() = -0.9e-3;
  broad_phase(workpiece, kCapsule, middle, 0.0, scratch);
  EXPECT_TRUE(scratch.leaves.empty());
}

TEST(BroadPhase, FindsNothingFarAway) {
  const Workpiece workpiece(test::random_blobs({64, 64, 64}, 10, kVoxel));
  ContactScratch scratch{HapticsSettings{}};
  EXPECT_TRUE(broad_phase(workpiece, kCapsule, test::upright({0, 0, 10e-3}), kVoxel, scratch));
  EXPECT_TRUE(scratch.leaves.empty());
}

TEST(BroadPhase, SaysWhenTheLeavesDoNotFit) {
  const Workpiece workpiece(test::random_blobs({64, 64, 64}, 10, kVoxel));
  ContactScratch scratch{HapticsSettings{}};
  ASSERT_TRUE(broad_phase(workpiece, kCapsule, Pose{}, 0.0, scratch));
  ASSERT_GT(scratch.leaves.size(), 5u);
  std::vector<std::uint32_t> small;
  small.reserve(5);
  scratch.leaves.swap(small);
  EXPECT_FALSE(broad_phase(workpiece, kCapsule, Pose{}, 0.0, scratch));
  EXPECT_EQ(scratch.leaves.size(), 5u);
}

TEST(BroadPhase, NotesHollowNodesAndChangesNone) {
  Workpiece workpiece(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {64, 64, 40}));
  const Octree& octree = workpiece.octree();
  // Empty one octant of the second level, 16^3 voxels about the middle.
  for (const Cell& c : test::solid_cells(workpiece.model())) {
    if ((c.array() >= 16).all() && (c.array() < 32).all()) workpiece.remove(c);
  }
  const std::uint32_t emptied = octree.index({octree.levels() - 2, {1, 1, 1}});
  ASSERT_NE(octree.node(emptied).status, ChildStatus::kNone);

  ContactScratch scratch{HapticsSettings{}};
  for (int again = 0; again < 3; ++again) {
    broad_phase(workpiece, kCapsule, Pose{}, 0.0, scratch);
    ASSERT_EQ(scratch.emptied_nodes, std::vector<std::uint32_t>{emptied});
  }
  const std::vector<std::uint32_t> leaves = scratch.leaves;
  workpiece.switch_off(scratch.emptied_nodes);
  broad_phase(workpiece, kCapsule, Pose{}, 0.0, scratch);
  EXPECT_TRUE(scratch.emptied_nodes.empty());
  EXPECT_EQ(scratch.leaves, leaves);
}

TEST(CapsuleBounds, HoldTheCapsuleAndItsMargin) {
  std::mt19937 random(4);
  for (int i = 0; i < 100; ++i) {
    const Pose pose = random_pose(random, 1e-2);
    const AlignedBox3d box = capsule_bounds(kCapsule, pose, kVoxel);
    AlignedBox3d expected;
    for (const Vector3d& end : {pose.point(kCapsule.a_tool), pose.point(kCapsule.b_tool)}) {
      expected.extend(Vector3d(end.array() + 0.4e-3));
      expected.extend(Vector3d(end.array() - 0.4e-3));
    }
    EXPECT_TRUE(box.isApprox(expected, 1e-12));
  }
}

}  // namespace
}  // namespace sulcus::broad_phase_test
