#include "engine/volume/column_bits.hpp"

#include <gtest/gtest.h>

#include "engine/normals/map_kernels.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::column_bits_test {
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

static_assert(kLevel <= ColumnBits::kBelow, "the maps begin this far below a voxel");

/// Every window that may be asked: around the columns of the box, from below it to its end.
void expect_all_windows(const ColumnBits& columns, const VoxelModel& model, int stride) {
  constexpr int kBorder = ColumnBits::kBorder;
  const Cell &lower = columns.lower(), &upper = columns.upper();
  for (int axis = 0; axis < 3; ++axis) {
    const int a_u = (axis + 1) % 3, a_v = (axis + 2) % 3;
    for (int v = lower[a_v] - kBorder; v < upper[a_v] + kBorder; v += 3) {
      for (int u = lower[a_u] - kBorder; u < upper[a_u] + kBorder; ++u) {
        for (int start = lower[axis] - ColumnBits::kBelow; start <= upper[axis]; start += stride) {
          ASSERT_EQ(columns.window(axis, u, v, start), window_by_voxel(model, axis, u, v, start))
              << "axis " << axis << " u " << u << " v " << v << " start " << start;
        }
      }
    }
    // The last corner of what may be asked.
    ASSERT_EQ(columns.window(axis, upper[a_u] + kBorder - 1, upper[a_v] + kBorder - 1, upper[axis]),
              0u);
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
  for (int start = -ColumnBits::kBelow; start <= 136; ++start) {
    EXPECT_EQ(columns.window(0, 4, 4, start), window_by_voxel(model, 0, 4, 4, start)) << start;
  }
}

TEST(ColumnBits, CoversTheLeavesOfTheSolidAndNoMore) {
  // Boxes that begin and end at every leaf of a word, so that each task's share of one is met.
  for (int first = 0; first < 6; ++first) {
    const Cell lower = Cell(3, 9, 2) + first * Cell(8, 8, 8), upper = lower + Cell(30, 14, 45);
    const VoxelModel model = test::block({128, 128, 128}, 1e-4, lower, upper);
    const ColumnBits columns(model);
    EXPECT_EQ(columns.lower(), Cell(lower / 8 * 8));
    EXPECT_EQ(columns.upper(), Cell((upper + Cell(7, 7, 7)) / 8 * 8));
    expect_all_windows(columns, model, 7);
    EXPECT_LT(columns.memory_bytes(), 250'000u) << "the whole grid takes 2.1 MB";
  }
}

TEST(ColumnBits, OfNothingIsEmpty) {
  const ColumnBits columns(test::make_model({64, 64, 64}, 1e-4, [](const Cell&) { return false; }));
  EXPECT_EQ(columns.lower(), columns.upper());
  EXPECT_EQ(columns.window(2, 0, 0, -ColumnBits::kBelow), 0u);
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
}  // namespace sulcus::column_bits_test
