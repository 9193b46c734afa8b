#include "engine/graphics/renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/graphics/camera.hpp"

namespace sulcus {
namespace {

VoxelModel ball() {
  VoxelModel model;
  model.grid = {{64, 64, 64}, 1e-4};
  model.leaves.resize(model.grid.leaf_count());
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if (model.grid.centre_world(c).norm() < 2.6e-3) model.set(c, true);
  }
  return model;
}

/// The inner part of the ball is of the second tissue.
TissueMap core_tissues(const VoxelModel& model) {
  TissueMap tissues(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels{};
    for (int v = 0; v < 512; ++v) {
      const Cell c = model.grid.leaf_origin(leaf) + Cell(v & 7, v >> 3 & 7, v >> 6);
      labels[v] = model.grid.centre_world(c).norm() < 1.8e-3 ? 1 : 0;
    }
    tissues.set_block(leaf, labels, model.leaves[leaf].words);
  }
  return tissues;
}

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {5e-4f, 2e-3f, 0}, {-3e-4f, 2e-3f, 4e-4f}, {-3e-4f, 2e-3f, -4e-4f}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

RenderSettings small(bool hud) {
  RenderSettings settings;
  settings.width = 320;
  settings.height = 180;
  settings.hud = hud;
  return settings;
}

/// The ball as the workpiece, and other bodies. Null where this machine has no OpenGL, which is not
/// what these tests are about.
std::unique_ptr<Renderer> make_renderer(const RenderSettings& settings,
                                        std::vector<RenderedBody> others = {}) {
  std::vector<RenderedBody> bodies;
  bodies.push_back({ball(), {{"red", {0.8f, 0.05f, 0.05f}}}, {}});
  for (RenderedBody& other : others) bodies.push_back(std::move(other));
  try {
    return std::make_unique<Renderer>(settings, std::move(bodies), tetrahedron(), 1e-3);
  } catch (const std::runtime_error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return nullptr;
  }
}

std::size_t red_pixels(const Image& image) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < image.rgb.size(); p += 3) {
    count += image.rgb[p] > 2 * image.rgb[p + 1] ? 1u : 0u;
  }
  return count;
}

std::size_t differing_pixels(const Image& a, const Image& b, int from_x, int to_x) {
  std::size_t count = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = from_x; x < to_x; ++x) {
      const std::size_t p = 3 * (static_cast<std::size_t>(a.width) * y + x);
      count += std::equal(&a.rgb[p], &a.rgb[p] + 3, &b.rgb[p]) ? 0u : 1u;
    }
  }
  return count;
}

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(Renderer, DrawsTheSolidInTheMiddleAndTheSameBytesTwice) {
  const auto first = make_renderer(small(true));
  if (!first) GTEST_SKIP() << "no OpenGL here";
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
  EXPECT_EQ(bytes_of(a), bytes_of(b));
  EXPECT_EQ(bytes_of(a).substr(1, 3), "PNG");
  std::filesystem::remove(a);
  std::filesystem::remove(b);
}

TEST(Renderer, RemovedVoxelsAreGoneAndTheOrderOfCallsDoesNotMatter) {
  const auto renderer = make_renderer(small(false));
  if (!renderer) GTEST_SKIP() << "no OpenGL here";
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
  if (!renderer) GTEST_SKIP() << "no OpenGL here";
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

TEST(Renderer, WhatIsDrawnOfAPictureLikeTheLastIsThePictureOfAllOfIt) {
  const auto renderer = make_renderer(small(true));
  if (!renderer) GTEST_SKIP() << "no OpenGL here";
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
  const auto make = [&]() -> std::unique_ptr<Renderer> {
    std::vector<RenderedBody> bodies;
    bodies.push_back({bar({320, 64, 64}), {{"red", {0.8f, 0.05f, 0.05f}}}, {}});
    Pose beside;
    beside.position = {0, 2.5e-3, -1e-3};
    bodies.push_back({bar({160, 64, 64}), {{"white", {0.8f, 0.8f, 0.8f}}}, beside});
    try {
      return std::make_unique<Renderer>(small(false), std::move(bodies), tetrahedron(), 1e-3);
    } catch (const std::runtime_error&) {
      return nullptr;
    }
  };
  const auto renderer = make();
  if (!renderer) GTEST_SKIP() << "no OpenGL here";
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
  if (!hurried) GTEST_SKIP() << "no OpenGL here";
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

TEST(Renderer, ASectionShowsWhatIsInside) {
  VoxelModel two = ball();
  two.tissues = std::make_shared<TissueMap>(core_tissues(two));
  std::vector<RenderedBody> bodies;
  bodies.push_back({two, {{"red", {0.8f, 0.05f, 0.05f}}, {"blue", {0.05f, 0.05f, 0.8f}}}, {}});
  std::unique_ptr<Renderer> renderer;
  try {
    renderer = std::make_unique<Renderer>(small(false), std::move(bodies), tetrahedron(), 1e-3);
  } catch (const std::runtime_error& error) {
    GTEST_SKIP() << "no OpenGL here";
  }
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
  if (!plain) GTEST_SKIP() << "no OpenGL here";
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

TEST(Renderer, ASheetHasThePicturesInRows) {
  const Image red{2, 1, {255, 0, 0, 255, 0, 0}}, blue{2, 1, {0, 0, 255, 0, 0, 255}};
  const std::vector<Image> three{red, blue, red};
  const Image sheet = sheet_of(three, 2);
  EXPECT_EQ(sheet.width, 4);
  EXPECT_EQ(sheet.height, 2);
  EXPECT_EQ(sheet.rgb,
            (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 0, 0,   0,   255, 0,   0,   255,
                                       255, 0, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}));
  EXPECT_EQ(sheet_of({}, 3), Image{});
  const std::vector<Image> several{red, Image{1, 1, {0, 0, 0}}};
  EXPECT_THROW(sheet_of(several, 2), std::invalid_argument);
}

/// A ball from which a burr has all but cut a cap: the way of the burr, 0.6 mm wide, and the cap.
struct CapOfBall {
  std::vector<std::uint32_t> kerf, cap;

  CapOfBall() {
    const VoxelModel model = ball();
    for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
      const Cell c = model.grid.cell_of_linear(v);
      if (!model.solid(c)) continue;
      const Eigen::Vector3d p = model.grid.centre_world(c);
      const double height = p.z() + 0.5 * p.x();
      if (height > 1.0e-3) {
        cap.push_back(v);
      } else if (height > 0.4e-3) {
        kerf.push_back(v);
      }
    }
  }
};

FrameState burr_out_of_sight() {
  FrameState state;
  state.world_from_tool.position = {0, 0, 0.1};
  return state;
}

/// Pixels in which a colour differs by more than `more_than` of 255, and their middle.
struct Difference {
  std::size_t pixels = 0;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // pixels from the left and from the top
};
Difference difference(const Image& a, const Image& b, int more_than) {
  Difference result;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const std::size_t p = 3 * (static_cast<std::size_t>(a.width) * y + x);
      int largest = 0;
      for (std::size_t i = p; i < p + 3; ++i) {
        largest = std::max(largest, std::abs(a.rgb[i] - b.rgb[i]));
      }
      if (largest <= more_than) continue;
      ++result.pixels;
      result.middle += Eigen::Vector2d(x + 0.5, y + 0.5);
    }
  }
  if (result.pixels > 0) result.middle /= static_cast<double>(result.pixels);
  return result;
}

/// A point in a picture of the ball, in pixels from the left and from the top.
Eigen::Vector2d seen_at(const Eigen::Vector3d& p_world, Camera camera) {
  const View view =
      make_view(camera, solid_slabs(ball()), Eigen::Vector3d(0, 0, 0.1), 0.0, 320, 180);
  const Eigen::Vector4f clip = view.clip_from_world * p_world.cast<float>().homogeneous().eval();
  return {160.0 * (1.0 + clip.x() / clip.w()), 90.0 * (1.0 - clip.y() / clip.w())};
}

TEST(Renderer, APieceWhereItWasLooksAsBeforeItCameLoose) {
  const auto renderer = make_renderer(small(false));
  if (!renderer) GTEST_SKIP() << "no OpenGL here";
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
  if (!renderer) GTEST_SKIP() << "no OpenGL here";
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
  if (!renderer) GTEST_SKIP() << "no OpenGL here";
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
  if (!alone) GTEST_SKIP() << "no OpenGL here";
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
  if (!renderer) GTEST_SKIP() << "no OpenGL here";
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
  if (!both) GTEST_SKIP() << "no OpenGL here";
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
  if (!alone) GTEST_SKIP() << "no OpenGL here";
  const auto both = make_renderer(settings, {GreenBall(at(-0.1, 0.03, 0)).body});
  const FrameState state = burr_out_of_sight();
  EXPECT_GT(difference(both->draw(state), alone->draw(state), 24).pixels, 40u);
}

TEST(RendererOfSeveralBodies, TheFirstIsTheWorkpieceAndStandsInTheWorld) {
  if (!make_renderer(small(false))) GTEST_SKIP() << "no OpenGL here";
  EXPECT_THROW(Renderer(small(false), {}, tetrahedron(), 1e-3), std::invalid_argument);
  std::vector<RenderedBody> elsewhere{GreenBall(at(1e-3, 0, 0)).body};
  EXPECT_THROW(Renderer(small(false), std::move(elsewhere), tetrahedron(), 1e-3),
               std::invalid_argument);
}

TEST(Renderer, FiguresStandAtTheEdgesOnly) {
  const auto with = make_renderer(small(true));
  if (!with) GTEST_SKIP() << "no OpenGL here";
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
  if (!renderer) GTEST_SKIP() << "no OpenGL here";
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
  if (!make_renderer(small(false))) GTEST_SKIP() << "no OpenGL here";
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

TEST(EglContext, SaysWhatWasTried) {
  const std::vector<EglPlatform> none;
  EXPECT_THROW(EglContext{none}, std::runtime_error);
  // Whichever of the other two ways exists here must work, or say its name.
  for (const EglPlatform platform : {EglPlatform::kDevice, EglPlatform::kDefault}) {
    const EglPlatform only[] = {platform};
    try {
      const EglContext context(only);
      EXPECT_NE(context.description().find("OpenGL"), std::string::npos);
    } catch (const std::runtime_error& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.find("EGL device") != std::string::npos ||
                  what.find("default display") != std::string::npos)
          << what;
    }
  }
}

TEST(SoftwareThreads, TheUsersOwnSettingStays) {
  setenv("LP_NUM_THREADS", "3", 1);
  limit_software_threads(1);
  EXPECT_STREQ(std::getenv("LP_NUM_THREADS"), "3");
  unsetenv("LP_NUM_THREADS");
  limit_software_threads(1);
  EXPECT_STREQ(std::getenv("LP_NUM_THREADS"), "1");
  unsetenv("LP_NUM_THREADS");
}

TEST(WritePng, NamesTheFileItCannotWrite) {
  try {
    write_png({1, 1, {1, 2, 3}}, "/nowhere/at/all.png");
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/at/all.png"), std::string::npos);
  }
}

}  // namespace
}  // namespace sulcus
