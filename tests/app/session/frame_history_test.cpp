#include "app/session/frame_history.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "engine/core/units.hpp"
#include "tests/outcome/labelled_model.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::frame_history_test {
namespace {

Scene cutting_scene() {
  Scene scene;
  for (const char* name : {"dentine", "pulp", "caries"}) {
    TissueSettings tissue;
    tissue.name = name;
    scene.tissues.push_back(tissue);
  }
  scene.workpiece.voxel_m = 1e-4;
  scene.cutting.emplace();
  return scene;
}

/// Pulp below, caries above, dentine between.
VoxelModel layers() {
  return test::labelled(test::block({16, 16, 16}, 1e-4, {0, 0, 0}, {16, 16, 16}),
                        [](const Cell& c) {
                          return static_cast<std::uint8_t>(c.z() < 4 ? 1 : c.z() < 12 ? 0 : 2);
                        });
}

/// Of UTF-8, whose further bytes of a letter begin with 10.
std::ptrdiff_t letters(const std::string& text) {
  return std::ranges::count_if(text, [](char byte) { return (byte & 0xc0) != 0x80; });
}

std::string line(const FrameHistory& history, const std::string& name) {
  // What a row of the panel has room for, a space between the two.
  constexpr std::ptrdiff_t kRow = 27;
  std::string value = "none";
  for (const OutcomeLine& outcome : history.state().outcome) {
    EXPECT_LT(letters(outcome.name) + letters(outcome.value), kRow) << outcome.name;
    if (outcome.name == name) value = outcome.value;
  }
  return value;
}

TEST(FrameHistory, TellsWhatThePreparationHasComeTo) {
  const VoxelModel start = layers();
  FrameHistory history(cutting_scene(), start);
  EXPECT_EQ(line(history, "Caries left"), "1.024 mm\xC2\xB3");
  EXPECT_EQ(line(history, "Pulp"), "not exposed");
  history.add(Edit{100, start.grid.linear({5, 5, 15}), 0, EditCause::kCut});
  EXPECT_EQ(line(history, "Caries left"), "1.023 mm\xC2\xB3");
  EXPECT_EQ(line(history, "  caries"), "0.001 mm\xC2\xB3");
  EXPECT_EQ(line(history, "  dentine"), "none");
  history.add(Edit{2500, start.grid.linear({5, 5, 4}), 0, EditCause::kCut});
  EXPECT_EQ(line(history, "Pulp"), "exposed at 2.5 s");
}

TEST(FrameHistory, TellsOfWhatIsOnlyLessFilled) {
  VoxelModel start = layers();
  start.fills.emplace(start.grid.leaf_count(), std::vector<LeafLevels>{});
  FrameHistory history(cutting_scene(), start);
  for (int x = 0; x < 10; ++x) {  // 51 of 255
    history.add(Edit{100, start.grid.linear({x, 5, 15}), 0, EditCause::kCut, 204});
  }
  history.add(Edit{100, start.grid.linear({5, 5, 4}), 0, EditCause::kCut, 1});
  EXPECT_EQ(line(history, "  caries"), "0.002 mm\xC2\xB3");
  EXPECT_NEAR(history.state().removed_mm3, 1e-3 * (2.0 + 254.0 / 255), 1e-12);
  EXPECT_EQ(line(history, "Pulp"), "not exposed");
}

TEST(FrameHistory, TellsHowMuchToothIsLeftOverThePulpAndWarnsOnce) {
  Scene scene = cutting_scene();
  scene.least_pulp_distance_m = 3.5e-4;
  const VoxelModel start = layers();
  FrameHistory history(scene, start);
  TickRecord record;
  const auto cut = [&](int z, std::uint64_t tick) {
    history.add(Edit{tick, start.grid.linear({5, 5, z}), 0, EditCause::kCut});
    history.add(record, nullptr);
  };
  history.add(record, nullptr);
  EXPECT_EQ(line(history, "Tooth over it"), "none");
  EXPECT_TRUE(std::isnan(history.state().pulp_history_mm.back()));
  cut(9, 1000);
  EXPECT_EQ(line(history, "Tooth over it"), "0.50 mm");
  EXPECT_FLOAT_EQ(history.state().pulp_history_mm.back(), 0.5f);
  EXPECT_EQ(line(history, "Near the pulp"), "none");
  cut(7, 2500);
  cut(6, 3000);
  EXPECT_EQ(line(history, "Tooth over it"), "0.20 mm");
  EXPECT_EQ(line(history, "Near the pulp"), "since 2.5 s");
  cut(4, 3500);
  EXPECT_EQ(line(history, "Tooth over it"), "none") << "it is exposed";
  EXPECT_EQ(history.state().pulp_history_mm.back(), 0.0f);
  EXPECT_EQ(history.state().pulp_history_mm.size(), 5u);
}

TEST(FrameHistory, TellsTheSpeedOfASpindleAsItSags) {
  Scene scene = cutting_scene();
  scene.burr.speed_rad_per_s = 300'000 * kRevolutionPerMinute;
  CuttingRecord cutting;
  cutting.spindle_rad_per_s = 240'000 * kRevolutionPerMinute;
  FrameHistory held(scene, layers());
  held.add(TickRecord{}, &cutting);
  EXPECT_EQ(line(held, "Spindle"), "none");
  EXPECT_TRUE(held.state().spindle_history_krpm.empty());
  scene.spindle.emplace();
  FrameHistory history(scene, layers());
  for (int tick = 0; tick < 5000; ++tick) history.add(TickRecord{}, &cutting);
  EXPECT_EQ(line(history, "Spindle"), "240000 rpm, -20 %");
  EXPECT_EQ(history.state().spindle_history_krpm.size(), 2000u);
  EXPECT_FLOAT_EQ(history.state().spindle_history_krpm.back(), 240.0f);
}

TEST(FrameHistory, TellsTheForceWhileInContact) {
  FrameHistory history(cutting_scene(), layers());
  TickRecord record;
  record.force_N[0] = 9.0;  // with no contact: not counted
  history.add(record, nullptr);
  EXPECT_EQ(line(history, "Contact time"), "none");
  for (int i = 0; i < 200; ++i) {
    record.contacts = 5;
    record.force_N[0] = i < 100 ? 1.0 : 2.0;
    history.add(record, nullptr);
  }
  EXPECT_EQ(line(history, "Peak force"), "2.00 N");
  EXPECT_EQ(line(history, "Mean force"), "1.50 N");
  EXPECT_EQ(line(history, "Contact time"), "0.2 s");
}

TEST(FrameHistory, TellsTheDamageToOtherBodiesOnceThereIsAny) {
  Scene scene = cutting_scene();
  for (const char* name : {"mesial",
                           "a\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4"
                           "\xC3\xA4\xC3\xA4\xC3\xA4"}) {
    scene.bodies.emplace_back().name = name;
    scene.bodies.back().solid.voxel_m = 2e-4;
  }
  FrameHistory history(scene, layers());
  EXPECT_EQ(line(history, "mesial"), "none");
  for (std::uint32_t voxel = 0; voxel < 5; ++voxel) {
    history.add(Edit{9, voxel, 1, EditCause::kCut});
    history.add(Edit{9, voxel, 2, EditCause::kCut});
  }
  EXPECT_EQ(line(history, "mesial"), "0.040 mm\xC2\xB3");
  // Nineteen bytes are too many; the eighth letter of two would be cut in half.
  EXPECT_EQ(line(history, "a\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4.."),
            "0.040 mm\xC2\xB3");
  EXPECT_EQ(line(history, "Caries left"), "1.024 mm\xC2\xB3") << "none of the workpiece's";
}

}  // namespace
}  // namespace sulcus::frame_history_test
