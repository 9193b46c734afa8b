#include "engine/volume/workpiece.hpp"

#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::workpiece_test {
namespace {

using Eigen::Vector3i;

const std::vector<Vector3i> kGrids{{8, 8, 8}, {8, 24, 16}, {32, 32, 32}, {40, 16, 72}};

bool is_surface_by_neighbours(const VoxelModel& model, const Cell& c) {
  if (!model.solid(c)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    for (int step : {-1, 1}) {
      if (!model.solid(c + step * Cell::Unit(axis))) return true;
    }
  }
  return false;
}

void expect_surface_by_neighbours(const Workpiece& workpiece) {
  std::uint64_t surface = 0;
  for (std::uint32_t v = 0; v < workpiece.grid().cell_count(); ++v) {
    const Cell c = workpiece.grid().cell_of_linear(v);
    const bool expected = is_surface_by_neighbours(workpiece.model(), c);
    surface += expected;
    ASSERT_EQ(workpiece.is_surface(c), expected) << c.transpose();
  }
  EXPECT_EQ(workpiece.surface_voxels(), surface);
}

/// Everything that an edit keeps up against a workpiece built from the same voxels.
void expect_as_rebuilt(const Workpiece& edited) {
  const Workpiece rebuilt{VoxelModel(edited.model())};
  ASSERT_EQ(edited.model().leaves, rebuilt.model().leaves);
  EXPECT_EQ(edited.hash(), rebuilt.hash());
  EXPECT_EQ(edited.hash_with_tissues(), rebuilt.hash_with_tissues());
  EXPECT_EQ(edited.solid_voxels(), rebuilt.solid_voxels());
  EXPECT_EQ(edited.surface_voxels(), rebuilt.surface_voxels());
  const Octree &tree = edited.octree(), &fresh = rebuilt.octree();
  const Vector3i leaves = edited.grid().leaf_dims();
  for (std::uint32_t leaf = 0; leaf < edited.grid().leaf_count(); ++leaf) {
    ASSERT_EQ(edited.surface(leaf), rebuilt.surface(leaf)) << leaf;
    const Vector3i at = edited.grid().leaf_origin(leaf) / 8;
    const std::uint32_t node = tree.index({tree.levels() - 1, at});
    ASSERT_EQ(tree.node(node).status, fresh.node(node).status) << leaf << " of " << leaves;
  }
  // The box of the edited one is that of the solid as it was.
  const Cell &lower = rebuilt.columns().lower(), &upper = rebuilt.columns().upper();
  for (int axis = 0; axis < 3; ++axis) {
    const int a_u = (axis + 1) % 3, a_v = (axis + 2) % 3;
    for (int v = lower[a_v]; v < upper[a_v]; ++v) {
      for (int u = lower[a_u]; u < upper[a_u]; ++u) {
        for (int start = lower[axis]; start < upper[axis]; start += 64) {
          ASSERT_EQ(edited.columns().window(axis, u, v, start),
                    rebuilt.columns().window(axis, u, v, start));
        }
      }
    }
  }
}

TEST(Workpiece, SurfaceIsEveryVoxelWithAnEmptyNeighbour) {
  for (const Vector3i& cells : kGrids) {
    for (std::uint32_t seed = 1; seed < 5; ++seed) {
      expect_surface_by_neighbours(Workpiece(test::random_blobs(cells, seed)));
    }
  }
}

TEST(Workpiece, FacesOfTheGridAreSurface) {
  const Workpiece workpiece(test::make_model({16, 24, 8}, 1e-4, [](const Cell&) { return true; }));
  expect_surface_by_neighbours(workpiece);
  EXPECT_EQ(workpiece.surface_voxels(), 16u * 24 * 8 - 14u * 22 * 6);
}

TEST(Workpiece, SurfaceContinuesOverLeafBorders) {
  // Two solid leaves side by side along each axis: their common face is inside.
  for (int axis = 0; axis < 3; ++axis) {
    Cell upper(16, 16, 16);
    upper[axis] = 24;
    const Workpiece workpiece(test::block({32, 32, 32}, 1e-4, {8, 8, 8}, upper));
    expect_surface_by_neighbours(workpiece);
    Cell inside(12, 12, 12);
    inside[axis] = 15;
    EXPECT_FALSE(workpiece.is_surface(inside));
    inside[axis] = 16;
    EXPECT_FALSE(workpiece.is_surface(inside));
  }
}

TEST(Workpiece, RemovalKeepsEverythingAsIfRebuilt) {
  for (const Vector3i& cells : kGrids) {
    Workpiece workpiece(test::random_blobs(cells, 11));
    std::vector<Cell> solid = test::solid_cells(workpiece.model());
    std::mt19937 random(12);
    test::shuffle(solid, random);
    const std::size_t half = solid.size() / 2;
    for (std::size_t i = 0; i < half; ++i) workpiece.remove(solid[i]);
    EXPECT_EQ(workpiece.solid_voxels(), solid.size() - half);
    expect_surface_by_neighbours(workpiece);
    expect_as_rebuilt(workpiece);
  }
}

TEST(Workpiece, RemovalFromTheSurfaceInwardKeepsEverythingAsIfRebuilt) {
  // As a burr cuts: only what is exposed goes, in thousands.
  Workpiece workpiece(test::ball({40, 40, 40}, 1e-4, {20.3, 19.1, 18.7}, 15.0));
  std::mt19937 random(13);
  for (int layer = 0; layer < 4; ++layer) {
    std::vector<Cell> surface = test::surface_cells(workpiece);
    test::shuffle(surface, random);
    surface.resize(surface.size() * 3 / 4);
    for (const Cell& c : surface) workpiece.remove(c);
    expect_as_rebuilt(workpiece);
  }
}

TEST(Workpiece, PutBackInAnyOrderItIsAsBefore) {
  for (const Vector3i& cells : kGrids) {
    const VoxelModel start = test::random_blobs(cells, 18);
    Workpiece workpiece{VoxelModel(start)};
    const Workpiece before{VoxelModel(start)};
    std::vector<Cell> solid = test::solid_cells(start);
    std::mt19937 random(19);
    for (const Cell& c : solid) workpiece.remove(c);
    // As a traversal leaves it that has found nothing.
    std::vector<std::uint32_t> inner(
        workpiece.octree().index({workpiece.octree().levels() - 1, {0, 0, 0}}));
    std::iota(inner.begin(), inner.end(), 0u);
    workpiece.switch_off(inner);
    test::shuffle(solid, random);
    for (std::size_t i = 0; i < solid.size(); ++i) {
      workpiece.put_back(solid[i]);
      if (i == solid.size() / 2) expect_surface_by_neighbours(workpiece);
    }
    EXPECT_EQ(workpiece.hash(), before.hash());
    expect_as_rebuilt(workpiece);
    for (std::uint32_t leaf = 0; leaf < before.grid().leaf_count(); ++leaf) {
      ASSERT_EQ(workpiece.surface(leaf), before.surface(leaf));
    }
    const std::uint32_t nodes =
        static_cast<std::uint32_t>(inner.size()) + before.grid().leaf_count();
    for (std::uint32_t n = 0; n < nodes; ++n) {
      const OctreeNode &now = workpiece.octree().node(n), &then = before.octree().node(n);
      ASSERT_EQ(now.status == ChildStatus::kNone, then.status == ChildStatus::kNone) << n;
    }
  }
}

TEST(Workpiece, EmptiedItIsAsIfNeverFilled) {
  Workpiece workpiece(test::random_blobs({16, 24, 8}, 14));
  for (const Cell& c : test::solid_cells(workpiece.model())) workpiece.remove(c);
  EXPECT_EQ(workpiece.hash(), 0u);
  EXPECT_EQ(workpiece.solid_voxels(), 0u);
  EXPECT_EQ(workpiece.surface_voxels(), 0u);
  expect_as_rebuilt(workpiece);
}

TEST(Workpiece, HashDoesNotDependOnTheOrderOfRemoval) {
  const VoxelModel model = test::random_blobs({32, 24, 16}, 15);
  std::vector<Cell> cells = test::solid_cells(model);
  std::mt19937 random(16);
  test::shuffle(cells, random);
  cells.resize(cells.size() / 2);
  Workpiece one{VoxelModel(model)}, other{VoxelModel(model)};
  for (const Cell& c : cells) one.remove(c);
  test::shuffle(cells, random);
  for (const Cell& c : cells) other.remove(c);
  EXPECT_EQ(one.hash(), other.hash());
}

TEST(Workpiece, HashTellsEveryRemovalApart) {
  Workpiece workpiece(test::random_blobs({16, 16, 16}, 17));
  std::vector<std::uint64_t> hashes{workpiece.hash()};
  for (const Cell& c : test::solid_cells(workpiece.model())) {
    workpiece.remove(c);
    hashes.push_back(workpiece.hash());
  }
  std::sort(hashes.begin(), hashes.end());
  EXPECT_EQ(std::adjacent_find(hashes.begin(), hashes.end()), hashes.end());
}

TEST(Workpiece, HashTellsEqualLeavesInDifferentPlacesApart) {
  const Workpiece low(test::block({16, 16, 16}, 1e-4, {0, 0, 0}, {8, 8, 8}));
  const Workpiece high(test::block({16, 16, 16}, 1e-4, {8, 0, 0}, {16, 8, 8}));
  EXPECT_NE(low.hash(), high.hash());
}

TEST(Workpiece, HashWithTissuesTellsLabelsApart) {
  const VoxelModel plain = test::block({16, 8, 8}, 1e-4, {0, 0, 0}, {8, 8, 8});
  const auto labelled = [&](std::uint8_t label, bool mixed) {
    VoxelModel model = plain;
    auto tissues = std::make_shared<TissueMap>(2);
    if (mixed) {
      LabelBlock labels;
      labels.fill(label);
      labels[9] = static_cast<std::uint8_t>(label + 1);
      tissues->set_block(0, labels, model.leaves[0]);
    } else {
      tissues->set_uniform(0, label);
    }
    // The other leaf is empty: what it is labelled is nobody's.
    tissues->set_uniform(1, static_cast<std::uint8_t>(label * 3));
    model.tissues = tissues;
    return Workpiece(std::move(model));
  };
  EXPECT_EQ(labelled(1, false).hash(), labelled(2, false).hash());
  EXPECT_NE(labelled(1, false).hash_with_tissues(), labelled(2, false).hash_with_tissues());
  EXPECT_NE(labelled(1, true).hash_with_tissues(), labelled(2, true).hash_with_tissues());
  EXPECT_NE(labelled(1, true).hash_with_tissues(), labelled(1, false).hash_with_tissues());
  EXPECT_EQ(labelled(1, true).hash_with_tissues(), labelled(1, true).hash_with_tissues());
}

TEST(Workpiece, EmptyLeavesHaveNoTissueInTheHash) {
  VoxelModel model = test::block({16, 8, 8}, 1e-4, {0, 0, 0}, {8, 8, 8});
  const auto hash_of = [&](std::uint8_t label) {
    auto tissues = std::make_shared<TissueMap>(2);
    tissues->set_uniform(1, label);
    model.tissues = tissues;
    return Workpiece{VoxelModel(model)}.hash_with_tissues();
  };
  EXPECT_EQ(hash_of(1), hash_of(2));
}

TEST(Workpiece, AnEmptyGridIsFine) {
  const Workpiece workpiece(test::make_model({16, 8, 8}, 1e-4, [](const Cell&) { return false; }));
  EXPECT_EQ(workpiece.hash(), 0u);
  EXPECT_EQ(workpiece.surface_voxels(), 0u);
  EXPECT_FALSE(workpiece.is_surface({0, 0, 0}));
}

}  // namespace
}  // namespace sulcus::workpiece_test
