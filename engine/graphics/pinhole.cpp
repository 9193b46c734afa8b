#include "engine/graphics/pinhole.hpp"

namespace sulcus {

Pinhole pinhole_of(const View& view, int width, int height) {
  Pinhole pinhole;
  pinhole.focal_pixels = view.focal_pixels;
  pinhole.centre_pixels = {0.5 * (width - 1), 0.5 * (height - 1)};
  pinhole.near_m = view.near_m;
  pinhole.far_m = view.far_m;
  pinhole.world_from_camera.block<3, 1>(0, 0) = view.right_world.cast<double>();
  pinhole.world_from_camera.block<3, 1>(0, 1) = -view.up_world.cast<double>();
  pinhole.world_from_camera.block<3, 1>(0, 2) = -view.back_world.cast<double>();
  pinhole.world_from_camera.block<3, 1>(0, 3) = view.eye_world.cast<double>();
  return pinhole;
}

}  // namespace sulcus
