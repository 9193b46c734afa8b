#include "engine/normals/rough_columns.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "engine/normals/ldm_tuning.hpp"

namespace sulcus {

namespace {

using Short = std::int16_t;
/// In place of kNone: with it among three heights, second differences are beyond kFar, or all are
/// it.
constexpr Short kAbsent = 0x4000, kFar = 0x1000;

/// Of eight columns side by side; masks are -1 and 0.
using EightHeights = Short __attribute__((vector_size(16)));
using EightStored = signed char __attribute__((vector_size(8)));
constexpr int kTogether = 8;

EightHeights load(const Short* from) {
  EightHeights row;
  std::memcpy(&row, from, sizeof row);
  return row;
}

/// The heights of a map, with a row and a column of none around.
class Heights {
 public:
  explicit Heights(const HeightMap& map) {
    for (int row = -1; row <= 2 * map.ns + 1; ++row) {
      Short* const to = at(row, 0);
      to[-1] = to[map.lanes] = kAbsent;
      const bool is_there = row >= 0 && row <= 2 * map.ns;
      for (int lane = 0; lane < map.lanes; lane += kTogether) {
        EightHeights found = EightHeights{} + kAbsent;
        if (is_there) {
          EightStored bytes;
          std::memcpy(&bytes, map.height.data() + row * map.lanes + lane, sizeof bytes);
          found = __builtin_convertvector(bytes, EightHeights);
          const EightHeights none = found == Short{HeightMap::kNone};
          found = (found & ~none) | (none & kAbsent);
        }
        std::memcpy(to + lane, &found, sizeof found);
      }
    }
  }

  /// Which of the eight columns from there on are out of line.
  EightHeights out_of_line(int row, int lane) const {
    const Short* const here = at(row, lane);
    const EightHeights middle = load(here), twice = middle + middle;
    const auto is_beyond = [](const EightHeights& difference) {
      const EightHeights sign = difference >> 15, size = (difference ^ sign) - sign;
      return EightHeights((size >= kOutOfLine) & (size < kFar));
    };
    return is_beyond(load(here - 1) + load(here + 1) - twice) |
           is_beyond(load(here - kPitch) + load(here + kPitch) - twice);
  }

 private:
  static constexpr int kPitch = HeightMap::kMaxLanes + kTogether;

  Short* at(int row, int lane) { return heights_.data() + (row + 1) * kPitch + lane + 1; }
  const Short* at(int row, int lane) const {
    return heights_.data() + (row + 1) * kPitch + lane + 1;
  }

  std::array<Short, (HeightMap::kMaxRows + 2) * kPitch> heights_;
};

/// Of places: how many, and their sums.
struct Places {
  std::int64_t n = 0, i = 0, j = 0, ii = 0, ij = 0, jj = 0;

  /// Whether their principal variances are no less than that.
  bool spread_at_least(std::int64_t variance) const {
    // n^2 times the covariance, less the least along every direction.
    const std::int64_t along_i = n * ii - i * i - variance * n * n,
                       along_j = n * jj - j * j - variance * n * n, both = n * ij - i * j;
    return along_i >= 0 && along_j >= 0 && along_i * along_j >= both * both;
  }
};

}  // namespace

bool has_rough_columns(const HeightMap& map) noexcept {
  const Heights heights(map);
  Places places;
  for (int lane = 0; lane < map.lanes; lane += kTogether) {
    EightHeights count{}, sum_j{}, sum_jj{};
    for (int row = 0; row <= 2 * map.ns; ++row) {
      const EightHeights is_out = heights.out_of_line(row, lane);
      const auto j = static_cast<Short>(row - map.ns);
      count -= is_out;
      sum_j += is_out & j;
      sum_jj += is_out & static_cast<Short>(j * j);
    }
    for (int l = 0; l < kTogether; ++l) {
      const int i = lane + l - map.lanes / 2, n = count[l];
      places.n += n;
      places.i += n * i;
      places.ii += n * i * i;
      places.j += sum_j[l];
      places.ij += sum_j[l] * i;
      places.jj += sum_jj[l];
    }
  }
  return places.n >= kFewestOutOfLine && places.spread_at_least(kLeastSpread);
}

}  // namespace sulcus
