#include "engine/normals/turned_filled_map.hpp"

#include <algorithm>

namespace sulcus {

namespace {

void turn_heights(const FilledMap& map, const MapTurn& turn, FilledMap& to) noexcept {
  const int ns = map.ns, lanes = map.lanes, middle = ns * lanes + lanes / 2;
  std::fill_n(to.height.begin(), (2 * ns + 1) * lanes, FilledMap::kNone);
  // Places that a step along a row, and to the next row, of the map before is here.
  int along = turn.flip_x ? -1 : 1, next = turn.flip_y ? -lanes : lanes;
  if (turn.exchange) {
    along *= lanes;
    next /= lanes;
  }
  for (int j = -ns; j <= ns; ++j) {
    const std::int16_t* const from = map.height.data() + middle + j * lanes;
    std::int16_t* const row = to.height.data() + middle + j * next;
    for (int i = -ns; i <= ns; ++i) row[i * along] = from[i];
  }
}

}  // namespace

void TurnedFilledMap::turn(const FilledMap& map, const Eigen::Vector3f& coarse) noexcept {
  FilledMap other;
  for (FilledMap* const to : {&map_, &other}) {
    to->ns = map.ns;
    to->lanes = map.lanes;
  }
  const std::ptrdiff_t size = (2 * map.ns + 1) * map.lanes;
  count_ = 0;
  for (int n = 0; n < 8; ++n) {
    const MapTurn turn{(n & 1) != 0, (n & 2) != 0, (n & 4) != 0};
    if (!turn.is_allowed(coarse)) continue;
    if (count_ == 0) {
      turn_heights(map, turn, map_);
    } else {
      turn_heights(map, turn, other);
      const auto end = other.height.begin() + size;
      if (std::lexicographical_compare(map_.height.begin(), map_.height.begin() + size,
                                       other.height.begin(), end)) {
        continue;
      }
      if (!std::equal(other.height.begin(), end, map_.height.begin())) {
        std::copy(other.height.begin(), end, map_.height.begin());
        count_ = 0;
      }
    }
    turns_[count_++] = turn;
  }
}

ClosestPoint TurnedFilledMap::back(const ClosestPoint& closest) const noexcept {
  if (count_ == 1) return turns_[0].back(closest);
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  for (const MapTurn& turn : std::span(turns_).first(count_)) {
    const ClosestPoint one = turn.back(closest);
    normal += Eigen::Vector3f(one.normal_x, one.normal_y, one.normal_z);
  }
  normal.normalize();
  return {normal.x(), normal.y(), normal.z(), closest.offset};
}

}  // namespace sulcus
