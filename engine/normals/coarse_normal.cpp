#include "engine/normals/coarse_normal.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "engine/normals/map_kernels.hpp"

namespace sulcus {

Eigen::Vector3i coarse_normal(const Workpiece& workpiece, const Cell& c) noexcept {
  std::array<std::int32_t, 3> sums;
  const ColumnBits::Windows rows = coarse_rows(workpiece, c);
  map_kernels().coarse(&rows, 1, &sums);
  return {-sums[0], -sums[1], -sums[2]};
}

namespace {

// Every other voxel of 13 x 13 x 13, 7 to a row.
constexpr int kStep = 2, kSteps = 3;
/// By the bits of such a row: how many are set, and the sum of their offsets from the middle.
struct RowSum {
  std::int8_t count = 0, offsets = 0;
};
constexpr std::array<RowSum, 1 << (2 * kSteps + 1)> kRowSums = [] {
  std::array<RowSum, 1 << (2 * kSteps + 1)> sums;
  for (unsigned bits = 0; bits < sums.size(); ++bits) {
    for (int i = -kSteps; i <= kSteps; ++i) {
      if ((bits >> (i + kSteps) & 1) == 0) continue;
      sums[bits].count = static_cast<std::int8_t>(sums[bits].count + 1);
      sums[bits].offsets = static_cast<std::int8_t>(sums[bits].offsets + i);
    }
  }
  return sums;
}();
/// Bits 0, 2 .. 12 together.
constexpr unsigned even_bits(std::uint64_t row) {
  auto bits = static_cast<unsigned>(row) & 0x1555u;
  bits = (bits | bits >> 1) & 0x3333u;
  bits = (bits | bits >> 2) & 0x0f0fu;
  return (bits | bits >> 4) & 0x7fu;
}

}  // namespace

Eigen::Vector3i solid_offsets(const Workpiece& workpiece, const Cell& c,
                              int neighbourhood) noexcept {
  const int steps = std::min(kSteps, neighbourhood / kStep);
  const unsigned within = ((2u << (2 * steps)) - 1u) << (kSteps - steps);
  const ColumnBits::Windows rows =
      workpiece.columns().around(0, c.y(), c.z(), c.x() - kStep * kSteps);
  int x = 0, y = 0, z = 0;
  for (int k = -steps; k <= steps; ++k) {
    int in_layer = 0;
    for (int j = -steps; j <= steps; ++j) {
      const RowSum sum = kRowSums[even_bits(rows.window(kStep * j, kStep * k)) & within];
      x += sum.offsets;
      y += j * sum.count;
      in_layer += sum.count;
    }
    z += k * in_layer;
  }
  return {x, y, z};
}

}  // namespace sulcus
