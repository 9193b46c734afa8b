#pragma once

#include "engine/graphics/camera.hpp"
#include "engine/graphics/window.hpp"

namespace sulcus {

/// A camera that the mouse turns round the tooth, moves and brings near; keys 1 to 5 take the named
/// ones.
class ViewCamera {
 public:
  explicit ViewCamera(Camera start);

  void turn(const WindowInput& input);  // by its drag
  void move(const WindowInput& input);
  /// What wheel and keys ask for.
  void follow(const WindowInput& input);
  Viewpoint from() const;

 private:
  void take(Camera named);

  double azimuth_deg_ = 0.0, elevation_deg_ = 0.0;
  Viewpoint at_;  // with its zoom and pan; direction by the angles
};

}  // namespace sulcus
