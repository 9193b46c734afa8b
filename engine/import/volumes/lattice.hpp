#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// Values on a box of lattice points, x fastest: what importers work on before there are voxels.
template <class T>
struct Lattice {
  Eigen::Vector3i sizes = Eigen::Vector3i::Zero();
  std::vector<T> values;

  Lattice() = default;
  Lattice(const Eigen::Vector3i& box, T value)
      : sizes(box), values(static_cast<std::size_t>(box.cast<std::ptrdiff_t>().prod()), value) {}

  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(sizes.x()) *
               (static_cast<std::size_t>(j) +
                static_cast<std::size_t>(sizes.y()) * static_cast<std::size_t>(k));
  }
  T& at(int i, int j, int k) { return values[index(i, j, k)]; }
  const T& at(int i, int j, int k) const { return values[index(i, j, k)]; }
  bool contains(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < sizes.x() && j < sizes.y() && k < sizes.z();
  }
};

}  // namespace sulcus
