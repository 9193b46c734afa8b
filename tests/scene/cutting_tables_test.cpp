#include <string>

#include <gtest/gtest.h>

#include "engine/core/units.hpp"
#include "engine/scene/handpiece_presets.hpp"
#include "engine/scene/scene_file.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus::cutting_tables_test {
namespace {

using test::error_of, test::least_scene, test::parse;

// [cutting] and [spindle], and what they make of the burr.

const std::string kCutting = least_scene() + "[cutting]\n";

TEST(CuttingTables, TheLawSetsTheTangentialRatioThatABurrDoesNotSay) {
  EXPECT_EQ(parse(least_scene()).burr.tangential_ratio, 0.3);
  EXPECT_EQ(parse(kCutting).cutting->law, CuttingLaw::kPaper);
  EXPECT_EQ(parse(kCutting).burr.tangential_ratio, 0.3);
  const std::string saturating = kCutting + "law = 'saturating'\n";
  EXPECT_EQ(parse(saturating).cutting->law, CuttingLaw::kSaturating);
  EXPECT_EQ(parse(saturating).burr.tangential_ratio, 0.5);
  EXPECT_EQ(parse(saturating + "[burr]\ntangential_ratio = 0.45\n").burr.tangential_ratio, 0.45);
  EXPECT_NE(error_of(kCutting + "law = 'fast'\n").find("expected one of paper, saturating"),
            std::string::npos);
}

TEST(CuttingTables, ABurrSaysWhatItCutsWith) {
  const BurrSettings usual = parse(least_scene()).burr;
  EXPECT_EQ(usual.material, BurrMaterial::kDiamond);
  EXPECT_EQ(usual.grit, Grit::kMedium);
  EXPECT_EQ(usual.worn_m, 0.0);
  const BurrSettings worn =
      parse(least_scene() + "[burr]\nmaterial = 'diamond'\ngrit = 'super_coarse'\nworn_mm = 39\n")
          .burr;
  EXPECT_EQ(worn.grit, Grit::kSuperCoarse);
  EXPECT_DOUBLE_EQ(worn.worn_m, 39e-3);
  EXPECT_EQ(parse(least_scene() + "[burr]\nmaterial = 'carbide'\n").burr.material,
            BurrMaterial::kCarbide);
}

TEST(CuttingTables, AHandpieceSetsTheSpindleAndItsSpeed) {
  for (const HandpiecePreset& preset : handpiece_presets()) {
    const std::string text = kCutting + "[spindle]\npreset = '" + std::string(preset.name) + "'\n";
    const Scene s = parse(text);
    EXPECT_EQ(s.burr.speed_rad_per_s, preset.free_rad_per_s);
    EXPECT_EQ(s.spindle->stall_torque_Nm, preset.spindle.stall_torque_Nm);
    EXPECT_EQ(s.spindle->inertia_kg_m2, preset.spindle.inertia_kg_m2);
    EXPECT_EQ(s.spindle->droop, preset.spindle.droop);
    EXPECT_EQ(s.spindle->power_W, preset.spindle.power_W);
    const Scene own = parse(text +
                            "stall_torque_mNm = 3\ninertia_g_mm2 = 7\ndroop = 0.5\npower_W = 30\n"
                            "[burr]\nspeed_rpm = 100000\n");
    EXPECT_DOUBLE_EQ(own.spindle->stall_torque_Nm, 3e-3);
    EXPECT_DOUBLE_EQ(own.spindle->inertia_kg_m2, 7e-9);
    EXPECT_EQ(own.spindle->droop, 0.5);
    EXPECT_EQ(own.spindle->power_W, 30.0);
    EXPECT_DOUBLE_EQ(own.burr.speed_rad_per_s, 100000 * kRevolutionPerMinute);
  }
  const Scene plain = parse(kCutting + "[spindle]\n");
  EXPECT_EQ(plain.burr.speed_rad_per_s, BurrSettings{}.speed_rad_per_s);
  EXPECT_EQ(plain.spindle->stall_torque_Nm, 1e-3);
  EXPECT_EQ(plain.spindle->inertia_kg_m2, 5e-9);
  EXPECT_EQ(plain.spindle->droop, 1.0);
  EXPECT_FALSE(plain.spindle->power_W);
  EXPECT_NE(error_of(kCutting + "[spindle]\npreset = 'drill'\n")
                .find("expected one of turbine, electric"),
            std::string::npos);
}

}  // namespace
}  // namespace sulcus::cutting_tables_test
