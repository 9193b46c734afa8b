#include "engine/graphics/renderer.hpp"

#include <algorithm>
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

/// Null where this machine has no OpenGL, which is not what these tests are about.
std::unique_ptr<Renderer> make_renderer(const RenderSettings& settings) {
  try {
    return std::make_unique<Renderer>(settings, ball(),
                                      std::vector<TissueLook>{{"red", {0.8f, 0.05f, 0.05f}}},
                                      tetrahedron(), 1e-3);
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
  renderer->remove(upper);
  const Image halved = renderer->draw(state);
  EXPECT_LT(red_pixels(halved), before * 9 / 10);
  EXPECT_GT(red_pixels(halved), before / 4);

  const auto other = make_renderer(small(false));
  other->remove(upper);
  EXPECT_EQ(other->draw(state), halved);
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
  renderer->set_camera(Camera::kBuccal);
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
  Renderer renderer(small(false), std::move(model), {{"none", {1, 1, 1}}}, {}, 1e-3);
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
