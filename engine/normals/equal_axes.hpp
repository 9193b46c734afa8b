#pragma once

#include <array>
#include <bit>
#include <span>

#include "engine/normals/map_batch.hpp"
#include "engine/normals/surface_estimate.hpp"

namespace sulcus {

/// The unit mean of normals, and the mean of offsets; undefined where the normals cancel out, or
/// one is undefined. Its windows are those of all.
SurfaceEstimate mean_of(std::span<const SurfaceEstimate> estimates) noexcept;
/// An estimate by a map along an axis.
struct AxisEstimate {
  SurfaceEstimate estimate;
  int axis = 0;
};
/// Of estimates along different axes the mean of those that are most level over their own, within
/// kAsLevel: their maps show most.
SurfaceEstimate most_level(std::span<const AxisEstimate> estimates) noexcept;

/// Estimates of the voxels of a batch whose coarse normals have two or three equally large
/// components, as at the edge of a box and all over a plane of 45 degrees. No axis comes first
/// there: it is the mean of the estimates along each (most_level). What the tool vetoes is first
/// that, so that no answer without a veto depends on it, then the estimates themselves.
///
/// `estimates` holds those along the first axes, as the batch was taken; `estimate(to)` finds those
/// of what is in the batch. It holds others afterwards.
template <class Estimate>
void estimate_equal_axes(MapBatch& batch, const Estimate& estimate,
                         SurfaceEstimate* estimates) noexcept {
  const VoxelBits two = batch.two_equal, three = batch.three_equal;
  if (two == 0) return;
  // Kept, since the batch goes on to others.
  std::array<Eigen::Vector3f, MapBatch::kSize> coarse, outward;
  std::array<int, MapBatch::kSize> first_axis;
  VoxelBits with_tool = 0;
  for_each(two, [&](std::size_t k) {
    coarse[k] = batch.coarse(k);
    outward[k] = batch.query(k).outward;
    first_axis[k] = batch.axes(k).axis;
    if (!outward[k].isZero()) with_tool |= bit_of(k);
  });
  // A few at a time: mostly there are no more.
  constexpr std::size_t kTogether = 8;
  for (VoxelBits rest = two; rest != 0;) {
    std::array<std::array<AxisEstimate, 3>, kTogether> along;  // in the order of their bits
    std::array<SurfaceEstimate, kTogether> found;
    VoxelBits these = 0;
    for (std::size_t n = 0; rest != 0 && n < kTogether; ++n, rest &= rest - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(rest));
      these |= bit_of(k);
      along[n][0] = {estimates[k], first_axis[k]};
    }
    const auto place = [&](std::size_t k) {
      return static_cast<std::size_t>(std::popcount(these & (bit_of(k) - 1)));
    };
    const auto look_along = [&](EqualAxes axis, VoxelBits which, UseOfTool use) {
      if (which == 0) return;
      batch.retake(which, axis, use);
      estimate(found.data());
      std::size_t n = 0;
      for_each(which, [&](std::size_t k) {
        along[place(k)][static_cast<std::size_t>(axis)] = {found[n], batch.axes(n).axis};
        ++n;
      });
    };
    const auto put = [&](VoxelBits which, UseOfTool use) {
      look_along(EqualAxes::kFirst, which & with_tool, use);
      look_along(EqualAxes::kLast, which, use);
      look_along(EqualAxes::kMiddle, which & three, use);
      for_each(which, [&](std::size_t k) {
        estimates[k] = most_level(std::span(along[place(k)]).first(has_bit(three, k) ? 3 : 2));
        if (estimates[k].defined) return;
        const Eigen::Vector3f hint = use == UseOfTool::kAlways
                                         ? tool_hint(outward[k], coarse[k])
                                         : Eigen::Vector3f(Eigen::Vector3f::Zero());
        estimates[k] = last_resort(coarse[k], hint, estimates[k].windows);
      });
    };
    put(these, UseOfTool::kWhereAlone);
    VoxelBits vetoed = 0;
    for_each(these & with_tool, [&](std::size_t k) {
      if (estimates[k].normal.dot(tool_hint(outward[k], coarse[k])) < 0.0f) vetoed |= bit_of(k);
    });
    if (vetoed != 0) put(vetoed, UseOfTool::kAlways);
  }
}

}  // namespace sulcus
