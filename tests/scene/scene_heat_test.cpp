#include <string>

#include <gtest/gtest.h>

#include "tests/support/scene_text.hpp"

namespace sulcus::scene_heat_test {
namespace {

using test::error_of, test::least_scene, test::parse;

TEST(HeatOfAScene, ItIsInSiUnits) {
  EXPECT_FALSE(parse(least_scene() + "[cutting]\n").heat);
  const HeatSettings heat =
      *parse(least_scene() +
             "[cutting]\n[heat]\ncell_mm = 0.25\nstart_C = 36\ntooth_share = 0.5\nwater_ml_min = "
             "30\nwater_C = 10\nspray = 'mist'\nair_C = 20\ngum_mm = -1.5\n")
           .heat;
  EXPECT_DOUBLE_EQ(heat.cell_m, 0.25e-3);
  EXPECT_EQ(heat.start_C, 36.0);
  EXPECT_EQ(heat.tooth_share, 0.5);
  EXPECT_DOUBLE_EQ(heat.water_m3_per_s, 0.5e-6);
  EXPECT_EQ(heat.water_C, 10.0);
  EXPECT_EQ(heat.spray, Spray::kMist);
  EXPECT_EQ(heat.air_C, 20.0);
  EXPECT_DOUBLE_EQ(*heat.gum_m, -1.5e-3);
}

TEST(HeatOfAScene, WithoutWordsItIsDryAndInNoGum) {
  const HeatSettings heat = *parse(least_scene() + "[cutting]\n[heat]\n").heat;
  EXPECT_EQ(heat.water_m3_per_s, 0.0);
  EXPECT_EQ(heat.start_C, 37.0);
  EXPECT_FALSE(heat.gum_m);
  EXPECT_EQ(heat.cell_voxels(34.8e-6), 6);
  EXPECT_EQ(heat.cell_voxels(0.06e-3), 3);
  EXPECT_EQ(heat.cell_voxels(1e-3), 1);
}

TEST(HeatOfAScene, ItNeedsCutting) {
  EXPECT_NE(
      error_of(least_scene() + "[heat]\n").find("found [heat] without [cutting], expected both"),
      std::string::npos);
}

// 264^3 voxels of 0.1 mm in cells of one.
TEST(HeatOfAScene, ItsCellsAreCounted) {
  const std::string large =
      "[workpiece]\nshape = 'molar'\nvoxel_mm = 0.1\ncells = [264, 264, 264]\n[trajectory]\n"
      "points_mm = [[0, 0, 9]]\n[cutting]\n[heat]\n";
  EXPECT_NE(error_of(large + "cell_mm = 0.1\n")
                .find("heat.cell_mm: found 18399744 cells, expected larger ones: at most 16777216"),
            std::string::npos);
  EXPECT_EQ(error_of(large + "cell_mm = 0.2\n"), "no error");
}

}  // namespace
}  // namespace sulcus::scene_heat_test
