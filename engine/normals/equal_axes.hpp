#pragma once

#include <array>
#include <span>

#include "engine/normals/map_batch.hpp"
#include "engine/normals/surface_estimate.hpp"

namespace sulcus {

/// The unit mean of normals, and the mean of offsets; undefined where the normals cancel out, or
/// one is undefined. Its windows are those of all.
SurfaceEstimate mean_of(std::span<const SurfaceEstimate> estimates) noexcept;

/// Estimates of the voxels of a batch whose coarse normals have two or three equally large
/// components, as at the edge of a box and all over a plane of 45 degrees. No axis comes first
/// there: it is the mean of the estimates along each. What the tool vetoes is first the mean, so
/// that no answer without a veto depends on it, then the estimates themselves.
///
/// `estimates` holds those along the first axes, as the batch was taken; `estimate(to)` finds those
/// of all voxels that have a direction, anew.
template <class Estimate>
void estimate_equal_axes(MapBatch& batch, const Estimate& estimate,
                         SurfaceEstimate* estimates) noexcept {
  const VoxelBits two = batch.two_equal, three = batch.three_equal;
  if (two == 0) return;
  std::array<std::array<SurfaceEstimate, MapBatch::kSize>, 3> along;
  const auto mean = [&](std::size_t k, const Eigen::Vector3f& hint) {
    const std::array<SurfaceEstimate, 3> all{along[0][k], along[1][k], along[2][k]};
    const SurfaceEstimate of = mean_of(std::span(all).first(has_bit(three, k) ? 3 : 2));
    return of.defined ? of : last_resort(batch.coarse(k), hint, of.windows);
  };
  const auto look_along_others = [&](VoxelBits which, UseOfTool use) {
    batch.retake(which, EqualAxes::kLast, use);
    estimate(along[1].data());
    if ((which & three) == 0) return;
    batch.retake(which & three, EqualAxes::kMiddle, use);
    estimate(along[2].data());
  };
  VoxelBits with_tool = 0;
  for_each(two, [&](std::size_t k) {
    if (!batch.query(k).outward.isZero()) with_tool |= bit_of(k);
  });
  if (with_tool != 0) {
    batch.retake(with_tool, EqualAxes::kFirst, UseOfTool::kWhereAlone);
    estimate(along[0].data());
  }
  for_each(two & ~with_tool, [&](std::size_t k) { along[0][k] = estimates[k]; });
  look_along_others(two, UseOfTool::kWhereAlone);
  VoxelBits vetoed = 0;
  for_each(two, [&](std::size_t k) {
    const SurfaceEstimate without_tool = mean(k, Eigen::Vector3f::Zero());
    const Eigen::Vector3f hint = tool_hint(batch.query(k).outward, batch.coarse(k));
    if (without_tool.normal.dot(hint) < 0.0f) {
      along[0][k] = estimates[k];
      vetoed |= bit_of(k);
    }
    estimates[k] = without_tool;
  });
  if (vetoed == 0) return;
  look_along_others(vetoed, UseOfTool::kAlways);
  for_each(vetoed, [&](std::size_t k) {
    estimates[k] = mean(k, tool_hint(batch.query(k).outward, batch.coarse(k)));
  });
}

}  // namespace sulcus
