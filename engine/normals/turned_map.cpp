#include "engine/normals/turned_map.hpp"

#include <cmath>
#include <cstring>

namespace sulcus {

namespace {

/// Sixteen lanes of a row, or of a column: i = -8 to 7, or j.
using Bytes = signed char __attribute__((vector_size(16)));
constexpr int kLanes = 16, kMiddle = kLanes / 2;

/// What is at i comes to -i; the first lane has no other.
Bytes reversed(const Bytes& row) {
  return __builtin_shuffle(row, Bytes{0, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1});
}
/// Rows become columns: by halves that are interleaved, four times.
void transpose(std::array<Bytes, kLanes>& rows) {
  constexpr Bytes kLow{0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23},
      kHigh{8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31};
  for (int pass = 0; pass < 4; ++pass) {
    std::array<Bytes, kLanes> to;
    for (std::size_t r = 0; r < kLanes / 2; ++r) {
      to[2 * r] = __builtin_shuffle(rows[r], rows[r + kLanes / 2], kLow);
      to[2 * r + 1] = __builtin_shuffle(rows[r], rows[r + kLanes / 2], kHigh);
    }
    rows = to;
  }
}

/// Of a map of sixteen lanes.
void turn_narrow(const HeightMap& map, const MapTurn& turn, HeightMap& to) noexcept {
  const int ns = map.ns;
  std::array<Bytes, kLanes> rows;
  rows.fill(Bytes{} + HeightMap::kNone);
  for (int j = -ns; j <= ns; ++j) {
    Bytes& row = rows[static_cast<std::size_t>(kMiddle + (turn.flip_y ? -j : j))];
    std::memcpy(&row, map.height.data() + (ns + j) * kLanes, sizeof row);
    if (map.sign < 0) row = -row;  // kNone stays
    if (turn.flip_x) row = reversed(row);
  }
  if (turn.exchange) transpose(rows);
  std::memcpy(to.height.data(), &rows[static_cast<std::size_t>(kMiddle - ns)],
              static_cast<std::size_t>((2 * ns + 1) * kLanes));
}

/// Of any map.
void turn_wide(const HeightMap& map, const MapTurn& turn, HeightMap& to) noexcept {
  const int ns = map.ns;
  const int step_x = turn.flip_x ? -1 : 1, step_y = (turn.flip_y ? -1 : 1) * map.lanes;
  const int along = turn.exchange ? step_y : step_x, across = turn.exchange ? step_x : step_y;
  const signed char* const middle = map.height.data() + map.place(0, 0);
  std::memset(to.height.data(), HeightMap::kNone,
              static_cast<std::size_t>((2 * ns + 1) * map.lanes));
  for (int j = -ns; j <= ns; ++j) {
    const signed char* const from = middle + j * across;
    signed char* const row = to.height.data() + to.place(0, j);
    for (int i = -ns; i <= ns; ++i) row[i] = from[i * along];
  }
  if (map.sign > 0) return;
  for (int k = 0; k < (2 * ns + 1) * map.lanes; ++k) {
    signed char& height = to.height[static_cast<std::size_t>(k)];
    height = static_cast<signed char>(-height);  // kNone stays
  }
}

void turn_heights(const HeightMap& map, const MapTurn& turn, HeightMap& to) noexcept {
  map.lanes == kLanes ? turn_narrow(map, turn, to) : turn_wide(map, turn, to);
}

}  // namespace

void TurnedMap::turn(const HeightMap& map, const Eigen::Vector3f& coarse) noexcept {
  const float x = std::abs(coarse.x()), y = std::abs(coarse.y());
  HeightMap other;
  for (HeightMap* const to : {&map_, &other}) {
    to->ns = map.ns;
    to->stride = map.stride;
    to->sign = 1;
    to->lanes = map.lanes;
    to->whole_rings = map.whole_rings;
    to->even_rings = map.even_rings;
  }
  count_ = 0;
  const auto size = static_cast<std::size_t>((2 * map.ns + 1) * map.lanes);
  for (int n = 0; n < 8; ++n) {
    const MapTurn turn{(n & 1) != 0, (n & 2) != 0, (n & 4) != 0};
    const bool is_allowed = (x == 0.0f || turn.flip_x == (coarse.x() < 0.0f)) &&
                            (y == 0.0f || turn.flip_y == (coarse.y() < 0.0f)) &&
                            (x == y || turn.exchange == (y > x));
    if (!is_allowed) continue;
    turn_heights(map, turn, count_ == 0 ? map_ : other);
    const int order = count_ == 0 ? 0 : std::memcmp(other.height.data(), map_.height.data(), size);
    if (order > 0) continue;
    if (order < 0) {
      map_ = other;
      count_ = 0;
    }
    turns_[count_++] = turn;
  }
}

ClosestPoint TurnedMap::back(const ClosestPoint& closest) const noexcept {
  if (count_ == 1) return turns_[0].back(closest);
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  for (const MapTurn& turn : turns()) {
    const ClosestPoint one = turn.back(closest);
    normal += Eigen::Vector3f(one.normal_x, one.normal_y, one.normal_z);
  }
  normal.normalize();
  return {normal.x(), normal.y(), normal.z(), closest.offset};
}

}  // namespace sulcus
