#include "app/window/view_keys.hpp"

#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "app/window/caliper.hpp"

namespace sulcus::view_keys_test {
namespace {

TEST(ViewKeys, NoKeyHasTwoUses) {
  std::set<char> keys;
  for (const ViewKey& key : view_keys()) {
    EXPECT_TRUE(keys.insert(key.key).second) << key.name;
    EXPECT_EQ(action_of(key.key, true).has_value(), key.in_recording);
    EXPECT_EQ(action_of(key.key, false).has_value(), key.in_scene);
    EXPECT_EQ(camera_of(key.key).has_value(), key.action == ViewAction::kCamera);
  }
  EXPECT_FALSE(action_of('?', true));
}

TEST(ViewKeys, CamerasStandOnTheSideThatTheyAreNamedBy) {
  const auto stands = [](char key, const Eigen::Vector3d& side) {
    return camera_of(key)->back_world.dot(side);
  };
  EXPECT_NEAR(stands('1', Eigen::Vector3d::UnitZ()), 1.0, 1e-12);   // the crown
  EXPECT_NEAR(stands('2', -Eigen::Vector3d::UnitY()), 1.0, 1e-12);  // buccal
  EXPECT_NEAR(stands('3', Eigen::Vector3d::UnitY()), 1.0, 1e-12);   // lingual
  EXPECT_NEAR(stands('4', Eigen::Vector3d::UnitX()), 1.0, 1e-12);   // mesial
  EXPECT_NEAR(stands('5', -Eigen::Vector3d::UnitX()), 1.0, 1e-12);  // distal
  EXPECT_TRUE(camera_of('6')->follows_burr);
}

TEST(ViewKeys, TheReadmeTellsThemAll) {
  std::ifstream file(std::string(SULCUS_SOURCE_DIR) + "/app/README.md");
  std::stringstream text;
  text << file.rdbuf();
  for (const ViewKey& key : view_keys()) {
    const std::string row = "| `" + std::string(key.name) + "` | " + std::string(key.what) + " |";
    EXPECT_NE(text.str().find(row), std::string::npos) << row;
  }
}

TEST(Caliper, MeasuresFromThePointBeforeAndThenBeginsAnew) {
  Caliper caliper;
  caliper.set({1e-3, 2e-3, 2e-3});
  EXPECT_FALSE(caliper.distance_m());
  caliper.set({4e-3, 6e-3, 2e-3});
  EXPECT_NEAR(caliper.distance_m().value(), 5e-3, 1e-12);
  caliper.set({0, 0, 0});
  EXPECT_FALSE(caliper.distance_m());
  caliper.set({0, 0, 2e-3});
  EXPECT_NEAR(caliper.distance_m().value(), 2e-3, 1e-12);
}

TEST(Caliper, APlaceIsWrittenAsScenesHaveIt) {
  EXPECT_EQ(place_text({-1.5e-3, 0.2501e-3, 7.6e-3}), "[-1.500, 0.250, 7.600]");
  EXPECT_EQ(place_text({-1e-9, 0.0, 0.0}), "[0.000, 0.000, 0.000]");
}

}  // namespace
}  // namespace sulcus::view_keys_test
