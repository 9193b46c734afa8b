#include "haptics/simulation_state.hpp"

#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus {
namespace {

SimulationState make_state() {
  SimulationState state;
  state.tick = 12;
  state.has_pose = true;
  state.tool.position = Eigen::Vector3d(1e-3, 2e-3, 3e-3);
  state.removal.emplace(CuttingSettings{100});
  state.removal->part_cut.set_energy(7, 1e-4);
  state.removal->pool_J = 2e-4;
  state.removal->work_J = 3e-4;
  state.removal->removed_J = 4e-4;
  return state;
}

TEST(SimulationState, EqualStatesHashEqual) {
  EXPECT_EQ(make_state().hash(), make_state().hash());
  EXPECT_EQ(SimulationState().hash(), SimulationState().hash());
}

TEST(SimulationState, EverythingThatMattersLaterIsHashed) {
  const std::vector<std::function<void(SimulationState&)>> changes{
      [](auto& s) { ++s.tick; },
      [](auto& s) { s.has_pose = false; },
      [](auto& s) { s.tool.position.z() += 1e-12; },
      [](auto& s) { s.tool.orientation = Eigen::Quaterniond(0, 1, 0, 0); },
      [](auto& s) { s.removal->part_cut.set_energy(7, 2e-4); },
      [](auto& s) { s.removal->part_cut.set_energy(8, 1e-4); },
      [](auto& s) { s.removal->pool_J = 0.0; },
      [](auto& s) { s.removal->work_J = 0.0; },
      [](auto& s) { s.removal->removed_J = 0.0; },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    SimulationState state = make_state();
    changes[i](state);
    EXPECT_NE(state.hash(), make_state().hash()) << "change " << i;
  }
}

TEST(SimulationState, WithoutCuttingThereIsNoRemovalState) {
  EXPECT_FALSE(SimulationState().removal);
}

}  // namespace
}  // namespace sulcus
