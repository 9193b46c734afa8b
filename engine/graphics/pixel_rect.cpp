#include "engine/graphics/pixel_rect.hpp"

#include <cmath>

namespace sulcus {

PixelRect pixels_of(const View& view, const Eigen::AlignedBox3f& box_world, int width, int height) {
  if (box_world.isEmpty()) return {};
  Eigen::AlignedBox2f seen;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector4f clip =
        view.clip_from_world *
        box_world.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)).homogeneous().eval();
    if (clip.w() <= 1e-6f) return {0, 0, width, height};
    seen.extend(Eigen::Vector2f(clip.head<2>() / clip.w()));
  }
  const auto pixel = [](float place, int pixels) {
    const float at = 0.5f * (std::clamp(place, -1.5f, 1.5f) + 1.0f) * static_cast<float>(pixels);
    return static_cast<int>(std::floor(at));
  };
  PixelRect rect{pixel(seen.min().x(), width), pixel(seen.min().y(), height), 0, 0};
  rect.width = pixel(seen.max().x(), width) + 1 - rect.x;
  rect.height = pixel(seen.max().y(), height) + 1 - rect.y;
  return rect.grown(1, width, height);
}

}  // namespace sulcus
