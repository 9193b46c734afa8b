#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "engine/normals/filled_map.hpp"
#include "engine/normals/turned_map.hpp"

namespace sulcus {

/// A filled map as TurnedMap sees a traced one: with the coarse normal's components (map space)
/// x >= y >= 0, so that all that is computed from maps that are symmetric to one another is the
/// same to the bit.
class TurnedFilledMap {
 public:
  void turn(const FilledMap& map, const Eigen::Vector3f& coarse) noexcept;

  const FilledMap& map() const { return map_; }
  /// A direction of the map before as it is seen here, by the first of the turns.
  Eigen::Vector3f of(const Eigen::Vector3f& v) const { return turns_[0].of(v); }
  /// Whether the map is symmetric itself: then no direction that is not is seen in one way.
  bool is_symmetric() const { return count_ > 1; }
  /// A closest point on it as seen on the map before: the mean over all turns.
  ClosestPoint back(const ClosestPoint& closest) const noexcept;

 private:
  FilledMap map_;
  std::array<MapTurn, 8> turns_;
  std::size_t count_ = 0;
};

}  // namespace sulcus
