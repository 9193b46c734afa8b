#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/triangle_mesh.hpp"
#include "engine/graphics/egl_context.hpp"
#include "engine/graphics/gl_scene.hpp"
#include "engine/graphics/image.hpp"

namespace sulcus {

/// A GlScene that is drawn into pictures, with no display: it has an OpenGL context of its own,
/// which is made before it and outlives it, and belongs to the thread that made it. The same calls
/// give the same pictures, bit for bit, on the same machine.
class Renderer : private EglContext, public GlScene {
 public:
  /// As GlScene.
  Renderer(const RenderSettings& settings, std::vector<RenderedBody> bodies,
           const TriangleMesh& burr_mesh_tool, double burr_head_length_m)
      : GlScene(settings, std::move(bodies), burr_mesh_tool, burr_head_length_m) {}
  ~Renderer() { make_current(); }

  // As GlScene's, which call OpenGL.
  void add_piece(std::span<const std::uint32_t> voxels) {
    make_current();
    GlScene::add_piece(voxels);
  }
  void set_size(int width, int height) {
    make_current();
    GlScene::set_size(width, height);
  }
  /// Meshes what has changed and draws a frame.
  Image draw(const FrameState& state) {
    make_current();
    GlScene::draw(state);
    return frame().read();
  }

  /// Meshes what has changed and says what a frame shows.
  GeometryImage draw_geometry(const FrameState& state) {
    make_current();
    return GlScene::draw_geometry(state);
  }
  void set_ghost(VoxelModel shape) {
    make_current();
    GlScene::set_ghost(std::move(shape));
  }

  /// What draws, for the log.
  const std::string& device() const { return description(); }
};

}  // namespace sulcus
