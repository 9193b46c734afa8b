#include "engine/import/meshes/cut_polygon.hpp"

#include <cstddef>

#include <Eigen/Geometry>

namespace sulcus {
namespace {

/// Twice the signed area of a triangle: above 0 where a, b, c turn to the left.
double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// A ring of corners that loses one after another.
class ClippedPolygon {
 public:
  ClippedPolygon(const std::vector<Eigen::Vector3f>& positions,
                 std::span<const std::uint32_t> polygon)
      : polygon_(polygon), corners_(polygon.size()) {
    lay_down(positions);
    const std::size_t count = polygon.size();
    for (std::size_t c = 0; c < count; ++c) {
      corners_[c].before = c == 0 ? count - 1 : c - 1;
      corners_[c].after = c + 1 == count ? 0 : c + 1;
    }
    for (std::size_t c = 0; c < count; ++c) {
      corners_[c].turn = turn_at(c);
      if (!(corners_[c].turn > 0.0)) blocking_.push_back(c);
    }
    for (std::size_t c = 0; c < count; ++c) corners_[c].ear = is_ear(c);
  }

  void cut(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::size_t at = 1;  // a convex polygon becomes a fan about its first corner
    for (std::size_t left = corners_.size(); left > 3; --left) {
      at = next_to_clip(at, left);
      triangles.push_back(triangle(at));
      const auto [before, after] = unlink(at);
      update(before);
      update(after);
      at = after;
    }
    triangles.push_back(triangle(at));
  }

 private:
  struct Corner {
    std::size_t before = 0, after = 0;
    double turn = 0.0;  // as turn() of it and its neighbours
    bool ear = false, clipped = false;
  };

  /// Onto the plane of two axes that the polygon covers most of, turned to the left.
  void lay_down(const std::vector<Eigen::Vector3f>& positions) {
    const Eigen::Vector3d origin = positions[polygon_.front()].cast<double>();
    const auto corner = [&](std::size_t c) -> Eigen::Vector3d {
      return positions[polygon_[c]].cast<double>() - origin;
    };
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (std::size_t c = 1; c + 1 < polygon_.size(); ++c) normal += corner(c).cross(corner(c + 1));
    int dropped = 0;
    normal.cwiseAbs().maxCoeff(&dropped);
    int u = (dropped + 1) % 3, v = (dropped + 2) % 3;
    if (normal[dropped] < 0.0) std::swap(u, v);
    plane_.reserve(polygon_.size());
    for (const std::uint32_t vertex : polygon_) {
      const Eigen::Vector3d p = positions[vertex].cast<double>();
      plane_.emplace_back(p[u], p[v]);
    }
  }

  double turn_at(std::size_t c) const {
    return turn(plane_[corners_[c].before], plane_[c], plane_[corners_[c].after]);
  }

  /// Whether the triangle at a corner lies within the polygon and has no other corner in it or on
  /// its edges: only one that is not convex itself can be there.
  bool is_ear(std::size_t c) const {
    if (!(corners_[c].turn > 0.0)) return false;
    const std::size_t before = corners_[c].before, after = corners_[c].after;
    const Eigen::Vector2d &a = plane_[before], &b = plane_[c], &d = plane_[after];
    for (const std::size_t r : blocking_) {
      if (corners_[r].turn > 0.0 || corners_[r].clipped) continue;
      const std::uint32_t vertex = polygon_[r];  // a slit's corners are there twice
      if (vertex == polygon_[before] || vertex == polygon_[c] || vertex == polygon_[after]) {
        continue;
      }
      const Eigen::Vector2d& p = plane_[r];
      if (turn(a, b, p) >= 0.0 && turn(b, d, p) >= 0.0 && turn(d, a, p) >= 0.0) return false;
    }
    return true;
  }

  /// The next ear. Where there is none, the polygon crosses itself or is a line: then a corner in a
  /// line with its neighbours, whose triangle covers nothing, or else a convex one.
  std::size_t next_to_clip(std::size_t from, std::size_t left) const {
    const auto rank = [&](std::size_t c) {
      return corners_[c].turn == 0.0 ? 2 : corners_[c].turn > 0.0 ? 1 : 0;
    };
    std::size_t best = from;
    for (std::size_t c = from, step = 0; step < left; c = corners_[c].after, ++step) {
      if (corners_[c].ear) return c;
      if (rank(c) > rank(best)) best = c;
    }
    return best;
  }

  std::array<std::uint32_t, 3> triangle(std::size_t c) const {
    return {polygon_[corners_[c].before], polygon_[c], polygon_[corners_[c].after]};
  }

  std::array<std::size_t, 2> unlink(std::size_t c) {
    const std::size_t before = corners_[c].before, after = corners_[c].after;
    corners_[before].after = after;
    corners_[after].before = before;
    corners_[c].clipped = true;
    return {before, after};
  }

  void update(std::size_t c) {
    const bool was_convex = corners_[c].turn > 0.0;
    corners_[c].turn = turn_at(c);
    // Never beside an ear, but of what crosses itself.
    if (was_convex && !(corners_[c].turn > 0.0)) blocking_.push_back(c);
    corners_[c].ear = is_ear(c);
  }

  std::span<const std::uint32_t> polygon_;
  std::vector<Eigen::Vector2d> plane_;
  std::vector<Corner> corners_;
  std::vector<std::size_t> blocking_;  // not convex, or once so
};

}  // namespace

void cut_polygon(const std::vector<Eigen::Vector3f>& positions,
                 std::span<const std::uint32_t> polygon,
                 std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (polygon.size() == 3) {
    triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return;
  }
  ClippedPolygon(positions, polygon).cut(triangles);
}

}  // namespace sulcus
