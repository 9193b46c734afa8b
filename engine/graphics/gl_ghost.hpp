#pragma once

#include <optional>
#include <vector>

#include "engine/graphics/camera.hpp"
#include "engine/graphics/gl_mesh.hpp"
#include "engine/graphics/gl_program.hpp"
#include "engine/graphics/gl_section.hpp"
#include "engine/surface/drawn_surface.hpp"

namespace sulcus {

/// A shape that is not there, such as the cavity that was planned: drawn palely over whatever is
/// there, and with its outline on the face of a section. Made, used and destroyed with the same
/// OpenGL context current.
class GlGhost {
 public:
  /// `shape`: on the grid of the workpiece.
  explicit GlGhost(VoxelModel shape);

  /// Blends it over the colours of the bound framebuffer; what lies before a section is left out.
  void draw(const View& view, const std::optional<Section>& section);

 private:
  DrawnSurface surface_;
  std::vector<GlMesh> bricks_;
  GlProgram walls_, face_;
  GlSection section_;
};

}  // namespace sulcus
