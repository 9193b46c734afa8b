#include "engine/graphics/gl_burr.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <epoxy/gl.h>

#include "engine/graphics/burr_shading.hpp"
#include "engine/graphics/shaders.hpp"
#include "engine/tool/burr_mesh.hpp"

namespace sulcus {

GlBurr::GlBurr(const TriangleMesh& mesh_tool, double head_length_m)
    : program_("burr", kBurrVertex, kBurrFragment), head_length_m_(head_length_m) {
  for (const Eigen::Vector3f& p : mesh_tool.positions) {
    box_tool_.extend(p);
    if (p.y() > head_length_m_) continue;
    radius_m_ = std::max(radius_m_, static_cast<double>(std::hypot(p.x(), p.z())));
  }
  std::vector<BurrCorner> corners = shaded_corners(mesh_tool);
  corner_count_ = static_cast<int>(corners.size());
  const TriangleMesh handpiece = handpiece_mesh(mesh_tool, head_length_m);
  for (const Eigen::Vector3f& p : handpiece.positions) handpiece_box_tool_.extend(p);
  const std::vector<BurrCorner> more = shaded_corners(handpiece);
  handpiece_corner_count_ = static_cast<int>(more.size());
  corners.insert(corners.end(), more.begin(), more.end());
  bytes_ = corners.size() * sizeof(BurrCorner);
  if (corners.empty()) return;
  glGenVertexArrays(1, &array_);
  glGenBuffers(1, &corners_);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes_), corners.data(), GL_STATIC_DRAW);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(BurrCorner), nullptr);
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(BurrCorner),
                        reinterpret_cast<void*>(offsetof(BurrCorner, normal_tool)));
  for (const GLuint attribute : {0u, 1u}) glEnableVertexAttribArray(attribute);
}

GlBurr::~GlBurr() {
  if (array_ == 0) return;
  glDeleteVertexArrays(1, &array_);
  glDeleteBuffers(1, &corners_);
}

Eigen::AlignedBox3f GlBurr::box_world(const Pose& world_from_tool, bool with_handpiece) const {
  Eigen::AlignedBox3f box = moved_box(box_tool_, world_from_tool);
  if (with_handpiece) box.extend(moved_box(handpiece_box_tool_, world_from_tool));
  return box;
}

void GlBurr::draw(const View& view, const Pose& world_from_tool, double turn_rad,
                  bool with_handpiece, float alpha) {
  if (corner_count_ == 0) return;
  program_.use();
  program_.set("clip_from_world", view.clip_from_world);
  program_.set("world_from_tool", Eigen::Matrix4f(matrix_of(world_from_tool).cast<float>()));
  program_.set("eye_world", view.eye_world);
  program_.set("right_world", view.right_world);
  program_.set("up_world", view.up_world);
  program_.set("back_world", view.back_world);
  program_.set("head_length", static_cast<float>(std::max(head_length_m_, 1e-6)));
  program_.set("head_radius", static_cast<float>(std::max(radius_m_, 1e-6)));
  // Whole turns are taken off before the precision of a float would show.
  program_.set("turn", static_cast<float>(std::remainder(turn_rad, 2 * std::numbers::pi)));
  program_.set("alpha", alpha);
  glBindVertexArray(array_);
  glDrawArrays(GL_TRIANGLES, 0, corner_count_ + (with_handpiece ? handpiece_corner_count_ : 0));
}

void GlBurr::draw_parts(GlProgram& program, const Pose& world_from_tool, int burr_object,
                        int handpiece_object, bool with_handpiece) const {
  if (corner_count_ == 0) return;
  program.set("world_from_model", Eigen::Matrix4f(matrix_of(world_from_tool).cast<float>()));
  glBindVertexArray(array_);
  program.set("object", burr_object);
  glDrawArrays(GL_TRIANGLES, 0, corner_count_);
  if (!with_handpiece) return;
  program.set("object", handpiece_object);
  glDrawArrays(GL_TRIANGLES, corner_count_, handpiece_corner_count_);
}

}  // namespace sulcus
