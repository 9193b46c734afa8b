// Of a picture like the last only what differs is drawn; in a hurry coarsely at first.
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/graphics/renderer_fixtures.hpp"

namespace sulcus::renderer_partial_test {
namespace {

TEST(Renderer, WhatIsDrawnOfAPictureLikeTheLastIsThePictureOfAllOfIt) {
  const auto renderer = make_renderer(small(true));
  const VoxelGrid grid = renderer->surface().model().grid;
  std::vector<std::uint32_t> gone;
  for (int step = 0; step < 6; ++step) {
    FrameState state;
    state.time_s = step;
    state.burr_shown = step != 3;
    // The burr goes along the ball; behind it a groove, and something at the ball's other end.
    state.world_from_tool.position = {1e-3 * (0.4 * step - 1.0), -1e-3, 2.0e-3};
    if (step == 4) {
      state.device = state.world_from_tool;
      state.device->position.z() -= 1e-3;
    }
    std::vector<std::uint32_t> now;
    for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
      const Eigen::Vector3d p = grid.centre_world(grid.cell_of_linear(v));
      const bool groove = (p - state.world_from_tool.position).norm() < 0.6e-3;
      if (groove || (step == 5 && p.x() > 2.3e-3)) now.push_back(v);
    }
    if (step == 2) now.clear();  // the burr alone has moved
    renderer->remove(0, now);
    gone.insert(gone.end(), now.begin(), now.end());
    const auto fresh = make_renderer(small(true));
    fresh->remove(0, gone);
    EXPECT_EQ(renderer->draw(state), fresh->draw(state)) << step;
    if (step == 4) renderer->set_viewpoint(Camera::kReview);  // as it was
  }
}

TEST(Renderer, WhatIsDrawnOfAPictureIsEnoughWhereLittleChanges) {
  // Long, so that a cut at one end leaves bricks at the other alone, and beside it another body.
  const auto bar = [](const Cell& cells) {
    VoxelModel model;
    model.grid = {cells, 4e-5};
    model.leaves.resize(model.grid.leaf_count());
    for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
      const Eigen::Vector3d p = model.grid.centre_world(model.grid.cell_of_linear(v));
      const Eigen::Vector2d across(p.y(), p.z() + 0.2e-3 * std::sin(2e3 * p.x()));
      if (across.norm() < 0.9e-3) model.set(model.grid.cell_of_linear(v), true);
    }
    return model;
  };
  const auto make = [&] {
    std::vector<RenderedBody> bodies;
    bodies.push_back({bar({320, 64, 64}), {{"red", {0.8f, 0.05f, 0.05f}}}, {}});
    Pose beside;
    beside.position = {0, 2.5e-3, -1e-3};
    bodies.push_back({bar({160, 64, 64}), {{"white", {0.8f, 0.8f, 0.8f}}}, beside});
    return std::make_unique<Renderer>(small(false), std::move(bodies), tetrahedron(), 1e-3);
  };
  const auto renderer = make();
  FrameState state;
  state.world_from_tool.position = {0, 0, 0.1};
  Image before = renderer->draw(state);
  std::vector<std::uint32_t> gone;
  for (const double x : {-5e-3, -4.6e-3, 3e-3, 5.8e-3, 0.0}) {
    std::vector<std::uint32_t> now;
    const VoxelGrid grid = renderer->surface().model().grid;
    for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
      const Eigen::Vector3d p = grid.centre_world(grid.cell_of_linear(v));
      if ((p - Eigen::Vector3d(x, -0.2e-3, 0.9e-3)).norm() < 0.5e-3) now.push_back(v);
    }
    const std::size_t of_other = x == 0.0 ? 1 : 0;
    if (of_other) now.assign({80u + 160u * (32u + 64u * 50u), 81u + 160u * (32u + 64u * 50u)});
    renderer->remove(of_other, now);
    const Image image = renderer->draw(state);
    EXPECT_NE(image, before) << x;
    const auto fresh = make();
    if (!of_other) gone.insert(gone.end(), now.begin(), now.end());
    fresh->remove(0, gone);
    if (of_other) fresh->remove(1, now);
    EXPECT_EQ(image, fresh->draw(state)) << x;
    before = image;
  }
  // A section and back.
  renderer->set_section(Section{1, 0.0});
  EXPECT_NE(renderer->draw(state), before);
  renderer->set_section({});
  EXPECT_EQ(renderer->draw(state), before);
  renderer->set_size(200, 150);
  renderer->draw(state);
  renderer->set_size(320, 180);
  EXPECT_EQ(renderer->draw(state), before);
}

TEST(Renderer, HurriedPicturesComeToWhatTheyAreWhenNothingMoves) {
  const auto hurried = make_renderer(small(false)), plain = make_renderer(small(false));
  hurried->set_hurried(true);
  FrameState state;
  state.world_from_tool.position = {0, 0, 0.1};
  hurried->draw(state);  // all is meshed at first
  const VoxelGrid grid = plain->surface().model().grid;
  std::vector<std::uint32_t> corner;
  for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
    const Cell c = grid.cell_of_linear(v);
    if (c.x() > 44 && c.z() > 44) corner.push_back(v);
  }
  for (Renderer* renderer : {hurried.get(), plain.get()}) renderer->remove(0, corner);
  const Image expected = plain->draw(state);
  Image image = hurried->draw(state);
  for (int more = 0; more < 8 && image != expected; ++more) image = hurried->draw(state);
  EXPECT_EQ(image, expected);
}

}  // namespace
}  // namespace sulcus::renderer_partial_test
