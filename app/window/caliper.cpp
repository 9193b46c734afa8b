#include "app/window/caliper.hpp"

#include <cmath>

#include "app/terminal/terminal.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

std::string place_text(const Eigen::Vector3d& point_world) {
  Eigen::Vector3d mm;
  for (int a = 0; a < 3; ++a) {
    mm[a] = std::round(1e3 * point_world[a] / kMillimetre) / 1e3 + 0.0;  // no -0.000
  }
  return formatted("[%.3f, %.3f, %.3f]", mm.x(), mm.y(), mm.z());
}

}  // namespace sulcus
