#pragma once

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "engine/graphics/camera.hpp"
#include "engine/graphics/renderer.hpp"

// What the tests of the renderer draw, and how they compare pictures.
namespace sulcus {

inline VoxelModel ball() {
  VoxelModel model;
  model.grid = {{64, 64, 64}, 1e-4};
  model.leaves.resize(model.grid.leaf_count());
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if (model.grid.centre_world(c).norm() < 2.6e-3) model.set(c, true);
  }
  return model;
}

inline TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {5e-4f, 2e-3f, 0}, {-3e-4f, 2e-3f, 4e-4f}, {-3e-4f, 2e-3f, -4e-4f}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

inline RenderSettings small(bool hud) {
  RenderSettings settings;
  settings.width = 320;
  settings.height = 180;
  settings.hud = hud;
  return settings;
}

/// The ball as the workpiece, and other bodies. Throws where this machine has no OpenGL, which
/// fails the test: EGL and Mesa are among tools/packages.txt.
inline std::unique_ptr<Renderer> make_renderer(const RenderSettings& settings,
                                               std::vector<RenderedBody> others = {}) {
  std::vector<RenderedBody> bodies;
  bodies.push_back({ball(), {{"red", {0.8f, 0.05f, 0.05f}}}, {}});
  for (RenderedBody& other : others) bodies.push_back(std::move(other));
  return std::make_unique<Renderer>(settings, std::move(bodies), tetrahedron(), 1e-3);
}

inline std::size_t red_pixels(const Image& image) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < image.rgb.size(); p += 3) {
    count += image.rgb[p] > 2 * image.rgb[p + 1] ? 1u : 0u;
  }
  return count;
}

inline std::size_t differing_pixels(const Image& a, const Image& b, int from_x, int to_x) {
  std::size_t count = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = from_x; x < to_x; ++x) {
      const std::size_t p = 3 * (static_cast<std::size_t>(a.width) * y + x);
      count += std::equal(&a.rgb[p], &a.rgb[p] + 3, &b.rgb[p]) ? 0u : 1u;
    }
  }
  return count;
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

inline FrameState burr_out_of_sight() {
  FrameState state;
  state.world_from_tool.position = {0, 0, 0.1};
  return state;
}

/// Pixels in which a colour differs by more than `more_than` of 255, and their middle.
struct Difference {
  std::size_t pixels = 0;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // pixels from the left and from the top
};
inline Difference difference(const Image& a, const Image& b, int more_than) {
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
inline Eigen::Vector2d seen_at(const Eigen::Vector3d& p_world, Camera camera) {
  const View view =
      make_view(camera, solid_slabs(ball()), Eigen::Vector3d(0, 0, 0.1), 0.0, 320, 180);
  const Eigen::Vector4f clip = view.clip_from_world * p_world.cast<float>().homogeneous().eval();
  return {160.0 * (1.0 + clip.x() / clip.w()), 90.0 * (1.0 - clip.y() / clip.w())};
}

}  // namespace sulcus
