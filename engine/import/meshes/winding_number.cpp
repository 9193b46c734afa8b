#include "engine/import/meshes/winding_number.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sulcus {
namespace {

constexpr std::uint32_t kLeafTriangles = 8;
// A group counts as a dipole from this many of its radii away. Measured on a molar of 44,000
// triangles against the sum over all: 2 errs by up to 0.07, 3 by up to 0.026 (root mean square
// 0.011), 4 by up to 0.013 and takes two to five times as long.
constexpr double kFarRadii = 3.0;

/// Signed solid angle of a triangle seen from the origin [Van Oosterom and Strackee 1983].
double solid_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double volume = a.dot(b.cross(c));
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return 2.0 * std::atan2(volume, denominator);
}

Eigen::Vector3d centroid(const std::array<Eigen::Vector3d, 3>& t) {
  return (t[0] + t[1] + t[2]) / 3.0;
}

}  // namespace

WindingNumber::WindingNumber(const std::vector<Eigen::Vector3d>& positions,
                             const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  triangles_.reserve(triangles.size());
  for (const auto& t : triangles) {
    triangles_.push_back({positions[t[0]], positions[t[1]], positions[t[2]]});
  }
  Node root;
  root.count = static_cast<std::uint32_t>(triangles_.size());
  nodes_.push_back(root);
  if (root.count > 0) build(0);
}

void WindingNumber::build(std::uint32_t index) {
  Node node = nodes_[index];
  const auto begin = triangles_.begin() + node.first;
  const auto end = begin + node.count;
  double area = 0.0;
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
  Eigen::AlignedBox3d box, centroids;
  for (auto t = begin; t != end; ++t) {
    const Eigen::Vector3d normal = 0.5 * ((*t)[1] - (*t)[0]).cross((*t)[2] - (*t)[0]);
    node.dipole += normal;
    area += normal.norm();
    weighted += normal.norm() * centroid(*t);
    centroids.extend(centroid(*t));
    for (const Eigen::Vector3d& corner : *t) box.extend(corner);
  }
  node.centre = area > 0.0 ? Eigen::Vector3d(weighted / area) : box.center();
  for (auto t = begin; t != end; ++t) {
    for (const Eigen::Vector3d& corner : *t) {
      node.radius = std::max(node.radius, (corner - node.centre).norm());
    }
  }
  if (node.count > kLeafTriangles) {
    int axis = 0;
    centroids.sizes().maxCoeff(&axis);
    const auto middle = begin + node.count / 2;
    std::nth_element(begin, middle, end, [axis](const Corners& a, const Corners& b) {
      return centroid(a)[axis] < centroid(b)[axis];
    });
    Node left, right;
    left.first = node.first;
    left.count = node.count / 2;
    right.first = node.first + left.count;
    right.count = node.count - left.count;
    const auto left_index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(left);
    build(left_index);
    node.right = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(right);
    build(node.right);
  }
  nodes_[index] = node;
}

double WindingNumber::at(const Eigen::Vector3d& p) const {
  // Halving keeps the tree 32 levels deep at most, and each leaves one node waiting.
  std::array<std::uint32_t, 64> waiting;
  std::size_t depth = 0;
  waiting[depth++] = 0;
  double angle = 0.0;
  while (depth > 0) {
    const std::uint32_t index = waiting[--depth];
    const Node& node = nodes_[index];
    const Eigen::Vector3d r = node.centre - p;
    const double distance2 = r.squaredNorm();
    if (distance2 > kFarRadii * kFarRadii * node.radius * node.radius) {
      angle += node.dipole.dot(r) / (distance2 * std::sqrt(distance2));
    } else if (node.right == 0) {
      for (std::uint32_t t = node.first; t < node.first + node.count; ++t) {
        const Corners& c = triangles_[t];
        angle += solid_angle(c[0] - p, c[1] - p, c[2] - p);
      }
    } else {
      waiting[depth++] = node.right;
      waiting[depth++] = index + 1;
    }
  }
  return angle / (4.0 * std::numbers::pi);
}

}  // namespace sulcus
