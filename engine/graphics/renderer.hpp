#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/triangle_mesh.hpp"
#include "engine/graphics/egl_context.hpp"
#include "engine/graphics/gl_scene.hpp"
#include "engine/graphics/image.hpp"

namespace sulcus {

/// Draws a GlScene into pictures, with no display: it has an OpenGL context of its own and belongs
/// to the thread that made it. The same calls give the same pictures, bit for bit, on the same
/// machine.
class Renderer {
 public:
  /// As GlScene.
  Renderer(const RenderSettings& settings, std::vector<RenderedBody> bodies,
           const TriangleMesh& burr_mesh_tool, double burr_head_length_m)
      : scene_(settings, std::move(bodies), burr_mesh_tool, burr_head_length_m) {}
  ~Renderer() { context_.make_current(); }
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // As GlScene's.
  void remove(std::size_t body, std::span<const std::uint32_t> voxels, double time_s = 0.0) {
    scene_.remove(body, voxels, time_s);
  }
  void restore(std::size_t body, std::span<const std::uint32_t> voxels) {
    scene_.restore(body, voxels);
  }
  void colour_by_time(double span_s) { scene_.colour_by_time(span_s); }
  void colour_by_values(std::size_t body, const ColourScale& scale, VoxelValues values) {
    scene_.colour_by_values(body, scale, std::move(values));
  }
  void add_piece(std::span<const std::uint32_t> voxels) {
    context_.make_current();
    scene_.add_piece(voxels);
  }
  void set_viewpoint(const Viewpoint& from) { scene_.set_viewpoint(from); }
  void set_hurried(bool hurried) { scene_.set_hurried(hurried); }
  void set_detail(Detail detail) { scene_.set_detail(detail); }
  void set_handpiece(bool shown) { scene_.set_handpiece(shown); }
  void set_hud(const HudParts& parts) { scene_.set_hud(parts); }
  void set_section(std::optional<Section> section) { scene_.set_section(section); }
  void set_size(int width, int height) {
    context_.make_current();
    scene_.set_size(width, height);
  }
  /// Meshes what has changed and draws a frame.
  Image draw(const FrameState& state) {
    context_.make_current();
    scene_.draw(state);
    return scene_.frame().read();
  }

  /// What draws, for the log.
  const std::string& device() const { return context_.description(); }
  const DrawnSurface& surface() const { return scene_.surface(); }
  std::size_t triangle_count() const { return scene_.triangle_count(); }
  std::size_t memory_bytes() const { return scene_.memory_bytes(); }

 private:
  EglContext context_;
  GlScene scene_;
};

}  // namespace sulcus
