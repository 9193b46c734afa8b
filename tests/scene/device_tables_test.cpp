#include <gtest/gtest.h>

#include "engine/scene/device_presets.hpp"
#include "engine/scene/table_readers.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus::device_tables_test {
namespace {

using test::error_of;
using test::least_scene;
using test::parse;

TEST(DeviceTables, ASceneHasWhatItNames) {
  const Scene none = parse(least_scene());
  EXPECT_FALSE(none.device);
  EXPECT_FALSE(none.coupling);
  const Scene both = parse(least_scene() + "[device]\nmodel = 'simulated'\n[coupling]\n");
  EXPECT_TRUE(both.device && both.coupling);
}

TEST(DeviceTables, APresetBringsItsValuesAndAKeyChangesOne) {
  const Scene scene = parse(least_scene() +
                            "[device]\nmodel = 'simulated'\npreset = 'falcon'\nhand = 'firm'\n"
                            "mass_g = 77\npush_N = 2\npush_direction = [0, 3, 4]\n");
  EXPECT_EQ(scene.device->force_limit_N, 8.0);
  EXPECT_DOUBLE_EQ(scene.device->mass_kg, 0.077);
  EXPECT_EQ(scene.device->hand.stiffness_N_per_m, 300.0);
  EXPECT_EQ(scene.device->hand.push_N, 2.0);
  EXPECT_TRUE(scene.device->hand.push_direction.isApprox(Eigen::Vector3d(0, 0.6, 0.8), 1e-15));
}

TEST(DeviceTables, ACouplingIsAsStiffAndAsStrongAsItsDeviceUnlessTold) {
  const std::string touch = least_scene() + "[device]\nmodel = 'simulated'\npreset = 'touch'\n";
  EXPECT_EQ(parse(touch + "[coupling]\n").coupling->stiffness_N_per_m, 400.0);
  EXPECT_EQ(parse(touch + "[coupling]\nstiffness_N_per_mm = 0.5\n").coupling->stiffness_N_per_m,
            500.0);
  EXPECT_EQ(parse(least_scene() + "[coupling]\nforce_limit_N = 2\n").coupling->force_limit_N, 2.0);
}

TEST(DeviceTables, FaultsOfTimeAreOfTheTicksThatTheyAreSaidOf) {
  const Scene scene = parse(least_scene() +
                            "[device]\nmodel = 'simulated'\nlate_s = [[0.5, 0.016]]\n"
                            "silent_s = [[1, 1.2]]\njump_s_mm = [[2, 0, 0, -50], [2.1, 0, 0, 50]]\n"
                            "[haptics]\nrate_hz = 500\n");
  ASSERT_EQ(scene.device->late.size(), 1u);
  EXPECT_EQ(scene.device->late[0].tick, 250u);
  EXPECT_EQ(scene.device->late[0].by_s, 0.016);
  EXPECT_EQ(scene.device->silences[0].first, 500u);
  EXPECT_EQ(scene.device->silences[0].last, 600u);
  ASSERT_EQ(scene.device->jumps.size(), 2u);
  EXPECT_EQ(scene.device->jumps[1].tick, 1050u);
  EXPECT_EQ(scene.device->jumps[0].by_m.z(), -50e-3);
}

TEST(DeviceTables, BehindACouplingTissuesAreTenTimesAsStiffUnlessTheySaySo) {
  const std::string tissues =
      "[[tissue]]\nname = 'enamel'\n[[tissue]]\nname = 'glass'\n"
      "[[tissue]]\nname = 'dentine'\nstiffness_N_per_mm = 7\n";
  const Scene alone = parse(least_scene() + tissues),
              coupled = parse(least_scene() + tissues + "[coupling]\n");
  EXPECT_EQ(alone.tissues[0].stiffness_N_per_m, 30e3);
  EXPECT_EQ(coupled.tissues[0].stiffness_N_per_m, 300e3);
  EXPECT_EQ(coupled.tissues[1].stiffness_N_per_m, 300e3);
  EXPECT_EQ(coupled.tissues[2].stiffness_N_per_m, 7e3);
  EXPECT_EQ(
      parse("tissue = ['dentine']\n" + least_scene() + "[coupling]\n").tissues[0].stiffness_N_per_m,
      250e3);
}

TEST(DeviceTables, APluginIsNamedAndHasLimitsButNoHand) {
  const Scene scene = parse(least_scene() +
                            "[device]\nplugin = 'my-arm_2'\nsettings = 'bus=3'\n"
                            "force_limit_N = 1.5\ntorque_limit_mNm = 40\n");
  ASSERT_TRUE(scene.device && scene.device->plugin);
  EXPECT_EQ(scene.device->plugin->name, "my-arm_2");
  EXPECT_EQ(scene.device->plugin->settings, "bus=3");
  EXPECT_EQ(scene.device->plugin->force_limit_N, 1.5);
  EXPECT_DOUBLE_EQ(scene.device->plugin->torque_limit_Nm.value(), 0.04);
  EXPECT_FALSE(scene.device->plugin->stiffness_N_per_m);
  EXPECT_EQ(scene.device->force_limit_N, 1.5);
  EXPECT_EQ(scene.device->stiffness_N_per_m, 700.0) << "until the plug-in says its own";
  EXPECT_FALSE(parse(least_scene() + "[device]\nmodel = 'simulated'\n").device->plugin);
  for (const char* path : {"a/b", "/tmp/a", "..", ".", "a.so", "", "a b", "\u00e4"}) {
    const std::string device = std::string("[device]\nplugin = '") + path + "'\n";
    EXPECT_NE(error_of(least_scene() + device).find("never a path"), std::string::npos) << path;
  }
  EXPECT_NE(error_of(least_scene() + "[device]\nplugin = 'a'\nhand = 'firm'\n").find("device.hand"),
            std::string::npos);
}

TEST(DeviceTables, RefusesWhatCannotBe) {
  EXPECT_NE(error_of(least_scene() + "[device]\n").find("expected \"simulated\""),
            std::string::npos);
  EXPECT_NE(error_of(least_scene() + "[device]\nmodel = 'simulated'\npreset = 'phantom'\n")
                .find("one of touch, omni, premium15, falcon"),
            std::string::npos);
  EXPECT_NE(error_of(least_scene() + "[device]\nmodel = 'simulated'\nlate_s = [[1, 2, 3]]\n")
                .find("expected [[time_s, by_s], ...]"),
            std::string::npos);
  EXPECT_NE(error_of(least_scene() + "[device]\nmodel = 'simulated'\nsilent_s = [[2, 1]]\n")
                .find("an end before its beginning"),
            std::string::npos);
  EXPECT_NE(error_of(least_scene() + "load_N = 1\n[coupling]\n").find("beside trajectory.load_N"),
            std::string::npos);
  EXPECT_NE(
      error_of(least_scene() + "[coupling]\nstifness_N_per_mm = 1\n").find("stiffness_N_per_mm"),
      std::string::npos);
}

}  // namespace
}  // namespace sulcus::device_tables_test
