#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/graphics/overlay.hpp"

namespace sulcus {

std::vector<Overlay::Words> side_letters(const View& view, double aspect, double height,
                                         const WindowMargins& margins) {
  // As the cameras have them: mesial +x, buccal -y.
  const std::pair<const char*, Eigen::Vector3d> sides[]{{"M", Eigen::Vector3d::UnitX()},
                                                        {"D", -Eigen::Vector3d::UnitX()},
                                                        {"B", -Eigen::Vector3d::UnitY()},
                                                        {"L", Eigen::Vector3d::UnitY()}};
  const double half = 0.5 * height;
  const Eigen::Vector2d low(-aspect + margins.left / half, -1.0 + margins.bottom / half);
  const Eigen::Vector2d high(aspect - margins.right / half, 1.0 - margins.top / half);
  std::vector<Overlay::Words> letters;
  for (const auto& [name, side] : sides) {
    const Eigen::Vector2d way(side.dot(view.right_world.cast<double>()),
                              side.dot(view.up_world.cast<double>()));
    // One that points more towards the eye or away than across has no place at an edge.
    constexpr double kAcross = 0.5;
    if (way.norm() < kAcross) continue;
    double far = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 2; ++a) {
      if (way[a] > 0.0) far = std::min(far, high[a] / way[a]);
      if (way[a] < 0.0) far = std::min(far, low[a] / way[a]);
    }
    if (std::isfinite(far) && far > 0.0) letters.push_back({far * way, name});
  }
  return letters;
}

}  // namespace sulcus
