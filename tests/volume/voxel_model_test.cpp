#include "engine/volume/voxel_model.hpp"

#include <set>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::voxel_model_test {
namespace {

TEST(VoxelModel, SetChangesOneVoxelOnly) {
  VoxelModel model = test::make_model({8, 24, 16}, 1e-4, [](const Cell&) { return false; });
  std::set<std::uint32_t> on;
  for (std::uint32_t v = 0; v < model.grid.cell_count(); v += 37) {
    model.set(model.grid.cell_of_linear(v), true);
    on.insert(v);
  }
  model.set(model.grid.cell_of_linear(37), false);
  on.erase(37);
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    ASSERT_EQ(model.solid(model.grid.cell_of_linear(v)), on.contains(v)) << v;
  }
  EXPECT_EQ(model.solid_count(), on.size());
}

TEST(VoxelModel, NothingIsSolidBeyondTheGrid) {
  const VoxelModel model = test::make_model({8, 8, 8}, 1e-4, [](const Cell&) { return true; });
  EXPECT_EQ(model.solid_count(), 512u);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_FALSE(model.solid(-Cell::Unit(axis)));
    EXPECT_FALSE(model.solid(8 * Cell::Unit(axis)));
  }
}

TEST(VoxelModel, WithoutAMapEverythingIsTheFirstTissue) {
  VoxelModel model = test::make_model({8, 16, 8}, 1e-4, [](const Cell&) { return true; });
  EXPECT_EQ(model.tissue({3, 12, 3}), 0);
  auto tissues = std::make_shared<TissueMap>(2);
  tissues->set_uniform(1, 5);
  model.tissues = tissues;
  EXPECT_EQ(model.tissue({3, 12, 3}), 5);
  EXPECT_EQ(model.tissue({3, 4, 3}), 0);
}

}  // namespace
}  // namespace sulcus::voxel_model_test
