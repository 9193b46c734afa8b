#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/core/triangle_mesh.hpp"
#include "engine/graphics/camera.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/graphics/geometry_image.hpp"
#include "engine/graphics/gl_body.hpp"
#include "engine/graphics/gl_burr.hpp"
#include "engine/graphics/gl_framebuffer.hpp"
#include "engine/graphics/gl_geometry.hpp"
#include "engine/graphics/gl_ghost.hpp"
#include "engine/graphics/gl_program.hpp"
#include "engine/graphics/gl_section.hpp"
#include "engine/graphics/hud.hpp"
#include "engine/graphics/rendered_body.hpp"
#include "engine/scene/scene.hpp"
#include "engine/surface/drawn_surface.hpp"

namespace sulcus {

/// All that a picture shows, as OpenGL draws it: the workpiece, what was cut loose from it, other
/// bodies, the burr and the figures:
///
///   removals -> bricks of the surfaces meshed again -> burr, workpiece, pieces, other bodies that
///   are not in the way, the face of a section -> edges smoothed -> figures
///
/// The workpiece is what is reviewed: cameras frame it alone, and a body that would hide a third or
/// more of what they are there to show of it (`points_to_see`, `hidden_share`, by the boxes of what
/// was solid at the start) is left out of the picture: so the mesial neighbour from mesial, and in
/// close-ups of the burr whatever stands before its tip. Bodies do not shade each other.
///
/// It has its own copy of the volumes. Made, used and destroyed with the same OpenGL context
/// current: that of a Renderer, or of a window.
class GlScene {
 public:
  /// `bodies`: the first is the workpiece, whose grid is the world's; throws std::invalid_argument
  /// where there is none or it is placed elsewhere. `burr_mesh_tool`: tool space, m; blades are
  /// shown up to `burr_head_length_m` from the tip. Throws std::runtime_error where nothing can be
  /// drawn.
  GlScene(const RenderSettings& settings, std::vector<RenderedBody> bodies,
          const TriangleMesh& burr_mesh_tool, double burr_head_length_m);
  ~GlScene();
  GlScene(const GlScene&) = delete;
  GlScene& operator=(const GlScene&) = delete;

  /// Voxels (VoxelGrid::linear) of a body that are no longer solid. `body`: its place in what the
  /// scene was made with, 0 the workpiece; throws std::out_of_range beyond.
  /// `time_s`: when, for colour_by_time.
  void remove(std::size_t body, std::span<const std::uint32_t> voxels, double time_s = 0.0) {
    bodies_.at(body)->remove(voxels, time_s);
  }
  /// Takes removals back.
  void restore(std::size_t body, std::span<const std::uint32_t> voxels) {
    bodies_.at(body)->restore(voxels);
  }
  /// Of a body with fractions: what is left of voxels that still stand, as DrawnSurface.
  void set_levels(std::size_t body, std::span<const VoxelLevel> levels) {
    bodies_.at(body)->set_levels(levels);
  }
  /// As DrawnSurface, for all bodies.
  void colour_by_time(double span_s) {
    for (const auto& body : bodies_) body->colour_by_time(span_s);
  }
  /// As DrawnSurface, of a body as for `remove`.
  void colour_by_values(std::size_t body, const ColourScale& scale, VoxelValues values) {
    bodies_.at(body)->colour_by_values(scale, std::move(values));
  }
  void colour_by_tissue(std::size_t body) { bodies_.at(body)->colour_by_tissue(); }
  /// A piece that was cut loose from the workpiece, by its voxels (VoxelGrid::linear), each once: a
  /// body of its own from now on, drawn where FrameState::pieces says. It is meshed here, once, by
  /// `piece_mesh`, which says what it throws. The caller also removes its voxels, in the same
  /// frame, before or after: the piece comes out the same. Workpiece and pieces shade each other
  /// where they are.
  void add_piece(std::span<const std::uint32_t> voxels);
  void set_viewpoint(const Viewpoint& from) { from_ = from; }
  /// For pictures that follow one another at once: what cutting does to the light on the surface
  /// some way off is drawn a little later. Else each picture is that of all that was removed.
  void set_hurried(bool hurried) { hurried_ = hurried; }
  /// Coarse for pictures in which all moves, while a camera turns: from a quarter of the triangles,
  /// and with the edges as they are. Of each detail that is drawn a mesh is kept.
  void set_detail(Detail detail) { detail_ = detail; }
  void set_hud(const HudParts& parts) { hud_parts_ = parts; }
  void set_section(std::optional<Section> section) { settings_.section = section; }
  /// Pictures are taken from so far to the right of the viewpoint, m, looking the same way, and
  /// show the same bodies.
  void set_eye_offset(double right_m) { eye_offset_m_ = right_m; }
  /// A shape on the workpiece's grid that is drawn palely over everything, as GlGhost.
  void set_ghost(VoxelModel shape) {
    ghost_.emplace(std::move(shape));
    drawn_ = false;
  }
  void take_ghost_away() {
    ghost_.reset();
    drawn_ = false;
  }
  /// Whether the handpiece is drawn with the burr (it is), where it is not in the way: left out of
  /// close-ups of the burr, and where one looks down on it along the burr.
  void set_handpiece(bool shown) { handpiece_ = shown; }
  /// Pixels. Throws std::runtime_error beyond what OpenGL here can draw; the size then stays.
  void set_size(int width, int height);
  /// Meshes what has changed and draws a frame, which `frame()` then holds. From where the last one
  /// was taken only what is different is drawn: the picture is that of drawing all of it.
  void draw(const FrameState& state);

  /// What the picture of `draw` shows and where, figures, ghost and the device's burr left out.
  /// Both may be asked for of a state, in any order.
  GeometryImage draw_geometry(const FrameState& state);

  const GlFramebuffer& frame() const { return *frame_; }
  /// What a mouth mirror shows: all bodies and the burr from there, left and right exchanged,
  /// without section and figures. After `draw`, whose meshes it takes; costs as much as drawing all
  /// anew. Valid until the next call.
  const GlFramebuffer& draw_mirror(const Viewpoint& from, const FrameState& state, int width,
                                   int height);
  /// Of the last picture.
  const View& view() const { return view_; }
  /// Bodies that were not left out of it, the workpiece first.
  std::span<const GlBody* const> shown_bodies() const { return shown_; }
  /// Of a body, by default of the workpiece; throws std::out_of_range beyond.
  const DrawnSurface& surface(std::size_t body = 0) const { return bodies_.at(body)->surface(); }
  const Pose& world_from_grid(std::size_t body) const {
    return bodies_.at(body)->world_from_grid();
  }
  /// Of the bodies and the pieces, in the last picture or left out.
  std::size_t triangle_count() const;
  /// Of the volumes, the meshes and the pictures, as far as they are ours.
  std::size_t memory_bytes() const;

 private:
  PixelRect changed_pixels(const FrameState& state);
  std::vector<std::size_t> bodies_in_sight(const FrameState& state) const;
  bool shows_handpiece(const FrameState& state) const;
  PixelRect burr_pixels(const FrameState& state) const;
  void draw_background();
  void draw_bodies(const FrameState& state, const PixelRect& pixels);
  void draw_burr(const FrameState& state);

  RenderSettings settings_;
  bool hurried_ = false;
  Detail detail_ = Detail::kFull, detail_drawn_ = Detail::kFull;
  Viewpoint from_;
  bool handpiece_ = true;
  HudParts hud_parts_;
  View view_;
  std::vector<std::unique_ptr<GlBody>> bodies_;    // the first: the workpiece
  std::vector<Eigen::AlignedBox3d> others_world_;  // a box for each of the others
  std::vector<const GlBody*> shown_;               // in the last picture
  GlBurr burr_;
  std::unique_ptr<GlFramebuffer> frame_;
  std::unique_ptr<GlFramebuffer> mirror_;  // once one has been drawn
  bool drawn_ = false;  // its layer of bodies is as of `view_`, but for `undrawn_`
  PixelRect undrawn_;
  PixelRect burr_before_;
  std::optional<Hud> hud_;  // once one has been drawn
  GlProgram background_program_, tooth_program_, smooth_program_;
  unsigned background_array_ = 0;
  std::optional<GlSection> section_;  // once one has been drawn
  std::optional<GlGhost> ghost_;
  double eye_offset_m_ = 0.0;
  std::unique_ptr<GlGeometry> geometry_;  // once one has been drawn
};

}  // namespace sulcus
