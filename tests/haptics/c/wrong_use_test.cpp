// Whatever is done wrong with the face to C, the answer is a code, and what was there is as it was.
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include "tests/haptics/c/support.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::wrong_use_test {
namespace {

using test::golden;
using test::Handle;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(CWrongUse, NullIsSaid) {
  SulcusSimulation* none = nullptr;
  SulcusSurface* no_surface = nullptr;
  double pose[7]{0, 0, 0.05, 1, 0, 0, 0}, number = 0;
  std::uint64_t whole = 0;
  std::size_t size = 0;
  SulcusTick tick{};
  SulcusGrid grid{};
  SulcusBrick brick{};
  EXPECT_EQ(sulcus_open(nullptr, &none, nullptr, 0), SULCUS_NULL);
  EXPECT_EQ(sulcus_open_file(nullptr, &none, nullptr, 0), SULCUS_NULL);
  EXPECT_EQ(sulcus_open_file("a.toml", nullptr, nullptr, 0), SULCUS_NULL);
  EXPECT_EQ(sulcus_close(none), SULCUS_NULL);
  EXPECT_EQ(sulcus_free(nullptr), SULCUS_NULL);
  EXPECT_EQ(sulcus_free(&none), SULCUS_DONE);
  EXPECT_EQ(sulcus_step(none, pose, nullptr), SULCUS_NULL);
  EXPECT_EQ(sulcus_step_scene(none, nullptr), SULCUS_NULL);
  EXPECT_EQ(sulcus_scene_ticks(none, &whole), SULCUS_NULL);
  EXPECT_EQ(sulcus_scene_pose(none, 0.0, pose), SULCUS_NULL);
  EXPECT_EQ(sulcus_rate_hz(none, &number), SULCUS_NULL);
  EXPECT_EQ(sulcus_last_tick(none, &tick), SULCUS_NULL);
  EXPECT_EQ(sulcus_contacts(none, nullptr, 0, &size), SULCUS_NULL);
  EXPECT_EQ(sulcus_edits(none, 0, nullptr, 0, &size), SULCUS_NULL);
  EXPECT_EQ(sulcus_edit_count(none, &whole), SULCUS_NULL);
  EXPECT_EQ(sulcus_grid(none, 0, &grid), SULCUS_NULL);
  EXPECT_EQ(sulcus_volume(none, 0, nullptr, 0, &size), SULCUS_NULL);
  EXPECT_EQ(sulcus_solid_voxels(none, &whole), SULCUS_NULL);
  EXPECT_EQ(sulcus_volume_hash(none, &whole), SULCUS_NULL);
  EXPECT_EQ(sulcus_force_hash(none, &whole), SULCUS_NULL);
  EXPECT_EQ(sulcus_state_hash(none, &whole), SULCUS_NULL);
  EXPECT_EQ(sulcus_save(none, nullptr, 0, &size), SULCUS_NULL);
  EXPECT_EQ(sulcus_restore(none, &whole, 8, nullptr, 0), SULCUS_NULL);
  EXPECT_EQ(sulcus_surface_open(none, &no_surface), SULCUS_NULL);
  EXPECT_EQ(sulcus_surface_apply(no_surface, nullptr, 0), SULCUS_NULL);
  EXPECT_EQ(sulcus_surface_next(no_surface, &brick), SULCUS_NULL);
  EXPECT_EQ(sulcus_surface_free(nullptr), SULCUS_NULL);

  const Handle run(golden("press_device"));
  EXPECT_EQ(sulcus_step(run, nullptr, nullptr), SULCUS_NULL);
  EXPECT_EQ(sulcus_scene_ticks(run, nullptr), SULCUS_NULL);
  EXPECT_EQ(sulcus_contacts(run, nullptr, 5, &size), SULCUS_NULL);
  EXPECT_EQ(sulcus_edits(run, 0, nullptr, 5, &size), SULCUS_NULL);
  EXPECT_EQ(sulcus_volume(run, 0, nullptr, 5, &size), SULCUS_NULL);
  EXPECT_EQ(sulcus_last_tick(run, nullptr), SULCUS_NULL);
}

TEST(CWrongUse, WhatIsNoPoseDoesNothing) {
  Handle run(golden("press_device"));
  run.step_scene(50);
  const std::string before = run.state_hash();
  const double good[7]{0, 0, 0.002, 1, 0, 0, 0};
  for (int i = 0; i < 7; ++i) {
    for (const double bad : {kNan, std::numeric_limits<double>::infinity(), 11.0}) {
      double pose[7];
      std::copy_n(good, 7, pose);
      pose[i] = bad;
      EXPECT_EQ(sulcus_step(run, pose, nullptr), SULCUS_BAD_VALUE) << i << " " << bad;
    }
  }
  const double no_turn[7]{0, 0, 0.002, 0, 0, 0, 0};
  EXPECT_EQ(sulcus_step(run, no_turn, nullptr), SULCUS_BAD_VALUE);
  EXPECT_EQ(run.state_hash(), before);
  double pose[7];
  EXPECT_EQ(sulcus_scene_pose(run, kNan, pose), SULCUS_BAD_VALUE);
  SulcusGrid grid;
  EXPECT_EQ(sulcus_grid(run, 1, &grid), SULCUS_BAD_VALUE);
  std::size_t count = 0;
  SulcusEdit edit;
  EXPECT_EQ(sulcus_edits(run, 1, &edit, 1, &count), SULCUS_BAD_VALUE);
}

TEST(CWrongUse, AClosedHandleSaysSo) {
  Handle run(golden("press_device"));
  EXPECT_EQ(sulcus_close(run), SULCUS_DONE);
  EXPECT_EQ(sulcus_close(run), SULCUS_CLOSED);
  const double pose[7]{0, 0, 0.002, 1, 0, 0, 0};
  EXPECT_EQ(sulcus_step(run, pose, nullptr), SULCUS_CLOSED);
  EXPECT_EQ(sulcus_step_scene(run, nullptr), SULCUS_CLOSED);
  std::uint64_t hash = 0;
  EXPECT_EQ(sulcus_volume_hash(run, &hash), SULCUS_CLOSED);
  SulcusSurface* surface = nullptr;
  EXPECT_EQ(sulcus_surface_open(run, &surface), SULCUS_CLOSED);
  EXPECT_EQ(sulcus_free(run.address()), SULCUS_DONE);
  EXPECT_EQ(sulcus_step(run, pose, nullptr), SULCUS_NULL);
}

// Two threads step one run as fast as they can: each step is done by one of them, or refused.
TEST(CWrongUse, TwoThreadsAtOnceAreToldApart) {
  const Handle run(golden("press_device"));
  std::atomic<std::uint64_t> done{0}, busy{0}, other{0};
  const auto work = [&] {
    // Until both were refused at least once between them, which they are bound to be.
    for (int i = 0; i < 100000 && (busy == 0 || i < 300); ++i) {
      const int code = sulcus_step_scene(run, nullptr);
      ++(code == SULCUS_DONE ? done : code == SULCUS_BUSY ? busy : other);
    }
  };
  std::thread one(work), two(work);
  one.join();
  two.join();
  EXPECT_EQ(other, 0u);
  EXPECT_GT(busy, 0u);
  SulcusTick tick{};
  tick.struct_size = sizeof tick;
  ASSERT_EQ(sulcus_last_tick(run, &tick), SULCUS_DONE);
  EXPECT_EQ(tick.tick + 1, done);
}

TEST(CWrongUse, BadInputIsOneLineThatFits) {
  SulcusSimulation* none = nullptr;
  char error[512] = "", few[8] = "";
  EXPECT_EQ(sulcus_open_file("/nowhere.toml", &none, error, sizeof error), SULCUS_BAD_INPUT);
  EXPECT_NE(std::string(error).find("/nowhere.toml: "), std::string::npos) << error;
  EXPECT_EQ(sulcus_open_file("/nowhere.toml", &none, few, sizeof few), SULCUS_BAD_INPUT);
  EXPECT_STREQ(few, "/nowher");
  SulcusSource source{};
  source.struct_size = sizeof source;
  source.text = "[workpiece]\nshape = \"box\"\nwrong = 1\n";
  EXPECT_EQ(sulcus_open(&source, &none, error, sizeof error), SULCUS_BAD_INPUT);
  EXPECT_NE(std::string(error).find("wrong"), std::string::npos) << error;
  EXPECT_EQ(none, nullptr);
  for (int code = -1; code < 14; ++code) EXPECT_NE(sulcus_error_text(code), nullptr);
  EXPECT_STRNE(sulcus_error_text(SULCUS_FAILED), sulcus_error_text(SULCUS_FAILED + 1));
}

// A scene is also what the files hold that it names.
TEST(CWrongUse, AStateIsNotTakenByASceneWhoseFilesHoldOtherThings) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", R"(
workpiece = { shape = "box", voxel_mm = 0.1, cells = [32, 32, 32], box = { size_mm = [2, 2, 2] } }
burr = { file = "burr.obj", field = [32, 64, 32] }
trajectory.file = "path.csv"
)");
  const auto write = [&](const char* width, const char* depth) {
    const std::string w = width;
    scratch.write("burr.obj", "v 0 0 0\nv 0 0 2\nv " + w + " 0 1\nv -" + w + " 0 1\nv 0 " + w +
                                  " 1\nv 0 -" + w +
                                  " 1\nf 1 5 3\nf 1 4 5\nf 1 6 4\nf 1 3 6\nf 2 3 5\nf 2 5 4\n"
                                  "f 2 4 6\nf 2 6 3\n");
    scratch.write("path.csv", std::string("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n"
                                          "0,0,0,1.5,0.7071067811865476,0.7071067811865476,0,0\n"
                                          "1,0,0,") +
                                  depth + ",0.7071067811865476,0.7071067811865476,0,0\n");
  };
  write("0.5", "0.8");
  Handle saved_run(scene);
  saved_run.step_scene(20);
  std::size_t size = 0;
  ASSERT_EQ(sulcus_save(saved_run, nullptr, 0, &size), SULCUS_TOO_SMALL);
  std::vector<std::uint8_t> saved(size);
  ASSERT_EQ(sulcus_save(saved_run, saved.data(), size, &size), SULCUS_DONE);
  char error[512] = "";
  const auto restored = [&] {
    const Handle run(scene);
    return sulcus_restore(run, saved.data(), size, error, sizeof error);
  };
  EXPECT_EQ(restored(), SULCUS_DONE) << error;
  write("0.5", "0.7");
  EXPECT_EQ(restored(), SULCUS_BAD_INPUT) << "another path";
  write("0.6", "0.8");
  EXPECT_EQ(restored(), SULCUS_BAD_INPUT) << "another burr";
}

TEST(CWrongUse, ContactsThatDoNotFitAreNotWritten) {
  Handle run(golden("cut_load"));
  std::size_t count = 0;
  for (std::uint64_t tick = 0; tick < run.ticks() && count < 3; ++tick) {
    run.step_scene(1);
    const int code = sulcus_contacts(run, nullptr, 0, &count);
    ASSERT_EQ(code, count > 0 ? SULCUS_TOO_SMALL : SULCUS_DONE);
  }
  ASSERT_GE(count, 3u);
  std::vector<SulcusContact> contacts(count);
  contacts[0].force_N = -5.0f;
  EXPECT_EQ(sulcus_contacts(run, contacts.data(), count - 1, &count), SULCUS_TOO_SMALL);
  EXPECT_EQ(contacts[0].force_N, -5.0f);
  EXPECT_EQ(sulcus_contacts(run, contacts.data(), count, &count), SULCUS_DONE);
  EXPECT_GE(contacts[0].force_N, 0.0f);
}

TEST(CStep, TakesNoMemory) {
  Handle run(golden("cut_load"));
  run.step_scene(200);
  const double pose[7]{0, -1e-3, 1.72e-3, 1, 0, 0, 0};
  double wrench[6];
  const std::uint64_t before = test::allocation_count();
  for (int i = 0; i < 500; ++i) (void)sulcus_step_scene(run, wrench);
  for (int i = 0; i < 10; ++i) (void)sulcus_step(run, pose, wrench);
  EXPECT_EQ(test::allocation_count(), before);
}

const char* const kOwn = R"(
tissue = ["enamel", "dentine"]
[workpiece]
shape = "box"
voxel_mm = 0.1
cells = [16, 24, 32]
[burr]
diameter_mm = 1.0
field = [32, 64, 32]
[trajectory]
points_mm = [[0, 0, 3]]
)";

TEST(COwnVoxels, AreTheWorkpieceAndComeBackAsBits) {
  std::vector<std::uint8_t> voxels(16 * 24 * 32, 0);
  std::uint64_t solid = 0;
  for (std::size_t v = 0; v < voxels.size() / 2; ++v) {
    voxels[v] = static_cast<std::uint8_t>(v * 2654435761u >> 7 & 1u ? 1 + (v >> 3) % 2 : 0);
    solid += voxels[v] != 0;
  }
  SulcusSource source{};
  source.struct_size = sizeof source;
  source.text = kOwn;
  source.voxels = voxels.data();
  source.voxel_count = voxels.size();
  Handle run;
  char error[512] = "";
  ASSERT_EQ(sulcus_open(&source, run.address(), error, sizeof error), SULCUS_DONE) << error;
  std::uint64_t count = 0;
  ASSERT_EQ(sulcus_solid_voxels(run, &count), SULCUS_DONE);
  EXPECT_EQ(count, solid);
  std::size_t needed = 0;
  EXPECT_EQ(sulcus_volume(run, 0, nullptr, 0, &needed), SULCUS_TOO_SMALL);
  std::vector<std::uint8_t> bits(needed);
  ASSERT_EQ(sulcus_volume(run, 0, bits.data(), bits.size(), &needed), SULCUS_DONE);
  ASSERT_EQ(bits.size() * 8, voxels.size());
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    ASSERT_EQ(bits[v / 8] >> v % 8 & 1, voxels[v] != 0) << v;
  }
  SulcusGrid grid;
  ASSERT_EQ(sulcus_grid(run, 0, &grid), SULCUS_DONE);
  EXPECT_EQ(grid.cells[1], 24);
  EXPECT_NEAR(grid.origin_m[0], -7.5 * 1e-4, 1e-15);

  SulcusSimulation* none = nullptr;
  source.voxel_count = voxels.size() - 1;
  EXPECT_EQ(sulcus_open(&source, &none, error, sizeof error), SULCUS_BAD_INPUT);
  source.voxel_count = voxels.size();
  voxels[5] = 3;
  EXPECT_EQ(sulcus_open(&source, &none, error, sizeof error), SULCUS_BAD_INPUT);
  std::fill(voxels.begin(), voxels.end(), std::uint8_t{0});
  EXPECT_EQ(sulcus_open(&source, &none, error, sizeof error), SULCUS_BAD_INPUT);
}

/// All bricks that changed, put where they belong.
void draw(SulcusSurface* surface, std::vector<std::vector<SulcusVertex>>& drawn, int& bricks) {
  for (SulcusBrick brick{};; ++bricks) {
    ASSERT_EQ(sulcus_surface_next(surface, &brick), SULCUS_DONE);
    if (brick.number < 0) return;
    if (drawn.size() <= static_cast<std::size_t>(brick.number)) drawn.resize(brick.number + 1);
    drawn[brick.number].assign(brick.vertices, brick.vertices + brick.vertex_count);
    for (std::uint32_t i = 0; i < brick.index_count; ++i) {
      ASSERT_LT(brick.indices[i], brick.vertex_count);
    }
  }
}

TEST(CSurface, BroughtUpToDateByEditsItIsThatOfTheVolume) {
  Handle run(golden("cut_full"));
  SulcusSurface *kept = nullptr, *fresh = nullptr;
  ASSERT_EQ(sulcus_surface_open(run, &kept), SULCUS_DONE);
  std::vector<std::vector<SulcusVertex>> drawn, anew;
  int first = 0, again = 0, all = 0;
  draw(kept, drawn, first);
  run.step_scene(300);
  std::vector<SulcusEdit> edits(100000);
  std::size_t count = 0;
  ASSERT_EQ(sulcus_edits(run, 0, edits.data(), edits.size(), &count), SULCUS_DONE);
  ASSERT_GT(count, 0u);
  ASSERT_EQ(sulcus_surface_apply(kept, edits.data(), count), SULCUS_DONE);
  draw(kept, drawn, again);
  EXPECT_GT(again, 0);
  EXPECT_LT(again, first);
  ASSERT_EQ(sulcus_surface_open(run, &fresh), SULCUS_DONE);
  draw(fresh, anew, all);
  ASSERT_EQ(drawn.size(), anew.size());
  for (std::size_t b = 0; b < drawn.size(); ++b) {
    ASSERT_EQ(drawn[b].size(), anew[b].size()) << b;
    for (std::size_t v = 0; v < drawn[b].size(); ++v) {
      for (int a = 0; a < 3; ++a) {
        ASSERT_EQ(drawn[b][v].position_m[a], anew[b][v].position_m[a]);
        ASSERT_EQ(drawn[b][v].normal[a], anew[b][v].normal[a]);
      }
    }
  }
  edits[0].voxel = 0xffffffffu;
  EXPECT_EQ(sulcus_surface_apply(kept, edits.data(), 1), SULCUS_BAD_VALUE);
  EXPECT_EQ(sulcus_surface_free(&kept), SULCUS_DONE);
  EXPECT_EQ(sulcus_surface_free(&fresh), SULCUS_DONE);
  EXPECT_EQ(kept, nullptr);
}

}  // namespace
}  // namespace sulcus::wrong_use_test
