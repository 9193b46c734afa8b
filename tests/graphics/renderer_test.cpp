#include "engine/graphics/renderer.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/graphics/renderer_fixtures.hpp"
#include "tests/support/command.hpp"

namespace sulcus::renderer_test {
namespace {

/// The inner part of the ball is of the second tissue.
std::shared_ptr<const TissueMap> core_tissues(const VoxelModel& model) {
  const auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels{};
    for (int v = 0; v < 512; ++v) {
      const Cell c = model.grid.leaf_origin(leaf) + Cell(v & 7, v >> 3 & 7, v >> 6);
      labels[v] = model.grid.centre_world(c).norm() < 1.8e-3 ? 1 : 0;
    }
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  return tissues;
}

TEST(Renderer, DrawsTheSolidInTheMiddleAndTheSameBytesTwice) {
  const auto first = make_renderer(small(true));
  FrameState state;
  state.title = "ball";
  state.world_from_tool.position = {0, 0, 2.5e-3};
  const Image image = first->draw(state);
  ASSERT_EQ(image.rgb.size(), 3u * 320 * 180);
  const std::size_t red = red_pixels(image);
  EXPECT_GT(red, 5000u);
  EXPECT_LT(red, 320u * 180 / 2);
  const std::size_t middle = 3 * (320u * 100 + 160);
  EXPECT_GT(image.rgb[middle], 2 * image.rgb[middle + 1]);
  EXPECT_EQ(first->draw(state), image);

  const auto second = make_renderer(small(true));
  ASSERT_TRUE(second);
  const Image again = second->draw(state);
  EXPECT_EQ(again, image);
  const auto folder = std::filesystem::path(testing::TempDir());
  const std::string a = (folder / "renderer_test_a.png").string();
  const std::string b = (folder / "renderer_test_b.png").string();
  write_png(image, a);
  write_png(again, b);
  EXPECT_EQ(test::read_file(a), test::read_file(b));
  EXPECT_EQ(test::read_file(a).substr(1, 3), "PNG");
  std::filesystem::remove(a);
  std::filesystem::remove(b);
}

TEST(Renderer, RemovedVoxelsAreGoneAndTheOrderOfCallsDoesNotMatter) {
  const auto renderer = make_renderer(small(false));
  FrameState state;
  state.world_from_tool.position = {0, 0, 0.1};  // out of sight
  const std::size_t before = red_pixels(renderer->draw(state));
  std::vector<std::uint32_t> upper;
  const VoxelGrid grid = renderer->surface().model().grid;
  for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
    if (grid.cell_of_linear(v).z() >= 32) upper.push_back(v);
  }
  renderer->remove(0, upper);
  const Image halved = renderer->draw(state);
  EXPECT_LT(red_pixels(halved), before * 9 / 10);
  EXPECT_GT(red_pixels(halved), before / 4);

  const auto other = make_renderer(small(false));
  other->remove(0, upper);
  EXPECT_EQ(other->draw(state), halved);
}

TEST(Renderer, WhatIsTakenBackLooksAsItDid) {
  const auto renderer = make_renderer(small(false));
  FrameState state;
  state.world_from_tool.position = {0, 0, 0.1};
  const Image whole = renderer->draw(state);
  std::vector<std::uint32_t> first, second;
  const VoxelGrid grid = renderer->surface().model().grid;
  for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
    const Cell c = grid.cell_of_linear(v);
    if (c.z() >= 45) (c.x() < 32 ? first : second).push_back(v);
  }
  renderer->remove(0, first);
  const Image half = renderer->draw(state);
  renderer->remove(0, second);
  EXPECT_NE(renderer->draw(state), half);
  renderer->restore(0, second);
  EXPECT_EQ(renderer->draw(state), half);
  renderer->restore(0, first);
  EXPECT_EQ(renderer->draw(state), whole);
  renderer->restore(0, first);  // of what is solid nothing comes back
  EXPECT_EQ(renderer->draw(state), whole);
}

TEST(Renderer, ASectionShowsWhatIsInside) {
  VoxelModel two = ball();
  two.tissues = core_tissues(two);
  std::vector<RenderedBody> bodies;
  bodies.push_back({two, {{"red", {0.8f, 0.05f, 0.05f}}, {"blue", {0.05f, 0.05f, 0.8f}}}, {}});
  const auto renderer =
      std::make_unique<Renderer>(small(false), std::move(bodies), tetrahedron(), 1e-3);
  FrameState state;
  state.world_from_tool.position = {0, 0, 0.1};
  const auto blue = [](const Image& image) {
    std::size_t count = 0;
    for (std::size_t p = 0; p < image.rgb.size(); p += 3) {
      count += image.rgb[p + 2] > 2 * image.rgb[p] ? 1u : 0u;
    }
    return count;
  };
  renderer->set_viewpoint(Camera::kBuccal);
  const Image whole = renderer->draw(state);
  EXPECT_EQ(blue(whole), 0u);
  renderer->set_section(Section{1, 0.0});
  const Image open = renderer->draw(state);
  EXPECT_GT(blue(open), 1000u);
  EXPECT_GT(red_pixels(open), 1000u) << "the outer tissue is round it";
  // From the other side the other half is left out.
  renderer->set_viewpoint(Viewpoint(90.0, 0.0));
  EXPECT_GT(blue(renderer->draw(state)), 1000u);
  // Beyond the body nothing of it is before the plane.
  renderer->set_viewpoint(Camera::kBuccal);
  renderer->set_section(Section{1, -3.1e-3});
  EXPECT_EQ(renderer->draw(state), whole);
  renderer->set_section({});
  EXPECT_EQ(renderer->draw(state), whole);
}

TEST(Renderer, WhatWasCutIsColouredByItsTimeWhereThatIsAsked) {
  const auto plain = make_renderer(small(false)), by_time = make_renderer(small(false));
  by_time->colour_by_time(2.0);
  FrameState state;
  state.world_from_tool.position = {0, 0, 0.1};
  EXPECT_EQ(by_time->draw(state), plain->draw(state)) << "nothing is cut yet";
  std::vector<std::uint32_t> early, late;
  const VoxelGrid grid = plain->surface().model().grid;
  for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
    const Cell c = grid.cell_of_linear(v);
    if (c.z() >= 40) (c.x() < 32 ? early : late).push_back(v);
  }
  for (Renderer* renderer : {plain.get(), by_time.get()}) {
    renderer->remove(0, early, 0.0);
    renderer->remove(0, late, 2.0);
    renderer->set_viewpoint(Camera::kOcclusal);
  }
  const Image tissue = plain->draw(state), time = by_time->draw(state);
  // Left and right of the middle of the cut face: yellow, and nearly black.
  const auto at = [](const Image& image, int x, int y) {
    const std::uint8_t* p = &image.rgb[3 * static_cast<std::size_t>(image.width * y + x)];
    return std::array<int, 3>{p[0], p[1], p[2]};
  };
  const auto left = at(time, 140, 90), right = at(time, 180, 90);
  EXPECT_GT(left[1], 2 * right[1]) << left[1] << ' ' << right[1];
  EXPECT_GT(left[0], 100);
  EXPECT_EQ(at(tissue, 140, 90)[0] > 2 * at(tissue, 140, 90)[1], true);
}

TEST(Renderer, FiguresStandAtTheEdgesOnly) {
  const auto with = make_renderer(small(true));
  const auto without = make_renderer(small(false));
  FrameState state;
  state.title = "A title";
  const std::vector<float> history{0.0f, 1.0f, 0.5f, 2.0f};
  state.force_history_N = state.torque_history_mNm = state.tick_history_us = history;
  state.force_N = {0, 0, 1};
  const Image shown = with->draw(state);
  const Image bare = without->draw(state);
  EXPECT_GT(differing_pixels(shown, bare, 0, 60), 100u);
  EXPECT_GT(differing_pixels(shown, bare, 250, 320), 2000u);
  EXPECT_EQ(differing_pixels(shown, bare, 110, 210), 0u);
  state.force_N = {0, 0, 7};
  EXPECT_GT(differing_pixels(with->draw(state), shown, 250, 320), 5u);
}

TEST(Renderer, CameraSizeAndBurrMatter) {
  const auto renderer = make_renderer(small(false));
  FrameState state;
  state.world_from_tool.position = {0, -6e-3, 0};
  const Image review = renderer->draw(state);
  renderer->set_viewpoint(Camera::kBuccal);
  const Image buccal = renderer->draw(state);
  EXPECT_NE(buccal, review);
  state.world_from_tool.position = {1e-3, -6e-3, 0};
  EXPECT_NE(renderer->draw(state), buccal);
  renderer->set_size(100, 50);
  EXPECT_EQ(renderer->draw(state).rgb.size(), 15000u);
  EXPECT_THROW(renderer->set_size(0, 50), std::runtime_error);
  EXPECT_THROW(renderer->set_size(1 << 24, 50), std::runtime_error);
  EXPECT_EQ(renderer->draw(state).rgb.size(), 15000u);  // the size that it had
}

TEST(Renderer, NothingSolidIsABackground) {
  VoxelModel model;
  model.grid = {{8, 8, 8}, 1e-4};
  model.leaves.resize(1);
  std::vector<RenderedBody> bodies;
  bodies.push_back({model, {{"none", {1, 1, 1}}}, {}});
  bodies.push_back({model, {{"none", {1, 1, 1}}}, {{1e-3, 0, 0}, Eigen::Quaterniond::Identity()}});
  Renderer renderer(small(false), std::move(bodies), {}, 1e-3);
  const Image image = renderer.draw({});
  EXPECT_EQ(renderer.triangle_count(), 0u);
  EXPECT_EQ(red_pixels(image), 0u);
}

}  // namespace
}  // namespace sulcus::renderer_test
