#include "engine/normals/turned_map.hpp"

#include <cmath>
#include <cstring>
#include <utility>

namespace sulcus {

namespace {

/// Sixteen lanes of a row.
using Bytes = signed char __attribute__((vector_size(16)));
using Block = std::array<Bytes, 16>;

/// Rows become columns: halves are interleaved, four times.
void transpose(Block& rows) {
  for (int pass = 0; pass < 4; ++pass) {
    Block to;
    for (std::size_t r = 0; r < 8; ++r) {
      to[2 * r] = __builtin_shufflevector(rows[r], rows[r + 8], 0, 16, 1, 17, 2, 18, 3, 19, 4, 20,
                                          5, 21, 6, 22, 7, 23);
      to[2 * r + 1] = __builtin_shufflevector(rows[r], rows[r + 8], 8, 24, 9, 25, 10, 26, 11, 27,
                                              12, 28, 13, 29, 14, 30, 15, 31);
    }
    rows = to;
  }
}

/// A map of so many lanes as a square of blocks, the voxel's column in its middle.
template <int kLanes>
class Square {
 public:
  explicit Square(const HeightMap& map) {
    for (auto& part : block_) {
      for (Block& block : part) block.fill(Bytes{} + HeightMap::kNone);
    }
    for (int j = -map.ns; j <= map.ns; ++j) {
      for (std::size_t part = 0; part < kParts; ++part) {
        Bytes& row = at(j, part);
        std::memcpy(&row, map.height.data() + (map.ns + j) * kLanes + 16 * part, sizeof row);
        if (map.sign < 0) row = -row;  // kNone stays
      }
    }
  }
  void turn(const MapTurn& turn, int ns) {
    if (turn.flip_y) flip(ns);
    if (!turn.flip_x && !turn.exchange) return;
    exchange();
    if (turn.flip_x) flip(ns);
    if (!turn.exchange) exchange();
  }
  void store(HeightMap& map) {
    for (int j = -map.ns; j <= map.ns; ++j) {
      for (std::size_t part = 0; part < kParts; ++part) {
        std::memcpy(map.height.data() + (map.ns + j) * kLanes + 16 * part, &at(j, part), 16);
      }
    }
  }

 private:
  static constexpr std::size_t kParts = kLanes / 16;

  Bytes& at(int j, std::size_t part) {
    const auto row = static_cast<std::size_t>(kLanes / 2 + j);
    return block_[row / 16][part][row % 16];
  }
  void flip(int ns) {
    for (int j = 1; j <= ns; ++j) {
      for (std::size_t part = 0; part < kParts; ++part) std::swap(at(j, part), at(-j, part));
    }
  }
  void exchange() {
    for (std::size_t p = 0; p < kParts; ++p) {
      for (std::size_t q = 0; q < kParts; ++q) transpose(block_[p][q]);
      for (std::size_t q = 0; q < p; ++q) std::swap(block_[p][q], block_[q][p]);
    }
  }

  std::array<std::array<Block, kParts>, kParts> block_;  // by rows, by lanes
};

template <int kLanes>
void turn_heights(const HeightMap& map, const MapTurn& turn, HeightMap& to) noexcept {
  Square<kLanes> square(map);
  square.turn(turn, map.ns);
  square.store(to);
}
void turn_heights(const HeightMap& map, const MapTurn& turn, HeightMap& to) noexcept {
  map.lanes == 16 ? turn_heights<16>(map, turn, to) : turn_heights<32>(map, turn, to);
}

}  // namespace

void TurnedMap::turn(const HeightMap& map, const Eigen::Vector3f& coarse) noexcept {
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
    if (!turn.is_allowed(coarse)) continue;
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
