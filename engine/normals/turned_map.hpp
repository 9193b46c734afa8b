#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"

namespace sulcus {

/// One of the eight symmetries of a map's columns: x and y change sign, then they are exchanged.
struct MapTurn {
  bool flip_x = false, flip_y = false, exchange = false;

  /// Whether it makes a coarse normal's components x >= y >= 0.
  bool is_allowed(const Eigen::Vector3f& coarse) const {
    const float x = std::abs(coarse.x()), y = std::abs(coarse.y());
    return (x == 0.0f || flip_x == (coarse.x() < 0.0f)) &&
           (y == 0.0f || flip_y == (coarse.y() < 0.0f)) && (x == y || exchange == (y > x));
  }
  Eigen::Vector3f of(const Eigen::Vector3f& v) const {
    const float x = flip_x ? -v.x() : v.x(), y = flip_y ? -v.y() : v.y();
    return exchange ? Eigen::Vector3f(y, x, v.z()) : Eigen::Vector3f(x, y, v.z());
  }
  ClosestPoint back(const ClosestPoint& closest) const {
    const float x = exchange ? closest.normal_y : closest.normal_x,
                y = exchange ? closest.normal_x : closest.normal_y;
    return {flip_x ? -x : x, flip_y ? -y : y, closest.normal_z, closest.offset};
  }
};

/// A map as it is seen with the coarse normal's components (map space) x >= y >= 0, and outward
/// upward: what is computed from it is the same to the bit for all maps that are symmetric to one
/// another. Where the coarse normal allows several turns, it is by those to the map that comes
/// first by its heights; `turns` are all of them, more than one where the map is symmetric itself.
class TurnedMap {
 public:
  /// Of a map of stride 1.
  void turn(const HeightMap& map, const Eigen::Vector3f& coarse) noexcept;

  const HeightMap& map() const { return map_; }
  std::span<const MapTurn> turns() const { return std::span(turns_).first(count_); }
  /// A closest point on it as seen on the map before: the mean over all turns.
  ClosestPoint back(const ClosestPoint& closest) const noexcept;

 private:
  HeightMap map_;
  std::array<MapTurn, 8> turns_;
  std::size_t count_ = 0;
};

}  // namespace sulcus
