// What golden scenes come to through the face to C: the same as through the program.
#include <cmath>
#include <vector>

#include "tests/haptics/c/support.hpp"

namespace sulcus::golden_scenes_test {
namespace {

using test::golden;
using test::golden_results;
using test::Handle;

class CGolden : public ::testing::TestWithParam<std::string> {};

TEST_P(CGolden, HashesAreThoseOfTheProgram) {
  Handle run(golden(GetParam()));
  const auto results = golden_results(GetParam());
  ASSERT_EQ(run.ticks(), results["ticks"].get<std::uint64_t>());
  run.step_scene(run.ticks());
  EXPECT_EQ(run.volume_hash(), results["volume_hash"]);
  EXPECT_EQ(run.force_hash(), results["force_hash"]);
  EXPECT_EQ(run.state_hash(), results["state_hash"]);
}

// A simulated device, one behind a coupling, other bodies, loose pieces, fractions; a path and a
// load below.
INSTANTIATE_TEST_SUITE_P(Scenes, CGolden,
                         ::testing::Values("press_device", "press_hand", "press_bodies",
                                           "cut_loose", "cut_fractions"),
                         [](const auto& scene) { return scene.param; });

TEST(CGolden, PosesFromOutsideAreAsGoodAsThePath) {
  Handle run(golden("cut_load"));
  double rate_hz = 0.0;
  ASSERT_EQ(sulcus_rate_hz(run, &rate_hz), SULCUS_DONE);
  for (std::uint64_t tick = 0; tick < run.ticks(); ++tick) {
    double pose[7];
    ASSERT_EQ(sulcus_scene_pose(run, static_cast<double>(tick) * (1.0 / rate_hz), pose),
              SULCUS_DONE);
    ASSERT_EQ(sulcus_step(run, pose, nullptr), SULCUS_DONE);
  }
  EXPECT_EQ(run.force_hash(), golden_results("cut_load")["force_hash"]);
}

TEST(CGolden, EditsAndContactsAreThoseCounted) {
  Handle run(golden("cut_load"));
  const auto results = golden_results("cut_load");
  std::uint64_t contacts_sum = 0, next = 0, before = 0, after = 0;
  ASSERT_EQ(sulcus_solid_voxels(run, &before), SULCUS_DONE);
  std::vector<SulcusContact> contacts(65536);
  std::vector<SulcusEdit> edits(64);
  for (std::uint64_t tick = 0; tick < run.ticks(); ++tick) {
    ASSERT_EQ(sulcus_step_scene(run, nullptr), SULCUS_DONE);
    std::size_t count = 0;
    ASSERT_EQ(sulcus_contacts(run, contacts.data(), contacts.size(), &count), SULCUS_DONE);
    contacts_sum += count;
    for (std::size_t i = 0; i < count; ++i) {
      const auto& n = contacts[i].normal;
      ASSERT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0, 1e-5);
      ASSERT_GE(contacts[i].force_N, 0.0f);
    }
    do {
      ASSERT_EQ(sulcus_edits(run, next, edits.data(), edits.size(), &count), SULCUS_DONE);
      for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(edits[i].tick, tick);
      next += count;
    } while (count == edits.size());
  }
  EXPECT_EQ(run.volume_hash(), results["volume_hash"]);
  EXPECT_EQ(run.force_hash(), results["force_hash"]);
  EXPECT_EQ(run.state_hash(), results["state_hash"]);
  EXPECT_EQ(contacts_sum, results["contacts"].get<std::uint64_t>());
  EXPECT_EQ(next, results["edits"].get<std::uint64_t>());
  ASSERT_EQ(sulcus_solid_voxels(run, &after), SULCUS_DONE);
  EXPECT_EQ(before - after, next);
}

class CSaved : public ::testing::TestWithParam<std::string> {};

TEST_P(CSaved, ARunGoesOnFromASavedStateAsIfNothingHadBeen) {
  Handle run(golden(GetParam()));
  const auto results = golden_results(GetParam());
  const std::uint64_t saved_at = run.ticks() * 3 / 4;
  run.step_scene(saved_at);
  std::size_t size = 0;
  ASSERT_EQ(sulcus_save(run, nullptr, 0, &size), SULCUS_TOO_SMALL);
  std::vector<std::byte> saved(size);
  ASSERT_EQ(sulcus_save(run, saved.data(), saved.size(), &size), SULCUS_DONE);
  run.step_scene(run.ticks() - saved_at);
  ASSERT_EQ(run.force_hash(), results["force_hash"]);

  char error[256] = "";
  // Back in the run that went on, and on in another that has not begun.
  Handle other(golden(GetParam()));
  for (const Handle* to : {&run, &other}) {
    ASSERT_EQ(sulcus_restore(*to, saved.data(), saved.size(), error, sizeof error), SULCUS_DONE)
        << error;
    for (std::uint64_t tick = saved_at; tick < run.ticks(); ++tick) sulcus_step_scene(*to, nullptr);
    EXPECT_EQ(to->volume_hash(), results["volume_hash"]);
    EXPECT_EQ(to->force_hash(), results["force_hash"]);
    EXPECT_EQ(to->state_hash(), results["state_hash"]);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, CSaved,
                         ::testing::Values("cut_load", "press_hand", "cut_bodies", "cut_fractions"),
                         [](const auto& scene) { return scene.param; });

TEST(CSaved, DamagedBytesAndThoseOfAnotherSceneAreRefusedAndChangeNothing) {
  Handle run(golden("cut_load")), other(golden("press_device"));
  run.step_scene(600);
  std::size_t size = 0;
  (void)sulcus_save(run, nullptr, 0, &size);
  std::vector<unsigned char> saved(size);
  ASSERT_EQ(sulcus_save(run, saved.data(), size, &size), SULCUS_DONE);
  const std::string before = run.state_hash(), volume = run.volume_hash();
  char error[256] = "";
  EXPECT_EQ(sulcus_restore(other, saved.data(), size, error, sizeof error), SULCUS_BAD_INPUT);
  EXPECT_NE(std::string(error).find("another scene"), std::string::npos) << error;
  for (const std::size_t at : {std::size_t{0}, size / 3, size - 1}) {
    auto damaged = saved;
    damaged[at] = static_cast<unsigned char>(damaged[at] ^ 1u);
    EXPECT_EQ(sulcus_restore(run, damaged.data(), size, error, sizeof error), SULCUS_BAD_INPUT);
  }
  for (const std::size_t part : {std::size_t{0}, std::size_t{7}, std::size_t{100}, size - 1}) {
    EXPECT_EQ(sulcus_restore(run, saved.data(), part, error, sizeof error), SULCUS_BAD_INPUT);
  }
  EXPECT_EQ(run.state_hash(), before);
  EXPECT_EQ(run.volume_hash(), volume);
  Handle loose(golden("cut_loose"));
  EXPECT_EQ(sulcus_save(loose, saved.data(), size, &size), SULCUS_UNSUPPORTED);
}

}  // namespace
}  // namespace sulcus::golden_scenes_test
