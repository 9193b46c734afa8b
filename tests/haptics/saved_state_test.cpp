#include "haptics/saved_state.hpp"

#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "haptics/device/simulated_device.hpp"
#include "haptics/state_fields.hpp"
#include "haptics/tick.hpp"
#include "tests/haptics/tick_run.hpp"
#include "tests/support/scene_text.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::saved_state_test {
namespace {

constexpr double kVoxel = 50e-6;

/// All that a state can hold, but for the load, which needs a scripted tool. Soft, so that voxels
/// go within a few ticks; few normals are cached, so that old leaves give way.
const std::string kAll = R"(
[workpiece]
shape = 'box'
voxel_mm = 0.05
cells = [64, 64, 64]
[[tissue]]
name = 'soft'
stiffness_N_per_mm = 300
specific_energy_J_per_mm3 = 10
[burr]
diameter_mm = 0.8
speed_rpm = 100000
field = [32, 64, 32]
[spindle]
[haptics]
normals = 'ldm'
max_contacts = 1024
[trajectory]
points_mm = [[-0.8, 0, 0.5], [0.8, 0.2, -2.0]]
speed_mm_per_s = 10
[device]
model = 'simulated'
preset = 'omni'
hand = 'firm'
push_N = 1
passivity_controller = true
[coupling]
[cutting]
[[body]]
name = 'other'
shape = 'box'
cuttable = true
)";

/// A scene in the middle of being run. The device is no part of the state: a recording has its
/// poses.
struct TickedRun {
  explicit TickedRun(const std::string& text = kAll)
      : scene(test::parse(text)),
        burr(make_burr(scene.burr, kVoxel)),
        state(initial_state(
            scene, {Workpiece(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {64, 64, 32})),
                    Workpiece(test::block({64, 64, 64}, kVoxel, {24, 0, 24}, {40, 64, 36}))})),
        scratch(scene),
        context{scene, burr} {}
  const Workpiece& workpiece() const { return state.workpiece().solid; }
  TickResult step(Device& device) {
    const TickResult record = tick(context, device, state, scratch);
    edits.insert(edits.end(), scratch.edits.begin(), scratch.edits.end());
    return record;
  }
  /// Brings the bodies' voxels to where another run's are.
  void cut_as(const TickedRun& other) {
    for (const Edit& edit : other.edits) {
      Workpiece& body = state.bodies[edit.body].solid;
      body.remove(body.grid().cell_of_linear(edit.voxel));
    }
  }
  std::vector<std::byte> saved() const {
    std::vector<std::byte> bytes;
    save_state(state, bytes);
    return bytes;
  }

  Scene scene;
  Burr burr;
  SimulationState state;
  TickScratch scratch;
  TickContext context;
  std::vector<Edit> edits;
};

/// Of an archive that counts.
struct ByteCount {
  static constexpr bool kReads = false;
  std::size_t bytes = 0;
  template <class T>
  void operator()(const T&) {
    bytes += sizeof(T);
  }
  template <class T>
  void since(std::uint32_t, const T&) {
    bytes += sizeof(T);
  }
};

class SavedState : public ::testing::Test {
 protected:
  static constexpr int kFirst = 600, kLast = 1500;

  SavedState()
      : trajectory_(make_trajectory(run_.scene.trajectory)),
        device_(*run_.scene.device, trajectory_, 1000.0, run_.scene.burr.reference_m) {
    while (ticks_ < kFirst || (!all_is_in_play() && ticks_ < kLast)) {
      run_.step(device_);
      ++ticks_;
    }
  }
  bool all_is_in_play() const {
    return run_.state.workpiece().removal->part_cut.size() > 50 &&
           run_.state.bodies[1].removal->part_cut.size() > 20 && run_.edits.size() > 20 &&
           *run_.state.spindle_rad_per_s < run_.scene.burr.speed_rad_per_s;
  }
  /// Of the device's port in a saved state.
  static std::size_t port_bytes() {
    ByteCount count;
    const DevicePortState port;
    fields::port(count, port);
    return count.bytes;
  }
  /// Where the fields of body `i`'s removal begin in a saved state, after its part-cut voxels.
  std::size_t end_of_part_cut(std::size_t i) const {
    ByteCount head;
    fields::head(head, run_.state);
    std::size_t at = 4 + head.bytes;
    for (std::size_t b = 0;; ++b) {
      at += 1 + 4 + 12 * run_.state.bodies[b].removal->part_cut.size();
      if (b == i) return at;
      at += removal_bytes(b);
      at += b == 0 ? 4 : 16;
    }
  }
  std::size_t removal_bytes(std::size_t b) const {
    ByteCount count;
    fields::removal(count, *run_.state.bodies[b].removal);
    return count.bytes;
  }
  std::size_t tissue_bytes(std::size_t b) const {
    ByteCount count;
    fields::tissues(count, run_.state.bodies[b].removal->by_tissue);
    return count.bytes;
  }
  /// As it was written before the third layout: without energies of each tissue, the last of a
  /// removal's, but behind it the cached normals' leaves; with another reference of the passivity
  /// controller's and without what it goes by now, the last of the port's. In the first layout
  /// without the count of silent ticks before that.
  std::vector<std::byte> of_layout(int layout) {
    PassivityState& passivity = run_.state.port.passivity;
    passivity.trend = {};
    passivity.credit_J = 0.0;
    std::vector<std::byte> old = run_.saved();
    const auto at = [&](std::size_t place) {
      return old.begin() + static_cast<std::ptrdiff_t>(place);
    };
    const auto erase = [&](std::size_t end, std::size_t bytes) {
      old.erase(at(end - bytes), at(end));
    };
    for (const std::size_t b : {1u, 0u}) {
      const std::size_t end = end_of_part_cut(b) + removal_bytes(b);
      std::vector<std::byte> cache(1 + 4 + 2 * (4 + 8 + 64), std::byte{7});
      cache[0] = std::byte{1};
      constexpr std::uint32_t kLeaves = 2;
      std::memcpy(&cache[1], &kLeaves, sizeof kLeaves);
      old.insert(at(end), cache.begin(), cache.end());
      erase(end, tissue_bytes(b));
    }
    constexpr std::size_t kTrend = 11 * 8 + 1;
    const std::size_t end_of_port = 4 + 8 + 1 + 7 * 8 + port_bytes();
    erase(end_of_port, kTrend);
    if (layout == 1) erase(end_of_port - kTrend, 8);
    // Behind the pose, the limiter, and of the passivity a pose, a motion and two energies.
    constexpr std::size_t kBefore =
        4 + 8 + 1 + 7 * 8 + (7 * 8 + 1) + (7 * 8 + 4 * 8) + (1 + 16 * 8);
    const double reference_J = 7.0;
    const auto* reference = reinterpret_cast<const std::byte*>(&reference_J);
    old.insert(at(kBefore), reference, reference + sizeof reference_J);
    old[0] = static_cast<std::byte>(layout);
    return old;
  }
  std::unique_ptr<TickedRun> loaded() const {
    auto again = std::make_unique<TickedRun>();
    again->cut_as(run_);
    EXPECT_TRUE(load_state(run_.saved(), again->state));
    return again;
  }

  const TickedRun uncut_;
  TickedRun run_;
  Trajectory trajectory_;
  SimulatedDevice device_;
  int ticks_ = 0;
};

TEST_F(SavedState, ARunGoesOnFromItToTheBit) {
  ASSERT_TRUE(all_is_in_play()) << "in " << ticks_ << " ticks";

  const std::unique_ptr<TickedRun> again = loaded();
  EXPECT_EQ(again->state.hash(), run_.state.hash());
  for (int t = 0; t < 300; ++t) {
    const TickResult expected = run_.step(device_);
    struct Same final : Device {
      Pose at;
      std::optional<Pose> pose(std::uint64_t) noexcept override { return at; }
      void apply(const Wrench&) noexcept override {}
    } same;
    same.at = expected.device;
    const TickResult record = again->step(same);
    ASSERT_TRUE(test::same(record, expected)) << t;
    ASSERT_EQ(again->state.hash(), run_.state.hash()) << t;
  }
  EXPECT_EQ(again->workpiece().hash(), run_.workpiece().hash());
}

TEST_F(SavedState, WhateverOfItChangesTheHashChanges) {
  // Byte by byte: what is saved is what is hashed.
  const std::unique_ptr<TickedRun> again = loaded();
  std::vector<std::byte> plain;
  save_state(again->state, plain);
  const std::uint64_t hash = again->state.hash();
  std::size_t changed = 0;
  const std::size_t numbers = plain.size();
  ASSERT_GT(numbers, 3000u);
  for (std::size_t at = 4; at < numbers; at += at < 3000 ? 1 : 97) {
    std::vector<std::byte> other = plain;
    other[at] ^= std::byte{1};
    std::vector<std::byte> back;
    if (!load_state(other, again->state)) continue;
    save_state(again->state, back);
    if (back == plain) continue;  // any byte but 0 is true
    EXPECT_NE(again->state.hash(), hash) << "byte " << at << " of " << numbers;
    ++changed;
  }
  EXPECT_GT(changed, 1000u);
}

TEST_F(SavedState, AStateOfTheFirstLayoutIsReadAsOneOfADeviceThatAnswers) {
  TickedRun again;
  again.cut_as(run_);
  const std::vector<std::byte> old = of_layout(1);
  ASSERT_TRUE(load_state(old, again.state));
  again.state.bodies[0].removal->by_tissue = run_.state.bodies[0].removal->by_tissue;
  again.state.bodies[1].removal->by_tissue = run_.state.bodies[1].removal->by_tissue;
  EXPECT_EQ(again.state.hash(), run_.state.hash());
}

TEST_F(SavedState, WhatWaitedToBeSpentInTheSecondLayoutIsHeat) {
  constexpr double kWaiting_J = 1.25e-3;
  std::vector<std::byte> old = of_layout(2);
  // In the second layout the port is shorter by what the controller goes by, and a number longer.
  constexpr std::size_t kShorter = 11 * 8 + 1 - 8;
  std::memcpy(old.data() + end_of_part_cut(0) - kShorter + sizeof(double), &kWaiting_J,
              sizeof kWaiting_J);
  TickedRun again;
  again.cut_as(run_);
  ASSERT_TRUE(load_state(old, again.state));
  const RemovalState& before = *run_.state.workpiece().removal;
  const RemovalState& removal = *again.state.workpiece().removal;
  EXPECT_EQ(removal.heat_J, kWaiting_J);
  EXPECT_EQ(removal.work_J, before.work_J);
  EXPECT_EQ(removal.stored_J(), before.stored_J());
  const double stored_J = before.stored_J();

  // From there on every tissue's energies add up: to begin with it has what its voxels had stored.
  run_.state = std::move(again.state);
  const std::size_t cut = run_.edits.size();
  for (int t = 0; t < 300; ++t) run_.step(device_);
  EXPECT_GT(run_.edits.size(), cut);
  const RemovalState& after = *run_.state.workpiece().removal;
  const TissueEnergy& energy = after.by_tissue[0];
  EXPECT_GT(energy.work_J, stored_J);
  EXPECT_NEAR(energy.removed_J + energy.heat_J + after.stored_by_tissue_J(run_.workpiece())[0],
              energy.work_J, 1e-9 * energy.work_J);
}

TEST_F(SavedState, WhatWasSavedTwiceIsTheSame) { EXPECT_EQ(loaded()->saved(), run_.saved()); }

TEST_F(SavedState, WhatItHeldBeforeIsGone) {
  TickedRun other;
  SimulatedDevice device(*other.scene.device, trajectory_, 1000.0, other.scene.burr.reference_m);
  for (int t = 0; t < ticks_ + 50; ++t) other.step(device);
  TickedRun fresh;
  ASSERT_TRUE(load_state(fresh.saved(), other.state));
  EXPECT_EQ(other.state.workpiece().removal->part_cut.size(), 0u);
  EXPECT_TRUE(other.state.workpiece().normal_cache->pages().empty());
}

TEST_F(SavedState, WhatASceneDoesNotNameIsPassedOver) {
  std::string text = kAll;
  for (const std::string part :
       {"[spindle]\n", "[cutting]\n", "[coupling]\n", "cuttable = true\n"}) {
    text.erase(text.find(part), part.size());
  }
  TickedRun less(text);
  less.cut_as(run_);
  ASSERT_TRUE(load_state(run_.saved(), less.state));
  EXPECT_EQ(less.state.tick, run_.state.tick);
  EXPECT_FALSE(less.state.workpiece().removal);
  TickedRun more;
  more.cut_as(run_);
  ASSERT_TRUE(load_state(less.saved(), more.state));
  EXPECT_EQ(more.state.workpiece().removal->part_cut.size(), 0u);
}

TEST_F(SavedState, WhatIsNoStateIsRefused) {
  const std::vector<std::byte> bytes = run_.saved();
  const auto loads = [&](std::span<const std::byte> some) {
    TickedRun again;
    again.cut_as(run_);
    return load_state(some, again.state);
  };
  EXPECT_TRUE(loads(bytes));
  EXPECT_FALSE(loads({}));
  for (std::size_t part = 1; part < 40; ++part) {
    EXPECT_FALSE(loads(std::span(bytes).first(bytes.size() * part / 40))) << part;
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back({});
  EXPECT_FALSE(loads(longer));
  // Another workpiece: what was cut at does not stand.
  TickedRun empty;
  for (Body& body : empty.state.bodies) {
    for (const Cell& c : test::surface_cells(body.solid)) body.solid.remove(c);
  }
  EXPECT_FALSE(load_state(bytes, empty.state));
  // Flipped bits may be a state: nothing is reached through it that is not there.
  for (std::size_t at = 0; at < bytes.size(); at += bytes.size() / 40) {
    std::vector<std::byte> flipped = bytes;
    flipped[at] ^= std::byte{0x90};
    TickedRun again;
    again.cut_as(run_);
    if (!load_state(flipped, again.state)) continue;
    EXPECT_LT(again.step(device_).contact.contacts, 100000u);
  }
}

TEST(SavedStateOfALoad, KeepsHowFarItHasCome) {
  Scene scene;
  scene.trajectory.load_N = 1.0;
  const Workpiece block(test::block({8, 8, 8}, kVoxel, {0, 0, 0}, {8, 8, 8}));
  SimulationState state = initial_state(scene, {block}), again = initial_state(scene, {block});
  state.load_offset_m = 1.25e-3;
  std::vector<std::byte> bytes;
  save_state(state, bytes);
  ASSERT_TRUE(load_state(bytes, again));
  EXPECT_EQ(again.load_offset_m, 1.25e-3);
}

}  // namespace
}  // namespace sulcus::saved_state_test
