#include "haptics/simulation_state.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "haptics/saved_state.hpp"
#include "haptics/state_fields.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::simulation_state_test {
namespace {

Workpiece full_block() {
  return Workpiece(test::make_model({8, 8, 8}, 1e-4, [](const Cell&) { return true; }));
}

SimulationState make_state() {
  Scene scene;
  scene.haptics.keep_normals = false;
  scene.cutting.emplace().max_cut_voxels = 100;
  scene.bodies.emplace_back().cuttable = true;
  SimulationState state = initial_state(scene, {full_block(), full_block()});
  state.tick = 12;
  state.has_pose = true;
  state.tool.position = Eigen::Vector3d(1e-3, 2e-3, 3e-3);
  RemovalState& removal = *state.workpiece().removal;
  removal.part_cut.set_energy(7, 1e-4);
  removal.heat_J = 2e-4;
  removal.work_J = 3e-4;
  removal.removed_J = 4e-4;
  state.spindle_rad_per_s = 5.0;
  state.load_offset_m = 6e-4;
  return state;
}

// Each field of each part of a state by name: what is added to one does not compile until it has a
// place here. Tables that are looked at apart are named and passed over.

template <class F, class T>
requires std::is_arithmetic_v<T>
void walk(const F& f, T& number) { f(number); }
template <class F>
void walk(const F& f, Eigen::Vector3d& v) {
  for (double& x : v) f(x);
}
template <class F>
void walk(const F& f, Eigen::Quaterniond& q) {
  for (double& x : q.coeffs()) f(x);
}
template <class F>
void walk(const F& f, TissueEnergy& energy) {
  auto& [work, removed, heat, carried] = energy;
  for (double* energy_J : {&work, &removed, &heat, &carried}) f(*energy_J);
}
template <class F, class T, std::size_t n>
void walk(const F& f, std::array<T, n>& values) {
  for (T& value : values) walk(f, value);
}
template <class F, class... T>
void walk_all(const F& f, T&... parts) {
  (walk(f, parts), ...);
}
template <class F>
void walk(const F& f, Pose& pose) {
  auto& [position, orientation] = pose;
  walk_all(f, position, orientation);
}
template <class F>
void walk(const F& f, Wrench& wrench) {
  auto& [force, torque] = wrench;
  walk_all(f, force, torque);
}
template <class F>
void walk(const F& f, Twist& twist) {
  auto& [linear, angular, spindle] = twist;
  walk_all(f, linear, angular, spindle);
}
template <class F>
void walk(const F& f, PassivityState::Held& held) {
  auto& [wrench, damping, changed] = held;
  walk_all(f, wrench, damping, changed);
}
template <class F>
void walk(const F& f, PassivityState::Trend& trend) {
  auto& [direction, drive, stiffness, stiffest, has_stiffness, step, length] = trend;
  walk_all(f, direction, drive, stiffness, stiffest, has_stiffness, step, length);
}
template <class F>
void walk(const F& f, PassivityState& passivity) {
  auto& [has_reference, reference, moved, energy, least, contact, trend, credit, outputs, sent,
         held, given_before, dissipated, damped_ticks] = passivity;
  walk_all(f, has_reference, reference, moved, energy, least, contact, trend, credit, outputs, sent,
           held, given_before, dissipated, damped_ticks);
}
template <class F>
void walk(const F& f, BuzzState& buzz) {
  auto& [started, turn, furthest, tick, seen, swings, seen_ticks] = buzz;
  walk_all(f, started, turn, furthest, tick, seen, swings, seen_ticks);
}
template <class F>
void walk(const F& f, OutputLimiterState& edge) {
  auto& [sent, ramp, not_finite, clamped, ramped, step_limited] = edge;
  walk_all(f, sent, ramp, not_finite, clamped, ramped, step_limited);
}
template <class F>
void walk(const F& f, DevicePortState& port) {
  auto& [has_pose, pose, silent_ticks, edge, passivity, buzz] = port;
  walk_all(f, has_pose, pose, silent_ticks, edge, passivity, buzz);
}
template <class F>
void walk(const F& f, RemovalState& removal) {
  auto& [part_cut, carried, heat, work, removed, removed_voxels, by_tissue] = removal;
  walk_all(f, carried, heat, work, removed, removed_voxels, by_tissue);
}
template <class F>
void walk(const F& f, SimulationState& state) {
  // Every tick reads the pedal anew.
  auto& [tick, has_pose, tool, port, spindle, pedal, load, bodies] = state;
  walk_all(f, tick, has_pose, tool, port, *spindle, *load);
  for (Body& body : bodies) {
    // Where it is and which tissues it has are the scene's, and do not change.
    auto& [world_from_grid, first_tissue, solid, kept, removal, bounds, solid_bounds, touched_ticks,
           peak_force] = body;
    walk(f, *removal);
    if (&body != &bodies.front()) walk_all(f, touched_ticks, peak_force);
  }
}

std::vector<std::byte> saved(const SimulationState& state) {
  std::vector<std::byte> bytes;
  save_state(state, bytes);
  return bytes;
}

/// A state of which the field of that number, from 0, is another.
SimulationState changed(std::size_t which) {
  SimulationState state = make_state();
  std::size_t at = 0;
  walk(
      [&](auto& number) {
        if (at++ != which) return;
        if constexpr (std::is_same_v<std::remove_reference_t<decltype(number)>, bool>) {
          number = !number;
        } else {
          number += 1;
        }
      },
      state);
  return state;
}

/// An archive that counts.
struct FieldCount {
  static constexpr bool kReads = false;
  std::size_t count = 0;
  template <class T>
  void operator()(const T&) {
    ++count;
  }
  template <class T>
  void since(std::uint32_t, const T&) {
    ++count;
  }
};

TEST(SimulationState, TheListsHaveEveryField) {
  SimulationState state = make_state();
  // Energies are listed up to the last tissue that has any.
  for (Body& body : state.bodies) body.removal->by_tissue.back().heat_J = 1.0;
  std::size_t walked = 0;
  walk([&](auto&) { ++walked; }, state);
  FieldCount listed;
  fields::head(listed, state);
  for (Body& body : state.bodies) fields::removal(listed, *body.removal);
  for (const Body& body : state.others()) fields::damage(listed, body);
  EXPECT_EQ(listed.count, walked + 2 + state.bodies.size())
      << "and whether there are a spindle and a load, and how many tissues";
}

TEST(SimulationState, EqualStatesHashEqual) { EXPECT_EQ(make_state().hash(), make_state().hash()); }

TEST(SimulationState, EveryFieldIsHashedAndSavedAndComesBack) {
  std::size_t fields = 0;
  SimulationState counted = make_state();
  walk([&](auto&) { ++fields; }, counted);
  ASSERT_GT(fields, 2600u);  // 2560 of them are of tissues
  const std::uint64_t plain = make_state().hash();
  const std::vector<std::byte> plain_bytes = saved(make_state());
  for (std::size_t which = 0; which < fields; ++which) {
    SCOPED_TRACE(which);
    const SimulationState state = changed(which);
    EXPECT_NE(state.hash(), plain);
    EXPECT_NE(saved(state), plain_bytes);
    SimulationState back = make_state();
    ASSERT_TRUE(load_state(saved(state), back));
    EXPECT_EQ(back.hash(), state.hash());
  }
}

TEST(SimulationState, PartCutVoxelsAreHashedAndSaved) {
  for (const std::uint32_t voxel : {7u, 8u}) {
    for (const std::size_t body : {0u, 1u}) {
      SimulationState state = make_state();
      state.bodies[body].removal->part_cut.set_energy(voxel, 2e-4);
      EXPECT_NE(state.hash(), make_state().hash()) << voxel;
      EXPECT_NE(saved(state), saved(make_state())) << voxel;
    }
  }
}

TEST(SimulationState, WithoutCuttingThereIsNoRemovalState) {
  EXPECT_FALSE(initial_state(Scene(), {full_block()}).workpiece().removal);
}

}  // namespace
}  // namespace sulcus::simulation_state_test
