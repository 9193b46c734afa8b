#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/graphics/renderer.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/surface/drawn_surface.hpp"

namespace sulcus::coloured_picture_test {
namespace {

/// A block of 48^3 voxels of 0.1 mm in a grid of 64^3.
VoxelModel block() {
  VoxelModel model;
  model.grid = {{64, 64, 64}, 1e-4};
  model.leaves.resize(model.grid.leaf_count());
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if ((c.array() >= 8).all() && (c.array() < 56).all()) model.set(c, true);
  }
  return model;
}

const ColourScale kScale{
    .name = "value", .low = -1.0, .high = 1.0, .kind = ColourScale::Kind::kAroundZero};

/// On the upper face low at small x and high at great x; in the middle nothing.
VoxelValues two_halves(float left = -0.5f) {
  VoxelValues values(block().grid);
  for (int n = 0; n < 48 * 48; ++n) {
    const Cell c(n % 48 + 8, n / 48 + 8, 55);
    if (c.x() < 26) values[c] = left;
    if (c.x() >= 38) values[c] = 0.5f;
  }
  return values;
}

TEST(ColouredSurface, HasTheColoursOfItsValuesAndGreyWhereThereAreNone) {
  DrawnSurface surface(block(), {{"red", {0.8f, 0.05f, 0.05f}}}, 1);
  EXPECT_FALSE(surface.colour_scale());
  (void)surface.take_changed();
  surface.colour_by_values(kScale, two_halves());
  ASSERT_TRUE(surface.colour_scale());
  EXPECT_EQ(static_cast<int>(surface.take_changed().size()), surface.brick_count());
  int blue = 0, orange = 0, grey = 0;
  DrawnSurface::Scratch scratch;
  DrawnMesh mesh;
  for (int brick = 0; brick < surface.brick_count(); ++brick) {
    surface.mesh(brick, scratch, mesh);
    for (const DrawnVertex& v : mesh.vertices) {
      const int red = v.colour_cut[0], green = v.colour_cut[1], azure = v.colour_cut[2];
      const Eigen::Vector3d p = surface.model().grid.index_from_world(
          Eigen::Vector3f(v.position_m[0], v.position_m[1], v.position_m[2]).cast<double>());
      if (p.z() > 55.0 && p.x() > 12 && p.x() < 22) {
        EXPECT_GT(azure, red);
        ++blue;
      } else if (p.z() > 55.0 && p.x() > 42 && p.x() < 52) {
        EXPECT_GT(red, azure);
        ++orange;
      } else if (p.z() < 50.0 || (p.x() > 29 && p.x() < 35)) {
        EXPECT_TRUE(red == green && green == azure) << p.transpose();
        ++grey;
      }
    }
  }
  EXPECT_GT(blue, 100);
  EXPECT_GT(orange, 100);
  EXPECT_GT(grey, 100);
}

TEST(ColouredSurface, OnlyWhatHasOtherValuesIsMeshedAgain) {
  DrawnSurface surface(block(), {{"red", {0.8f, 0.05f, 0.05f}}}, 1);
  surface.colour_by_values(kScale, two_halves());
  (void)surface.take_changed();
  surface.colour_by_values(kScale, two_halves());
  EXPECT_TRUE(surface.take_changed().empty());
  surface.colour_by_values(kScale, two_halves(-0.7f));
  const std::vector<int> changed = surface.take_changed();
  EXPECT_FALSE(changed.empty());
  EXPECT_LT(static_cast<int>(changed.size()), surface.brick_count());
  ColourScale wider = kScale;
  wider.high = 2.0;
  surface.colour_by_values(wider, two_halves(-0.7f));
  EXPECT_EQ(static_cast<int>(surface.take_changed().size()), surface.brick_count());
}

/// Throws, and fails the test, where this machine has no OpenGL.
std::unique_ptr<Renderer> make_renderer(bool hud, const TriangleMesh& burr = {}) {
  RenderSettings settings;
  settings.width = 480;
  settings.height = 360;
  settings.hud = hud;
  settings.camera = Camera::kOcclusal;
  std::vector<RenderedBody> bodies;
  bodies.push_back({block(), {{"red", {0.8f, 0.05f, 0.05f}}}, {}});
  return std::make_unique<Renderer>(settings, std::move(bodies), burr, 1e-3);
}

std::array<int, 3> at(const Image& image, int x, int y) {
  const std::uint8_t* p = &image.rgb[3 * static_cast<std::size_t>(image.width * y + x)];
  return {p[0], p[1], p[2]};
}

std::size_t differing(const Image& a, const Image& b) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < a.rgb.size(); p += 3) {
    count += std::equal(&a.rgb[p], &a.rgb[p] + 3, &b.rgb[p]) ? 0u : 1u;
  }
  return count;
}

TEST(ColouredPicture, AScaleStandsBesideTheColours) {
  const auto plain = make_renderer(false), with_hud = make_renderer(true);
  FrameState state;
  state.burr_shown = false;
  const Image tissues = with_hud->draw(state);
  for (Renderer* renderer : {plain.get(), with_hud.get()}) {
    renderer->colour_by_values(0, kScale, two_halves());
  }
  const Image colours = plain->draw(state), scale = with_hud->draw(state);
  EXPECT_GT(at(colours, 180, 180)[2], at(colours, 180, 180)[0]);
  EXPECT_GT(at(colours, 300, 180)[0], at(colours, 300, 180)[2]);
  // Its bar is at the left: blue below, orange above.
  const int x = 20;
  EXPECT_GT(at(scale, x, 315)[2], at(scale, x, 315)[0] + 40);
  EXPECT_GT(at(scale, x, 255)[0], at(scale, x, 255)[2] + 40);
  EXPECT_NE(at(tissues, x, 315), at(scale, x, 315));
}

TEST(ColouredPicture, AnUnlitOneHasTheVeryColoursOfItsScaleInTheShadeToo) {
  ColourScale unlit = kScale;
  unlit.unlit = true;
  const auto renderer = make_renderer(false);
  FrameState state;
  state.burr_shown = false;
  // A slot through the values' left half: its floor lies in the shade, and has a value itself.
  std::vector<std::uint32_t> slot;
  VoxelValues values = two_halves(0.0f);
  const VoxelGrid grid = block().grid;
  for (int n = 0; n < 48 * 6 * 20; ++n) {
    const Cell c(n % 6 + 14, n / 6 % 48 + 8, n / 288 + 36);
    slot.push_back(grid.linear(c));
    values[Cell(c.x(), c.y(), 35)] = 0.0f;
  }
  renderer->remove(0, slot);
  const auto is_the_scales = [&](const Image& image, int x, float value) {
    int off = 0;
    for (int i = 0; i < 3; ++i) {
      const double encoded = 255.0 * std::pow(static_cast<double>(unlit.colour(value)[i]), 1 / 2.2);
      off = std::max(off, std::abs(at(image, x, 180)[static_cast<std::size_t>(i)] -
                                   static_cast<int>(std::lround(encoded))));
    }
    return off <= 2;
  };
  renderer->colour_by_values(0, kScale, values);
  const Image lit = renderer->draw(state);
  renderer->colour_by_values(0, unlit, values);
  const Image flat = renderer->draw(state);
  const int floor_x = 159, right_x = 300;
  EXPECT_TRUE(is_the_scales(flat, floor_x, 0.0f));
  EXPECT_TRUE(is_the_scales(flat, right_x, 0.5f));
  EXPECT_FALSE(is_the_scales(lit, floor_x, 0.0f));
  EXPECT_EQ(at(flat, 240, 180), at(lit, 240, 180)) << "what has no value keeps its light";
}

TEST(ColouredPicture, ContactsAreMarkedWhereTheyAreByTheirForce) {
  const auto renderer = make_renderer(false);
  FrameState state;
  state.burr_shown = false;
  const Image before = renderer->draw(state);
  const std::vector<ContactMark> marks{{{0, 0, 2.4e-3}, 1e-3}, {{1e-3, 0, 2.4e-3}, 9e-3}};
  state.contact_marks = marks;
  state.contact_mark_m = 2e-4;
  const Image after = renderer->draw(state);
  const std::size_t changed = differing(before, after);
  EXPECT_GT(changed, 50u);
  EXPECT_LT(changed, 2000u) << "two voxels' marks, and no scale without figures";
  const auto weak = at(after, 240, 180);
  EXPECT_GT(weak[1], 150) << "light for little";
  EXPECT_NE(weak, at(before, 240, 180));
}

TEST(ColouredPicture, AHandpieceIsDrawnWhereItIsNotInTheWay) {
  TriangleMesh burr;
  burr.positions = {{0, 0, 0}, {5e-4f, 2e-3f, 0}, {-3e-4f, 2e-3f, 4e-4f}, {-3e-4f, 2e-3f, -4e-4f}};
  burr.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const auto with = make_renderer(false, burr), without = make_renderer(false, burr);
  without->set_handpiece(false);
  FrameState state;
  state.world_from_tool.position = {0, 0, 2.4e-3};
  state.world_from_tool.orientation = orientation_along(Eigen::Vector3d::UnitZ());
  const auto difference = [&](const Viewpoint& from) {
    with->set_viewpoint(from);
    without->set_viewpoint(from);
    return differing(with->draw(state), without->draw(state));
  };
  Viewpoint wide(-90.0, 10.0);
  wide.zoom = 0.3;
  EXPECT_GT(difference(wide), 2000u);
  EXPECT_EQ(difference(Camera::kBurr), 0u) << "a close-up";
  EXPECT_EQ(difference(Camera::kOcclusal), 0u) << "down on it";
  // It stands while the burr turns under it.
  const Image before = with->draw(state);
  with->set_viewpoint(wide);
  const Image still = with->draw(state);
  EXPECT_NE(before, still);
  state.burr_turn_rad = 0.3;
  EXPECT_LT(differing(still, with->draw(state)), 200u);
}

}  // namespace
}  // namespace sulcus::coloured_picture_test
