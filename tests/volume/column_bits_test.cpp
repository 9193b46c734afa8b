#include "engine/volume/column_bits.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus {
namespace {

std::uint64_t window_by_voxel(const VoxelModel& model, int axis, int u, int v, int start) {
  std::uint64_t window = 0;
  for (int bit = 0; bit < 64; ++bit) {
    Cell c;
    c[axis] = start + bit;
    c[(axis + 1) % 3] = u;
    c[(axis + 2) % 3] = v;
    window |= std::uint64_t{model.solid(c)} << bit;
  }
  return window;
}

void expect_all_windows(const ColumnBits& columns, const VoxelModel& model, int stride) {
  constexpr int kBorder = ColumnBits::kBorder;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3i& n = model.grid.cells;
    const int n_u = n[(axis + 1) % 3], n_v = n[(axis + 2) % 3];
    for (int v = -kBorder; v < n_v + kBorder; v += 3) {
      for (int u = -kBorder; u < n_u + kBorder; ++u) {
        for (int start = -64; start <= n[axis]; start += stride) {
          ASSERT_EQ(columns.window(axis, u, v, start), window_by_voxel(model, axis, u, v, start))
              << "axis " << axis << " u " << u << " v " << v << " start " << start;
        }
      }
    }
    // The last corner of what may be asked.
    ASSERT_EQ(columns.window(axis, n_u + kBorder - 1, n_v + kBorder - 1, n[axis]), 0u);
  }
}

TEST(ColumnBits, WindowsEqualTheVoxels) {
  for (const Eigen::Vector3i& cells :
       {Eigen::Vector3i(8, 24, 16), Eigen::Vector3i(72, 8, 8), Eigen::Vector3i(8, 8, 136)}) {
    const VoxelModel model = test::random_blobs(cells, 3);
    expect_all_windows(ColumnBits(model), model, 5);
  }
}

TEST(ColumnBits, EveryStartOfOneColumnIsServed) {
  const VoxelModel model = test::random_blobs({136, 8, 8}, 4);
  const ColumnBits columns(model);
  for (int start = -64; start <= 136; ++start) {
    EXPECT_EQ(columns.window(0, 4, 4, start), window_by_voxel(model, 0, 4, 4, start)) << start;
  }
}

TEST(ColumnBits, ClearEmptiesTheVoxelInAllThreePackings) {
  VoxelModel model = test::random_blobs({24, 16, 72}, 5);
  ColumnBits columns(model);
  std::vector<Cell> solid = test::solid_cells(model);
  std::mt19937 random(6);
  test::shuffle(solid, random);
  solid.resize(solid.size() / 3);
  for (const Cell& c : solid) {
    columns.clear(c);
    model.set(c, false);
  }
  expect_all_windows(columns, model, 11);
}

}  // namespace
}  // namespace sulcus
