// Pieces that were cut loose, in pictures.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/graphics/renderer_fixtures.hpp"

namespace sulcus::renderer_pieces_test {
namespace {

TEST(Renderer, APieceWhereItWasLooksAsBeforeItCameLoose) {
  const auto renderer = make_renderer(small(false));
  FrameState state = burr_out_of_sight();
  const CapOfBall parts;
  renderer->remove(0, parts.kerf);
  const Image before = renderer->draw(state);
  renderer->add_piece(parts.cap);
  renderer->remove(0, parts.cap);
  const Image without = renderer->draw(state);
  const Pose stayed;
  state.pieces = {&stayed, 1};
  const Image after = renderer->draw(state);
  // The cap is a quarter of what is seen of the ball. Normals and marks at the edges of a narrow
  // cut change, as they are taken from voxels on both sides of it.
  EXPECT_GT(difference(before, without, 24).pixels, red_pixels(before) / 5);
  EXPECT_LT(difference(before, after, 24).pixels, red_pixels(before) / 15);
  EXPECT_LT(difference(before, after, 40).pixels, red_pixels(before) / 200);
}

TEST(Renderer, AMovedPieceShowsAtItsNewPlaceAndNotAtTheOld) {
  RenderSettings settings = small(false);
  settings.camera = Camera::kBuccal;
  const auto renderer = make_renderer(settings);
  const CapOfBall parts;
  renderer->remove(0, parts.kerf);
  renderer->add_piece(parts.cap);
  renderer->remove(0, parts.cap);
  FrameState state = burr_out_of_sight();
  const Image without = renderer->draw(state);
  const VoxelGrid& grid = renderer->surface().model().grid;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const std::uint32_t v : parts.cap) centre += grid.centre_world(grid.cell_of_linear(v));
  centre /= static_cast<double>(parts.cap.size());

  Pose pose;
  state.pieces = {&pose, 1};
  const Difference stayed = difference(renderer->draw(state), without, 24);
  EXPECT_GT(stayed.pixels, 1500u);
  EXPECT_LT((stayed.middle - seen_at(centre, Camera::kBuccal)).norm(), 5.0);
  // Upside down, to the right of the ball.
  const Eigen::Vector3d to(4e-3, -0.5e-3, -1e-3);
  pose.orientation = Eigen::AngleAxisd(2.8, Eigen::Vector3d::UnitY());
  pose.position = to - pose.orientation * centre;
  const Difference moved = difference(renderer->draw(state), without, 24);
  const auto seen = static_cast<double>(stayed.pixels);
  EXPECT_NEAR(static_cast<double>(moved.pixels), seen, 0.15 * seen);
  EXPECT_LT((moved.middle - seen_at(to, Camera::kBuccal)).norm(), 5.0);
}

TEST(Renderer, PiecesWithoutAPoseAreNotDrawnAndTheOrderOfCallsDoesNotMatter) {
  const CapOfBall parts;
  const auto half = parts.cap.begin() + static_cast<std::ptrdiff_t>(parts.cap.size() / 2);
  const std::vector<std::uint32_t> lower(parts.cap.begin(), half);
  const std::vector<std::uint32_t> upper(half, parts.cap.end());
  std::vector<Pose> poses(2);
  poses[0].position = {1e-3, 0, 0};
  poses[1].position = {0, 0, 1e-3};

  const auto renderer = make_renderer(small(false));
  FrameState state = burr_out_of_sight();
  state.pieces = poses;  // more than there are pieces
  renderer->remove(0, parts.kerf);
  renderer->add_piece(lower);
  const std::size_t triangles = renderer->triangle_count();
  const std::size_t memory = renderer->memory_bytes();
  renderer->add_piece(upper);
  EXPECT_GT(renderer->triangle_count(), triangles + 1000);
  EXPECT_GT(renderer->memory_bytes(), memory + 20 * (renderer->triangle_count() - triangles));
  renderer->remove(0, parts.cap);
  const Image both = renderer->draw(state);
  EXPECT_EQ(renderer->draw(state), both);
  state.pieces = {poses.data(), 1};
  const Image first = renderer->draw(state);
  std::vector<Pose> second_far_away = poses;
  second_far_away[1].position.z() = 1.0;
  state.pieces = second_far_away;
  EXPECT_EQ(renderer->draw(state), first);
  state.pieces = {};
  const Image none = renderer->draw(state);
  EXPECT_GT(difference(both, first, 24).pixels, 200u);
  EXPECT_GT(difference(first, none, 24).pixels, 200u);

  const auto other = make_renderer(small(false));
  other->remove(0, parts.kerf);
  other->remove(0, parts.cap);
  EXPECT_EQ(other->draw(state), none);  // as if there were no pieces
  other->add_piece(lower);
  state.pieces = poses;
  EXPECT_EQ(other->draw(state), first);
  other->add_piece(upper);
  EXPECT_EQ(other->draw(state), both);
}

}  // namespace
}  // namespace sulcus::renderer_pieces_test
