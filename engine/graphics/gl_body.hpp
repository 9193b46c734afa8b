#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "engine/core/pose.hpp"
#include "engine/graphics/camera.hpp"
#include "engine/graphics/drawn_surface.hpp"
#include "engine/graphics/gl_mesh.hpp"
#include "engine/graphics/gl_program.hpp"
#include "engine/graphics/occlusion.hpp"

namespace sulcus {

/// A body as OpenGL draws it: its surface in bricks, what was cut loose from it, and how much light
/// falls on them. Made, used and destroyed with the same OpenGL context current.
class GlBody {
 public:
  /// `looks`: one per tissue label.
  GlBody(VoxelModel model, std::vector<TissueLook> looks);
  ~GlBody();
  GlBody(const GlBody&) = delete;
  GlBody& operator=(const GlBody&) = delete;

  /// Voxels (VoxelGrid::linear) that are no longer solid.
  void remove(std::span<const std::uint32_t> voxels) { surface_.remove(voxels); }
  /// As Renderer::add_piece.
  void add_piece(std::span<const std::uint32_t> voxels);

  /// Meshes and shades anew what has changed. `pieces`: how the pieces have moved, as
  /// FrameState::pieces.
  void update(std::span<const Pose> pieces);
  /// What was last made of it. `program`: of kToothVertex and kToothFragment.
  void draw(GlProgram& program, const View& view, std::span<const Pose> pieces) const;

  const DrawnSurface& surface() const { return surface_; }
  /// With its pieces.
  std::size_t triangle_count() const;
  std::size_t memory_bytes() const;

 private:
  void upload_occlusion(const Occlusion::Box& box);
  void use(GlProgram& program, const View& view, const Pose& world_now_from_start) const;

  DrawnSurface surface_;
  Occlusion occlusion_;
  std::vector<GlMesh> bricks_;
  std::deque<GlMesh> pieces_;
  unsigned occlusion_texture_ = 0;
};

}  // namespace sulcus
