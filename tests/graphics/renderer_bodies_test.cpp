// Other bodies beside the workpiece, in pictures.
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/graphics/renderer_fixtures.hpp"

namespace sulcus::renderer_bodies_test {
namespace {

/// A green ball of 1.2 mm radius, not in the middle of its grid.
struct GreenBall {
  Eigen::Vector3d centre_grid{1.2e-3, 0.0, 0.8e-3};
  RenderedBody body;

  explicit GreenBall(const Pose& world_from_grid) {
    VoxelModel& model = body.model;
    model.grid = {{64, 48, 56}, 1e-4};
    model.leaves.resize(model.grid.leaf_count());
    for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
      const Cell c = model.grid.cell_of_linear(v);
      if ((model.grid.centre_world(c) - centre_grid).norm() < 1.2e-3) model.set(c, true);
    }
    body.looks = {{"green", {0.1f, 0.7f, 0.1f}}};
    body.world_from_grid = world_from_grid;
  }
};

Pose at(double x, double y, double z) {
  Pose pose;
  pose.position = {x, y, z};
  return pose;
}

TEST(RendererOfSeveralBodies, ABodyShowsWhereItsPoseSays) {
  RenderSettings settings = small(false);
  settings.camera = Camera::kBuccal;
  const auto alone = make_renderer(settings);
  const FrameState state = burr_out_of_sight();
  const Image before = alone->draw(state);
  Pose pose = at(-4e-3, 0.5e-3, 1e-3);
  pose.orientation = Eigen::AngleAxisd(2.0, Eigen::Vector3d(0.2, 1.0, -0.1).normalized());
  const GreenBall green(pose);
  const auto both = make_renderer(settings, {green.body});
  const Difference shown = difference(both->draw(state), before, 24);
  const Eigen::Vector3d centre = pose.point(green.centre_grid);
  EXPECT_GT(shown.pixels, 2000u);
  EXPECT_LT((shown.middle - seen_at(centre, Camera::kBuccal)).norm(), 3.0);
  EXPECT_GT(both->triangle_count(), alone->triangle_count() + 1000);
  EXPECT_GT(both->memory_bytes(), alone->memory_bytes() + 20000);
}

TEST(RendererOfSeveralBodies, VoxelsAreRemovedFromTheBodyThatIsNamed) {
  RenderSettings settings = small(false);
  settings.camera = Camera::kBuccal;
  const GreenBall green(at(4.0e-3, 0, 0));  // clear of the red one, to its right
  const auto renderer = make_renderer(settings, {green.body});
  const FrameState state = burr_out_of_sight();
  const Image before = renderer->draw(state);
  const int edge = static_cast<int>(seen_at({3.3e-3, 0, 0}, Camera::kBuccal).x());
  const auto solid_before = renderer->surface().model().solid_count();

  const VoxelGrid& grid = green.body.model.grid;
  std::vector<std::uint32_t> upper;
  for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
    if (grid.centre_world(grid.cell_of_linear(v)).z() > green.centre_grid.z()) upper.push_back(v);
  }
  renderer->remove(1, upper);
  const Image after = renderer->draw(state);
  EXPECT_GT(differing_pixels(after, before, edge, 320), 500u);
  EXPECT_EQ(differing_pixels(after, before, 0, edge), 0u);
  EXPECT_EQ(renderer->surface().model().solid_count(), solid_before);
  EXPECT_THROW(renderer->remove(2, upper), std::out_of_range);

  const std::vector<std::uint32_t> all = CapOfBall().cap;
  renderer->remove(0, all);
  const Image cut = renderer->draw(state);
  EXPECT_GT(differing_pixels(cut, after, 0, edge), 500u);
  EXPECT_EQ(differing_pixels(cut, after, edge, 320), 0u);
}

TEST(RendererOfSeveralBodies, WhatIsInTheWayOfACameraIsLeftOutOfItsPicture) {
  const GreenBall mesial(at(3e-3, 0, 0));
  const auto both = make_renderer(small(false), {mesial.body});
  const auto alone = make_renderer(small(false));
  const FrameState state = burr_out_of_sight();
  for (const Camera camera :
       {Camera::kReview, Camera::kOcclusal, Camera::kBuccal, Camera::kMesial}) {
    both->set_viewpoint(camera);
    alone->set_viewpoint(camera);
    const std::size_t seen = difference(both->draw(state), alone->draw(state), 24).pixels;
    if (camera == Camera::kMesial) {
      EXPECT_EQ(seen, 0u);
    } else {
      EXPECT_GT(seen, 1000u) << static_cast<int>(camera);
    }
  }
  // Beyond the workpiece the same body is in nobody's way.
  const GreenBall distal(at(-12e-3, 5.5e-3, 0));
  const auto other = make_renderer(small(false), {distal.body});
  other->set_viewpoint(Camera::kMesial);
  alone->set_viewpoint(Camera::kMesial);
  EXPECT_GT(difference(other->draw(state), alone->draw(state), 24).pixels, 200u);
}

TEST(RendererOfSeveralBodies, ABodyFarAwayIsNotCutOff) {
  RenderSettings settings = small(false);
  settings.camera = Camera::kMesial;
  const auto alone = make_renderer(settings);
  const auto both = make_renderer(settings, {GreenBall(at(-0.1, 0.03, 0)).body});
  const FrameState state = burr_out_of_sight();
  EXPECT_GT(difference(both->draw(state), alone->draw(state), 24).pixels, 40u);
}

TEST(RendererOfSeveralBodies, TheFirstIsTheWorkpieceAndStandsInTheWorld) {
  EXPECT_THROW(Renderer(small(false), {}, tetrahedron(), 1e-3), std::invalid_argument);
  std::vector<RenderedBody> elsewhere{GreenBall(at(1e-3, 0, 0)).body};
  EXPECT_THROW(Renderer(small(false), std::move(elsewhere), tetrahedron(), 1e-3),
               std::invalid_argument);
}

}  // namespace
}  // namespace sulcus::renderer_bodies_test
