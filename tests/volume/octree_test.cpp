#include "engine/volume/octree.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/workpiece.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::octree_test {
namespace {

using Eigen::Vector3i;

/// Calls `visit(place)` for every node of every level.
template <class Visit>
void for_each_node(const Octree& tree, const Visit& visit) {
  for (int level = 0; level < tree.levels(); ++level) {
    const Vector3i& n = tree.dims(level);
    for (int z = 0; z < n.z(); ++z) {
      for (int y = 0; y < n.y(); ++y) {
        for (int x = 0; x < n.x(); ++x) visit(Octree::Place{level, {x, y, z}});
      }
    }
  }
}

/// Children of a node that exist.
std::vector<Octree::Place> children_of(const Octree& tree, const Octree::Place& parent) {
  std::vector<Octree::Place> children;
  for (int c = 0; c < 8; ++c) {
    const Vector3i at = 2 * parent.at + Vector3i(c & 1, c >> 1 & 1, c >> 2);
    if ((at.array() < tree.dims(parent.level + 1).array()).all()) {
      children.push_back({parent.level + 1, at});
    }
  }
  return children;
}

/// Leaves that a descent from the root reaches, in its order; internal nodes without children left
/// go into `hollow`.
std::vector<std::uint32_t> descend(const Octree& tree, std::vector<std::uint32_t>& hollow) {
  std::vector<std::uint32_t> leaves;
  std::vector<Octree::Place> stack{{}};
  while (!stack.empty()) {
    const Octree::Place place = stack.back();
    stack.pop_back();
    const std::uint32_t index = tree.index(place);
    if (tree.node(index).status == ChildStatus::kNone) continue;
    if (tree.is_leaf_level(place.level)) {
      leaves.push_back(tree.leaf_number(index));
      continue;
    }
    bool any = false;
    for (const Octree::Place& child : children_of(tree, place)) {
      if (tree.node(tree.index(child)).status == ChildStatus::kNone) continue;
      any = true;
      stack.push_back(child);
    }
    if (!any) hollow.push_back(index);
  }
  return leaves;
}

int level_of(const Octree& tree, std::uint32_t index) {
  int level = 0;
  while (level + 1 < tree.levels() && tree.index({level + 1, {0, 0, 0}}) <= index) ++level;
  return level;
}

TEST(Octree, LevelsHalveDownToOneNode) {
  const Octree tree(test::random_blobs({40, 8, 72}, 1));
  ASSERT_EQ(tree.levels(), 5);
  EXPECT_EQ(tree.dims(0), Vector3i(1, 1, 1));
  EXPECT_EQ(tree.dims(1), Vector3i(1, 1, 2));
  EXPECT_EQ(tree.dims(2), Vector3i(2, 1, 3));
  EXPECT_EQ(tree.dims(3), Vector3i(3, 1, 5));
  EXPECT_EQ(tree.dims(4), Vector3i(5, 1, 9));
}

TEST(Octree, OfOneLeafIsItsRoot) {
  const Octree tree(test::block({8, 8, 8}, 1e-4, {1, 2, 3}, {4, 6, 8}));
  ASSERT_EQ(tree.levels(), 1);
  EXPECT_TRUE(tree.is_leaf_level(0));
  const OctreeNode& root = tree.node(tree.index({}));
  EXPECT_EQ(root.status, ChildStatus::kSome);
  EXPECT_EQ(root.lower, (std::array<std::uint16_t, 3>{1, 2, 3}));
  EXPECT_EQ(root.upper, (std::array<std::uint16_t, 3>{4, 6, 8}));
}

TEST(Octree, LevelsAreContiguousRootFirst) {
  const Octree tree(test::random_blobs({40, 24, 72}, 2));
  std::uint32_t next = 0;
  for_each_node(tree, [&](const Octree::Place& place) { EXPECT_EQ(tree.index(place), next++); });
}

TEST(Octree, LeavesAreNumberedAsInTheGrid) {
  const VoxelModel model = test::random_blobs({40, 24, 72}, 2);
  const Octree tree(model);
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    const Octree::Place place{tree.levels() - 1, model.grid.leaf_origin(leaf) / 8};
    EXPECT_EQ(tree.leaf_number(tree.index(place)), leaf);
  }
}

TEST(Octree, BoundsAreThoseOfTheSolidVoxelsBelow) {
  for (const Vector3i& cells : {Vector3i(8, 24, 16), Vector3i(64, 64, 64), Vector3i(40, 8, 72)}) {
    const VoxelModel model = test::random_blobs(cells, 3);
    const Octree tree(model);
    for_each_node(tree, [&](const Octree::Place& place) {
      const int edge = 8 << (tree.levels() - 1 - place.level);
      Vector3i lower = cells, upper = Vector3i::Zero();
      const Vector3i begin = place.at * edge;
      const Vector3i end = (begin.array() + edge).min(cells.array());
      for (int k = begin.z(); k < end.z(); ++k) {
        for (int j = begin.y(); j < end.y(); ++j) {
          for (int i = begin.x(); i < end.x(); ++i) {
            if (!model.solid({i, j, k})) continue;
            lower = lower.cwiseMin(Vector3i(i, j, k));
            upper = upper.cwiseMax(Vector3i(i + 1, j + 1, k + 1));
          }
        }
      }
      const OctreeNode& node = tree.node(tree.index(place));
      ASSERT_EQ(node.status == ChildStatus::kNone, (upper.array() == 0).all());
      if (node.status == ChildStatus::kNone) return;
      for (int a = 0; a < 3; ++a) {
        ASSERT_EQ(node.lower[a], lower[a]);
        ASSERT_EQ(node.upper[a], upper[a]);
      }
    });
  }
}

TEST(Octree, BoundsHoldTheFarCornerOfTheLargestGrid) {
  VoxelModel model;
  model.grid = {{1024, 8, 8}, 1e-5};
  model.leaves.resize(model.grid.leaf_count());
  model.set({1023, 7, 7}, true);
  const Octree tree(model);
  EXPECT_EQ(tree.node(0).lower, (std::array<std::uint16_t, 3>{1023, 7, 7}));
  EXPECT_EQ(tree.node(0).upper, (std::array<std::uint16_t, 3>{1024, 8, 8}));
}

TEST(Octree, StatusIsNoneFullOrSomeOfTheChildren) {
  const VoxelModel model = test::random_blobs({64, 48, 80}, 4);
  const Octree tree(model);
  std::array<int, 3> seen{};
  for_each_node(tree, [&](const Octree::Place& place) {
    std::size_t present = 0, all = 0;
    if (tree.is_leaf_level(place.level)) {
      all = 512;
      for (std::uint64_t word : model.leaves[tree.leaf_number(tree.index(place))].words) {
        present += static_cast<std::size_t>(std::popcount(word));
      }
    } else {
      all = 8;  // a child beyond the grid is one that is missing
      for (const Octree::Place& child : children_of(tree, place)) {
        present += tree.node(tree.index(child)).status != ChildStatus::kNone;
      }
    }
    const ChildStatus expected = present == 0     ? ChildStatus::kNone
                                 : present == all ? ChildStatus::kFull
                                                  : ChildStatus::kSome;
    ASSERT_EQ(tree.node(tree.index(place)).status, expected);
    ++seen[static_cast<std::size_t>(expected)];
  });
  for (int count : seen) EXPECT_GT(count, 0) << "the shape leaves a status untested";
}

TEST(Octree, AnEmptiedParentGoesInALaterTickThanItsChildren) {
  // One solid leaf far from the origin, in a tree of four levels.
  Workpiece workpiece(test::block({64, 64, 64}, 1e-4, {56, 56, 56}, {64, 64, 64}));
  const Octree& tree = workpiece.octree();
  for (const Cell& c : test::solid_cells(workpiece.model())) workpiece.remove(c);
  ASSERT_EQ(tree.levels(), 4);
  for (int tick = 0; tick < 3; ++tick) {
    std::vector<std::uint32_t> hollow;
    EXPECT_TRUE(descend(tree, hollow).empty());
    ASSERT_EQ(hollow.size(), 1u) << "one level a tick";
    EXPECT_EQ(level_of(tree, hollow[0]), 2 - tick);
    EXPECT_NE(tree.node(hollow[0]).status, ChildStatus::kNone) << "finding it changes nothing";
    workpiece.switch_off(hollow);
    EXPECT_EQ(tree.node(hollow[0]).status, ChildStatus::kNone);
  }
  EXPECT_EQ(tree.node(0).status, ChildStatus::kNone);
}

TEST(Octree, LazyEvaluationEndsAtTheTreeRebuilt) {
  Workpiece workpiece(test::random_blobs({64, 48, 80}, 5));
  // Dig out whole regions, so that nodes of several levels lose all they had.
  for (const Cell& c : test::solid_cells(workpiece.model())) {
    const bool dug = c.x() < 34 && c.y() < 33 && c.z() < 40;
    if (dug || c.z() >= 48) workpiece.remove(c);
  }
  const Workpiece rebuilt{VoxelModel(workpiece.model())};
  const Octree &tree = workpiece.octree(), &fresh = rebuilt.octree();

  std::vector<std::uint32_t> hollow, none;
  const std::vector<std::uint32_t> expected = descend(fresh, none);
  ASSERT_TRUE(none.empty());
  int ticks = 0;
  do {
    hollow.clear();
    ASSERT_EQ(descend(tree, hollow), expected) << "in tick " << ticks;
    workpiece.switch_off(hollow);
    ASSERT_LE(++ticks, tree.levels());
  } while (!hollow.empty());
  EXPECT_GT(ticks, 2);
  for_each_node(tree, [&](const Octree::Place& place) {
    const std::uint32_t i = tree.index(place);
    ASSERT_EQ(tree.node(i).status == ChildStatus::kNone,
              fresh.node(i).status == ChildStatus::kNone);
  });
}

TEST(Octree, BoundsStayConservativeUnderRemoval) {
  Workpiece workpiece(test::random_blobs({32, 32, 32}, 6));
  std::vector<Cell> solid = test::solid_cells(workpiece.model());
  std::mt19937 random(7);
  test::shuffle(solid, random);
  solid.resize(solid.size() * 4 / 5);
  for (const Cell& c : solid) workpiece.remove(c);
  const Octree& tree = workpiece.octree();
  for (const Cell& c : test::solid_cells(workpiece.model())) {
    for (int level = 0; level < tree.levels(); ++level) {
      const Vector3i at = c / (8 << (tree.levels() - 1 - level));
      const OctreeNode& node = tree.node(tree.index({level, at}));
      ASSERT_NE(node.status, ChildStatus::kNone);
      for (int a = 0; a < 3; ++a) {
        ASSERT_LE(node.lower[a], c[a]);
        ASSERT_GT(node.upper[a], c[a]);
      }
    }
  }
}

}  // namespace
}  // namespace sulcus::octree_test
