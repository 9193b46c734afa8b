#include "engine/graphics/gl_mesh.hpp"

#include <epoxy/gl.h>

namespace sulcus {
namespace {

void* buffer_offset(std::size_t bytes) { return reinterpret_cast<void*>(bytes); }

}  // namespace

GlMesh::~GlMesh() {
  if (array_ == 0) return;
  glDeleteVertexArrays(1, &array_);
  glDeleteBuffers(1, &vertices_);
  glDeleteBuffers(1, &indices_);
}

void GlMesh::upload(const DrawnMesh& mesh) {
  index_count_ = static_cast<int>(mesh.indices.size());
  bytes_ = mesh.vertices.size() * sizeof(DrawnVertex) + mesh.indices.size() * 4;
  if (mesh.indices.empty()) return;  // its buffers, if any, wait for the next time
  if (array_ == 0) {
    glGenVertexArrays(1, &array_);
    glGenBuffers(1, &vertices_);
    glGenBuffers(1, &indices_);
    glBindVertexArray(array_);
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
    constexpr GLsizei stride = sizeof(DrawnVertex);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, nullptr);
    glVertexAttribPointer(1, 4, GL_SHORT, GL_TRUE, stride,
                          buffer_offset(offsetof(DrawnVertex, normal)));
    glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
                          buffer_offset(offsetof(DrawnVertex, colour_cut)));
    for (const GLuint attribute : {0u, 1u, 2u}) glEnableVertexAttribArray(attribute);
  }
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(DrawnVertex)),
               mesh.vertices.data(), GL_STATIC_DRAW);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.indices.size() * 4),
               mesh.indices.data(), GL_STATIC_DRAW);
  box_.setEmpty();
  for (const DrawnVertex& v : mesh.vertices) {
    box_.extend(Eigen::Vector3f(v.position_m[0], v.position_m[1], v.position_m[2]));
  }
  cone_ = normal_cone(mesh);
}

void GlMesh::draw() const {
  if (empty()) return;
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace sulcus
