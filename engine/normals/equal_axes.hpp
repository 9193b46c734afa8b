#pragma once

#include <array>
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
  constexpr std::size_t kSize = MapBatch::kSize;
  // Kept, since the batch goes on to others.
  std::array<Eigen::Vector3f, kSize> coarse, outward;
  std::array<std::array<AxisEstimate, kSize>, 3> along;
  VoxelBits with_tool = 0;
  for_each(two, [&](std::size_t k) {
    coarse[k] = batch.coarse(k);
    outward[k] = batch.query(k).outward;
    along[0][k] = {estimates[k], batch.axes(k).axis};
    if (!outward[k].isZero()) with_tool |= bit_of(k);
  });
  std::array<SurfaceEstimate, kSize> found;
  const auto look_along = [&](EqualAxes axis, VoxelBits which, UseOfTool use) {
    if (which == 0) return;
    batch.retake(which, axis, use);
    estimate(found.data());
    std::size_t n = 0;
    for_each(which, [&](std::size_t k) {
      along[static_cast<std::size_t>(axis)][k] = {found[n], batch.axes(n).axis};
      ++n;
    });
  };
  const auto put = [&](VoxelBits which, UseOfTool use) {
    look_along(EqualAxes::kFirst, which & with_tool, use);
    look_along(EqualAxes::kLast, which, use);
    look_along(EqualAxes::kMiddle, which & three, use);
    for_each(which, [&](std::size_t k) {
      const std::array<AxisEstimate, 3> all{along[0][k], along[1][k], along[2][k]};
      estimates[k] = most_level(std::span(all).first(has_bit(three, k) ? 3 : 2));
      if (estimates[k].defined) return;
      const Eigen::Vector3f hint = tool_hint(outward[k], coarse[k]);
      const bool is_used = use == UseOfTool::kAlways;
      estimates[k] =
          last_resort(coarse[k], is_used ? hint : Eigen::Vector3f(Eigen::Vector3f::Zero()),
                      estimates[k].windows);
    });
  };
  put(two, UseOfTool::kWhereAlone);
  VoxelBits vetoed = 0;
  for_each(with_tool, [&](std::size_t k) {
    if (estimates[k].normal.dot(tool_hint(outward[k], coarse[k])) < 0.0f) vetoed |= bit_of(k);
  });
  if (vetoed != 0) put(vetoed, UseOfTool::kAlways);
}

}  // namespace sulcus
