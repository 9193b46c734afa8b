#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sulcus {

/// Generalised winding number of a triangle soup [Jacobson et al. 2013]: 1 inside a closed mesh
/// whose triangles are counter-clockwise from outside, 0 outside, between them near holes. Far
/// groups of triangles count as one dipole [Barill et al. 2018, first order], which errs by
/// up to 0.03 against the sum over all triangles.
class WindingNumber {
 public:
  /// Positions in any one unit, which `at` then takes too.
  WindingNumber(const std::vector<Eigen::Vector3d>& positions,
                const std::vector<std::array<std::uint32_t, 3>>& triangles);

  /// Any thread. On a triangle itself it is one of the values of the two sides or between them.
  double at(const Eigen::Vector3d& p) const;

 private:
  struct Node {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of area
    Eigen::Vector3d dipole = Eigen::Vector3d::Zero();  // sum of area * normal
    double radius = 0.0;                               // of the ball about centre that holds all
    std::uint32_t first = 0, count = 0;                // triangles; a leaf has no children
    std::uint32_t right = 0;                           // 0: leaf; the left child follows its parent
  };
  using Corners = std::array<Eigen::Vector3d, 3>;

  void build(std::uint32_t node);

  std::vector<Corners> triangles_;  // in the order of the tree
  std::vector<Node> nodes_;         // depth first
};

}  // namespace sulcus
