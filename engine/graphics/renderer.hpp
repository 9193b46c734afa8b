#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/core/triangle_mesh.hpp"
#include "engine/graphics/drawn_surface.hpp"
#include "engine/graphics/egl_context.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/graphics/gl_body.hpp"
#include "engine/graphics/gl_burr.hpp"
#include "engine/graphics/gl_framebuffer.hpp"
#include "engine/graphics/gl_program.hpp"
#include "engine/graphics/hud.hpp"
#include "engine/graphics/image.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Draws a tooth, what was cut loose from it, the burr and the figures into pictures, with no
/// display:
///
///   removals -> bricks of the surface meshed again -> burr, tooth, pieces -> edges smoothed ->
///   figures -> Image
///
/// It has its own copy of the volume and its own OpenGL context, and belongs to the thread that
/// made it. The same calls give the same pictures, bit for bit, on the same machine.
class Renderer {
 public:
  /// `looks`: one per tissue label. `burr_mesh_tool`: tool space, m; blades are shown up to
  /// `burr_head_length_m` from the tip. Throws std::runtime_error where nothing can be drawn.
  Renderer(const RenderSettings& settings, VoxelModel model, std::vector<TissueLook> looks,
           const TriangleMesh& burr_mesh_tool, double burr_head_length_m);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Voxels (VoxelGrid::linear) that are no longer solid.
  void remove(std::span<const std::uint32_t> voxels) { workpiece_.remove(voxels); }
  /// A piece that was cut loose, by its voxels (VoxelGrid::linear), each once: a body of its own
  /// from now on, drawn where FrameState::pieces says. It is meshed here, once, by `piece_mesh`,
  /// which says what it throws. The caller also removes its voxels, in the same frame, before or
  /// after: the piece comes out the same. Tooth and pieces shade each other where they are.
  void add_piece(std::span<const std::uint32_t> voxels);
  void set_camera(Camera camera) { camera_ = camera; }
  /// Pixels. Throws std::runtime_error beyond what OpenGL here can draw; the size then stays.
  void set_size(int width, int height);
  /// Meshes what has changed and draws a frame.
  Image draw(const FrameState& state);

  /// What draws, for the log.
  const std::string& device() const { return context_.description(); }
  const DrawnSurface& surface() const { return workpiece_.surface(); }
  /// Of the tooth and the pieces.
  std::size_t triangle_count() const;
  /// Of the volume, the meshes and the pictures, as far as they are ours.
  std::size_t memory_bytes() const;

 private:
  EglContext context_;
  RenderSettings settings_;
  Camera camera_;
  GlBody workpiece_;
  std::vector<Eigen::AlignedBox3d> solid_world_;  // of the start
  GlBurr burr_;
  std::unique_ptr<GlFramebuffer> frame_;
  std::optional<Hud> hud_;
  GlProgram background_program_, tooth_program_, smooth_program_;
  unsigned background_array_ = 0;
};

}  // namespace sulcus
