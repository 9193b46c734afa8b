#include "engine/normals/filled_tile.hpp"

#include <algorithm>
#include <bit>

#include "engine/normals/ldm_tuning.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

/// Voxels of a column's window, of 64, below the tile's first layer along the axis.
constexpr int kBelow = 16;

/// Surfaces of a column, outward; of the ends of the window the next voxel is not known.
std::uint64_t surfaces_of(std::uint64_t window, int sign) noexcept {
  return window & ~(sign > 0 ? window >> 1 : window << 1);
}
/// So many bits from one on.
constexpr std::uint64_t bits_from(int first, int count) {
  return (count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1) << first;
}

/// The surface nearest to bit `own`, the outer one of two.
int nearest_surface(std::uint64_t surfaces, int own, int sign) noexcept {
  const std::uint64_t upper = surfaces >> own, lower = surfaces & bits_from(0, own + 1);
  const int up = upper != 0 ? std::countr_zero(upper) : 64;
  const int down = lower != 0 ? own - (63 - std::countl_zero(lower)) : 64;
  return up < down || (up == down && sign > 0) ? own + up : own - down;
}

}  // namespace

void FilledTile::begin(const Workpiece& workpiece, const Cell& origin, int layers,
                       const MapAxes& axes, int ns, int reach) noexcept {
  workpiece_ = &workpiece;
  origin_ = origin;
  layers_ = layers;
  axes_ = axes;
  ns_ = ns;
  reach_ = reach;
  rows_read_ = 0;
  summed_ = {};
  made_ = {};
  nearly_ = {};
}

void FilledTile::read_row(int row) noexcept {
  const int axis = axes_.axis, sign = axes_.sign;
  const Cell& origin = origin_;
  const int innermost = kBelow + (sign > 0 ? 0 : layers_ - 1);  // bit
  // Outermost voxels of the surfaces that any voxel here may have, as column_lack counts.
  const int outward = layers_ - 1 + reach_ + kMostPartFilled;
  const std::uint64_t seen = sign > 0 ? bits_from(innermost - reach_, reach_ + outward + 1)
                                      : bits_from(innermost - outward, reach_ + outward + 1);
  const ColumnBits::Windows windows = workpiece_->columns().around(
      axis, origin[axes_.first()], origin[axes_.second()], origin[axis] - kBelow);
  LevelReader levels(workpiece_->model());
  std::int16_t* const to = height_[row];
  std::uint64_t several = 0, parts = 0;
  std::fill_n(to, kLanes, kNoHeight);
  const ColumnVoxel first = [&] {
    Cell at = origin;
    at[axes_.second()] += row - ns_;
    return ColumnVoxel(at, axes_);
  }();
  const int across_x = axes_.first() == 0, across_y = axes_.first() == 1,
            across_z = axes_.first() == 2;
  for (int u = -ns_; u < kLeafEdge + ns_; ++u) {
    const std::uint64_t surfaces = surfaces_of(windows.window(u, row - ns_), sign) & seen;
    if (surfaces == 0) continue;
    const std::uint64_t lane = std::uint64_t{1} << (kMargin + u);
    int bit = std::countr_zero(surfaces);
    if ((surfaces & (surfaces - 1)) != 0) {
      // The nearest to all layers, where it is that to the first and to the last of them.
      bit = nearest_surface(surfaces, innermost, sign);
      if (bit != nearest_surface(surfaces, innermost + sign * (layers_ - 1), sign)) {
        several |= lane;
        continue;
      }
    }
    ColumnVoxel outermost = first.inward(sign * (kBelow - bit));
    outermost.x += u * across_x, outermost.y += u * across_y, outermost.z += u * across_z;
    const std::optional<ColumnLack> lack = column_lack(levels, outermost, kMostPartFilled);
    if (!lack) continue;
    if (lack->parts != 0) parts |= lane;
    to[kMargin + u] =
        static_cast<std::int16_t>(kHeightParts * (sign * (bit - innermost)) - lack->parts);
  }
  several_[static_cast<std::size_t>(row)] = several;
  parts_[static_cast<std::size_t>(row)] = parts;
}

void FilledTile::read_about(int v) noexcept {
  const std::uint32_t wanted = ((2u << 2 * ns_) - 1u) << v;
  for (std::uint32_t rest = wanted & ~rows_read_; rest != 0; rest &= rest - 1) {
    read_row(std::countr_zero(rest));
  }
  rows_read_ |= wanted;
}

void FilledTile::sum_rows(std::size_t group, int rings, int v) noexcept {
  const std::uint32_t wanted = ((2u << 2 * rings) - 1u) << (ns_ + v - rings);
  std::uint32_t rest = wanted & ~summed_[group];
  summed_[group] |= wanted;
  for (; rest != 0; rest &= rest - 1) {
    const int row = std::countr_zero(rest);
    std::array<RowOfWindows, 4> windows{{{2, &small_rows_[1][group][row]},  //
                                         {3, &small_rows_[0][group][row]}}};
    int count = 2;
    if (group == kOwnGroup && ns_ > 4) windows[count++] = {4, &large_rows_[1][row]};
    if (group == kOwnGroup && ns_ > 3) windows[count++] = {ns_, &large_rows_[0][row]};
    const int first_u = (static_cast<int>(group) - kOwnGroup) * kLeafEdge;
    map_kernels().sum_row(&height_[row][kMargin + first_u], windows.data(), count);
  }
}

void FilledTile::make(const Small& small) noexcept {
  made_[1][small.which] |= std::uint64_t{1} << small.place();
  const int v = static_cast<int>(small.row) - kMostAside, rings = small.which == 0 ? 3 : 2;
  sum_rows(small.group, rings, v);
  WindowFits& fits = small_[small.which][small.row][small.group];
  map_kernels().fit_windows(&height_[ns_ + v][kMargin + small.first_u()],
                            &small_rows_[small.which][small.group][ns_ + v], window_filter(rings),
                            fits);
  std::uint32_t nearly = 0;
  for (unsigned k = 0; k < WindowFits::kSize; ++k) {
    nearly |= std::uint32_t{fits.mean_square[k] < kNearlyExplained * kNearlyExplained} << k;
  }
  nearly_[small.which][small.row] |= nearly << (small.group * kLeafEdge);
}

FilledTile::Fit FilledTile::fit(int rings, int u, int v) noexcept {
  if (rings <= 3) {
    const Small small(rings, u, v);
    if (!is_set(made_[1][small.which], small.place())) make(small);
    return {&small_[small.which][small.row][small.group], u - small.first_u()};
  }
  const std::size_t which = rings == ns_ ? 0 : 1;
  WindowFits& fits = large_[which][v];
  if (!is_set(made_[0][which], static_cast<std::size_t>(v))) {
    made_[0][which] |= std::uint64_t{1} << v;
    sum_rows(kOwnGroup, rings, v);
    map_kernels().fit_windows(&height_[ns_ + v][kMargin], &large_rows_[which][ns_ + v],
                              window_filter(rings), fits);
  }
  return {&fits, u};
}

}  // namespace sulcus
