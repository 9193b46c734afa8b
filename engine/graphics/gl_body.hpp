#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/pose.hpp"
#include "engine/graphics/camera.hpp"
#include "engine/graphics/gl_mesh.hpp"
#include "engine/graphics/gl_program.hpp"
#include "engine/graphics/pixel_rect.hpp"
#include "engine/graphics/rendered_body.hpp"
#include "engine/surface/drawn_surface.hpp"
#include "engine/surface/occlusion.hpp"

namespace sulcus {

/// A body as OpenGL draws it: its surface in bricks, what was cut loose from it, and how much light
/// falls on them: it and its pieces shade each other, other bodies do not shade it. Made, used and
/// destroyed with the same OpenGL context current.
class GlBody {
 public:
  explicit GlBody(RenderedBody body);
  ~GlBody();
  GlBody(const GlBody&) = delete;
  GlBody& operator=(const GlBody&) = delete;

  /// Voxels (VoxelGrid::linear) that are no longer solid.
  void remove(std::span<const std::uint32_t> voxels, double time_s) {
    surface_.remove(voxels, time_s);
  }
  void restore(std::span<const std::uint32_t> voxels) { surface_.restore(voxels); }
  void set_levels(std::span<const VoxelLevel> levels) { surface_.set_levels(levels); }
  /// As DrawnSurface.
  void colour_by_time(double span_s) { surface_.colour_by_time(span_s); }
  void colour_by_values(const ColourScale& scale, VoxelValues values) {
    surface_.colour_by_values(scale, std::move(values));
  }
  void colour_by_tissue() { surface_.colour_by_tissue(); }
  /// As GlScene::add_piece.
  void add_piece(std::span<const std::uint32_t> voxels);

  /// Meshes and shades anew what has changed. `pieces`: how the pieces have moved, as
  /// FrameState::pieces, in the space of the body. The surface is that of `detail` from now on.
  /// `hurried`: what cutting does to the light on the surface some way off, which is faint and
  /// takes in much of a picture, waits for some updates, or for one without cutting. Returns a box,
  /// world, of all that looks otherwise than before in this detail, pieces left out; empty: nothing
  /// does.
  Eigen::AlignedBox3f update(std::span<const Pose> pieces, bool hurried, Detail detail);
  /// What was last made of it, as far as it is within `pixels` of a picture of this size.
  /// `program`: of kToothVertex and kToothFragment.
  void draw(GlProgram& program, const View& view_world, std::span<const Pose> pieces,
            const PixelRect& pixels, int width, int height) const;

  const DrawnSurface& surface() const { return surface_; }
  const Pose& world_from_grid() const { return world_from_grid_; }
  /// The solid at the start, by `solid_slabs`, in the space of the body.
  const std::vector<Eigen::AlignedBox3d>& solid_at_start() const { return solid_at_start_; }
  /// A box, world, that holds it; empty where nothing was solid.
  Eigen::AlignedBox3d box_world() const;
  /// With its pieces.
  std::size_t triangle_count() const;
  std::size_t memory_bytes() const;
  bool has_pieces() const { return !pieces_.empty(); }

 private:
  const std::vector<GlMesh>& bricks() const { return bricks_[static_cast<std::size_t>(detail_)]; }
  Eigen::AlignedBox3f shaded_by(const Occlusion::Box& box) const;
  void upload_occlusion(const Occlusion::Box& box);
  void use(GlProgram& program, const View& view, const Pose& world_now_from_start) const;

  DrawnSurface surface_;
  Pose world_from_grid_;
  std::vector<Eigen::AlignedBox3d> solid_at_start_;
  Occlusion occlusion_;
  std::array<std::vector<GlMesh>, 2> bricks_;  // by Detail; none where it was not drawn yet
  Detail detail_ = Detail::kFull;
  int updates_without_light_ = 0;
  std::deque<GlMesh> pieces_;
  struct Workshop;
  std::unique_ptr<Workshop> workshop_;
  unsigned occlusion_texture_ = 0;
};

}  // namespace sulcus
