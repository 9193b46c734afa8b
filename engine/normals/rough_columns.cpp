#include "engine/normals/rough_columns.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "engine/normals/ldm_tuning.hpp"

namespace sulcus {

namespace {

using Flags = std::array<unsigned char, HeightMap::kMaxLanes>;

/// Flags of a row's columns that are out of line with those `step` before and after them, where all
/// three have heights.
void flag_out_of_line(const signed char* row, std::ptrdiff_t step, int lanes, Flags& flags) {
  for (int lane = 1; lane < lanes; ++lane) {
    const int before = row[lane - step], here = row[lane], after = row[lane + step];
    const bool found =
        (before != HeightMap::kNone) & (here != HeightMap::kNone) & (after != HeightMap::kNone);
    flags[static_cast<std::size_t>(lane)] |=
        static_cast<unsigned char>(found & (std::abs(before - 2 * here + after) >= kOutOfLine));
  }
}

}  // namespace

bool has_rough_columns(const HeightMap& map) noexcept {
  std::int64_t n = 0, i = 0, j = 0, ii = 0, ij = 0, jj = 0;
  for (int row = -map.ns; row <= map.ns; ++row) {
    const signed char* const heights = map.middle_row() + row * map.lanes;
    Flags flags{};
    flag_out_of_line(heights, 1, map.lanes, flags);
    if (std::abs(row) < map.ns) flag_out_of_line(heights, map.lanes, map.lanes, flags);
    int of_row = 0, i_of_row = 0, ii_of_row = 0;
    for (int lane = 1; lane < map.lanes; ++lane) {
      const int flag = flags[static_cast<std::size_t>(lane)], x = lane - map.lanes / 2;
      of_row += flag;
      i_of_row += flag * x;
      ii_of_row += flag * x * x;
    }
    n += of_row;
    i += i_of_row;
    ii += ii_of_row;
    j += of_row * row;
    ij += i_of_row * row;
    jj += of_row * row * row;
  }
  if (n < kFewestOutOfLine) return false;
  // n^2 times the covariance, less the least spread along every direction.
  const std::int64_t along_i = n * ii - i * i - kLeastSpread * n * n,
                     along_j = n * jj - j * j - kLeastSpread * n * n, both = n * ij - i * j;
  return along_i >= 0 && along_j >= 0 && along_i * along_j >= both * both;
}

}  // namespace sulcus
