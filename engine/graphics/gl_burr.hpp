#pragma once

#include <cstddef>

#include "engine/core/pose.hpp"
#include "engine/core/triangle_mesh.hpp"
#include "engine/graphics/camera.hpp"
#include "engine/graphics/gl_program.hpp"

namespace sulcus {

/// The burr as OpenGL draws it, and the handpiece that it hangs in. Made, used and destroyed with
/// the same OpenGL context current.
class GlBurr {
 public:
  /// `mesh_tool`: tool space, m, may be empty; blades are shown up to `head_length_m` from the tip.
  GlBurr(const TriangleMesh& mesh_tool, double head_length_m);
  ~GlBurr();
  GlBurr(const GlBurr&) = delete;
  GlBurr& operator=(const GlBurr&) = delete;

  /// `turn_rad`: of the spindle, about the tool's +y; the handpiece does not turn. `alpha`: below 1
  /// it is blended over what is there.
  void draw(const View& view, const Pose& world_from_tool, double turn_rad, bool with_handpiece,
            float alpha = 1.0f);

  /// The same, by another program of kGeometryVertex, whose "object" says which of the two it is.
  void draw_parts(GlProgram& program, const Pose& world_from_tool, int burr_object,
                  int handpiece_object, bool with_handpiece) const;

  /// A box, world, that holds it at a pose.
  Eigen::AlignedBox3f box_world(const Pose& world_from_tool, bool with_handpiece) const;
  double radius_m() const { return radius_m_; }  // of the head
  std::size_t bytes() const { return bytes_; }

 private:
  GlProgram program_;
  double head_length_m_;
  double radius_m_ = 0.0;
  unsigned array_ = 0, corners_ = 0;
  int corner_count_ = 0, handpiece_corner_count_ = 0;  // the burr's are first
  std::size_t bytes_ = 0;
  Eigen::AlignedBox3f box_tool_, handpiece_box_tool_;
};

}  // namespace sulcus
