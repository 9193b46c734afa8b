#include "engine/normals/coarse_normal.hpp"

#include <array>
#include <cmath>
#include <cstdint>

namespace sulcus {

namespace {

constexpr double kUnit = 4096.0;

/// Sums over the solid voxels of five along x, at distance |(j, k)| from the axis.
struct RowSums {
  std::int32_t x = 0;        // sum of i / d
  std::int32_t inverse = 0;  // sum of 1 / d
};

/// By j^2 + k^2 and the bit pattern of the five; voxels beyond 2.5 and the centre count nothing.
using RowTable = std::array<std::array<RowSums, 32>, 6>;

const RowTable kRows = [] {
  RowTable table;
  for (int jk = 0; jk < 6; ++jk) {
    for (int pattern = 0; pattern < 32; ++pattern) {
      for (int bit = 0; bit < 5; ++bit) {
        const int i = bit - 2, d2 = i * i + jk;
        if ((pattern >> bit & 1) == 0 || d2 == 0 || d2 > 6) continue;  // 6 < 2.5^2 < 7
        const auto inverse = static_cast<std::int32_t>(std::lround(kUnit / std::sqrt(d2)));
        table[jk][pattern].x += i * inverse;
        table[jk][pattern].inverse += inverse;
      }
    }
  }
  return table;
}();

}  // namespace

Eigen::Vector3i coarse_normal(const Workpiece& workpiece, const Cell& c) noexcept {
  const ColumnBits::Windows rows = workpiece.columns().around(0, c.y(), c.z(), c.x() - 2);
  std::int32_t x = 0, y = 0, z = 0;
  const auto add = [&](int j, int k) {
    const std::uint32_t* w = rows.words + j + k * rows.row;
    const std::uint64_t both = w[0] | std::uint64_t{w[rows.plane]} << 32;
    const RowSums& row = kRows[j * j + k * k][both >> rows.shift & 31u];
    x += row.x;
    y += j * row.inverse;
    z += k * row.inverse;
  };
  add(-1, -2), add(0, -2), add(1, -2);
  for (int k = -1; k <= 1; ++k) {
    add(-2, k), add(-1, k), add(0, k), add(1, k), add(2, k);
  }
  add(-1, 2), add(0, 2), add(1, 2);
  return {-x, -y, -z};
}

}  // namespace sulcus
