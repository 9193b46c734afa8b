#include "app/window/rewind_film.hpp"

#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/filled_model.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::rewind_film_test {
namespace {

/// What a drawing does with the bodies it is given.
struct Drawing {
  std::vector<DrawnSurface> bodies;

  void remove(std::size_t body, std::span<const std::uint32_t> voxels) {
    bodies[body].remove(voxels);
  }
  void restore(std::size_t body, std::span<const std::uint32_t> voxels) {
    bodies[body].restore(voxels);
  }
  void set_levels(std::size_t body, std::span<const VoxelLevel> levels) {
    bodies[body].set_levels(levels);
  }
};

constexpr std::uint64_t kTicks = 200;

/// Edits of two bodies, a few in a tick; of one with fractions some voxels are lowered, some often,
/// before they go.
std::vector<std::vector<Edit>> random_edits(const std::vector<VoxelModel>& starts) {
  std::mt19937 random(11);
  std::vector<VoxelModel> now = starts;
  std::vector<std::vector<Edit>> ticks(kTicks);
  for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
    for (int i = 0; i < 12; ++i) {
      const auto body = static_cast<std::uint16_t>(random() % 2);
      VoxelModel& model = now[body];
      const auto voxel = static_cast<std::uint32_t>(random() % model.grid.cell_count());
      const Cell c = model.grid.cell_of_linear(voxel);
      if (!model.solid(c)) continue;
      Edit edit{tick, voxel, body};
      if (model.fills) edit.level = static_cast<FillLevel>(model.level(c) / (1 + random() % 3) / 2);
      EXPECT_TRUE(model.set_level(c, edit.level));
      ticks[tick].push_back(edit);
    }
  }
  return ticks;
}

std::vector<VoxelModel> starts() {
  VoxelModel filled =
      test::filled_anyhow(test::block({16, 16, 16}, 1e-4, {2, 2, 2}, {14, 14, 14}), 3);
  filled.fills->reserve(filled.grid.leaf_count());
  return {test::block({16, 16, 16}, 1e-4, {2, 2, 2}, {14, 14, 14}), std::move(filled)};
}

void expect_as_after(std::uint64_t ticks, const std::vector<std::vector<Edit>>& edits,
                     const Drawing& drawing) {
  std::vector<VoxelModel> truth = starts();
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    for (const Edit& edit : edits[tick]) {
      VoxelModel& model = truth[edit.body];
      ASSERT_TRUE(model.set_level(model.grid.cell_of_linear(edit.voxel), edit.level));
    }
  }
  for (std::size_t body = 0; body < truth.size(); ++body) {
    for (std::uint32_t v = 0; v < truth[body].grid.cell_count(); ++v) {
      const Cell c = truth[body].grid.cell_of_linear(v);
      ASSERT_EQ(drawing.bodies[body].model().level(c), truth[body].level(c))
          << "body " << body << " voxel " << v << " after " << ticks;
    }
  }
}

TEST(RewindFilm, ShowsTheBodiesAndTheBurrAsTheyWereAndThePresentAgain) {
  std::vector<RenderedBody> bodies;
  Drawing drawing;
  for (const VoxelModel& model : starts()) {
    bodies.push_back({model, {{"enamel", {1, 1, 1}}}, {}});
    drawing.bodies.emplace_back(model, bodies.back().looks);
  }
  RewindFilm film(bodies);
  const auto edits = random_edits(starts());
  const auto take = [&](std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t tick = from; tick < to; ++tick) {
      film.come_back(drawing);
      TickReport report;
      report.record.tick = tick;
      report.record.time_s = 1e-3 * static_cast<double>(tick);
      report.record.tool_position_m[0] = 1e-6 * static_cast<double>(tick);
      report.record.tool_orientation[0] = 1.0;
      film.add(report, edits[tick]);
      for (const Edit& edit : edits[tick]) {
        const VoxelLevel level{edit.voxel, edit.level};
        edit.is_gone() ? drawing.remove(edit.body, {&edit.voxel, 1})
                       : drawing.set_levels(edit.body, {&level, 1});
      }
    }
  };
  take(0, 150);
  expect_as_after(150, edits, drawing);
  FrameState state;
  for (const std::uint64_t tick : {100u, 40u, 120u, 0u, 60u}) {
    film.look_back(1e-3 * static_cast<double>(tick) + 1e-5, drawing, state);
    EXPECT_EQ(state.tick, tick);
    EXPECT_NEAR(state.world_from_tool.position.x(), 1e-6 * static_cast<double>(tick), 1e-12);
    expect_as_after(tick + 1, edits, drawing);
  }
  film.come_back(drawing);
  expect_as_after(150, edits, drawing);
  film.look_back(0.08, drawing, state);
  take(150, kTicks);  // what still came when it was stopped
  expect_as_after(kTicks, edits, drawing);
  film.look_back(0.02, drawing, state);
  expect_as_after(21, edits, drawing);
  film.come_back(drawing);
  expect_as_after(kTicks, edits, drawing);
}

}  // namespace
}  // namespace sulcus::rewind_film_test
