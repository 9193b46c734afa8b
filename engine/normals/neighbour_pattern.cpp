#include "engine/normals/neighbour_pattern.hpp"

namespace sulcus {

const std::array<Eigen::Vector3i, 64>& projection_directions() {
  static const std::array<Eigen::Vector3i, 64> table = [] {
    std::array<Eigen::Vector3i, 64> directions;
    for (int pattern = 0; pattern < 64; ++pattern) {
      for (int axis = 0; axis < 3; ++axis) {
        // An opposing pair, both bits set, cancels.
        directions[pattern][axis] = (pattern >> (2 * axis + 1) & 1) - (pattern >> (2 * axis) & 1);
      }
    }
    return directions;
  }();
  return table;
}

std::uint8_t exposed_faces(const Workpiece& workpiece, const Cell& c) noexcept {
  int pattern = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Cell step = Cell::Unit(axis);
    pattern |= static_cast<int>(!workpiece.solid(c - step)) << (2 * axis);
    pattern |= static_cast<int>(!workpiece.solid(c + step)) << (2 * axis + 1);
  }
  return static_cast<std::uint8_t>(pattern);
}

}  // namespace sulcus
