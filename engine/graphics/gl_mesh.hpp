#pragma once

#include <cstddef>

#include <Eigen/Geometry>

#include "engine/surface/drawn_surface.hpp"
#include "engine/surface/normal_cone.hpp"

namespace sulcus {

/// A brick of a drawn surface, or a piece, in the graphics card's memory. Made, used and destroyed
/// with the same OpenGL context current.
class GlMesh {
 public:
  GlMesh() = default;
  ~GlMesh();
  GlMesh(const GlMesh&) = delete;
  GlMesh& operator=(const GlMesh&) = delete;

  /// In place of what it held.
  void upload(const DrawnMesh& mesh);
  bool empty() const { return index_count_ == 0; }
  void draw() const;

  const NormalCone& cone() const { return cone_; }
  /// Its box, in the space of its vertices, m; of the last that was not empty.
  const Eigen::AlignedBox3f& box() const { return box_; }
  std::size_t triangle_count() const { return static_cast<std::size_t>(index_count_) / 3; }
  std::size_t bytes() const { return bytes_; }

 private:
  unsigned array_ = 0, vertices_ = 0, indices_ = 0;
  int index_count_ = 0;
  std::size_t bytes_ = 0;
  Eigen::AlignedBox3f box_;
  NormalCone cone_;
};

}  // namespace sulcus
