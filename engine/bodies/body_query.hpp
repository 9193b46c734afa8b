#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Geometry>

namespace sulcus {

/// Asks which bodies a box reaches, without naming the library that keeps them: the haptic core
/// links without Bullet. `find` writes body numbers, ascending, and returns how many; it neither
/// allocates nor changes anything.
struct BodyQuery {
  const void* bodies = nullptr;
  std::size_t (*find)(const void* bodies, const Eigen::AlignedBox3d& box_world,
                      std::span<std::uint16_t> found) noexcept = nullptr;
};

}  // namespace sulcus
