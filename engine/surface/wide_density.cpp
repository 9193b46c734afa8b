#include "engine/surface/wide_density.hpp"

#include <algorithm>
#include <cmath>

#include "engine/surface/tiles.hpp"

namespace sulcus {
namespace {

// Cells kept beyond the grid: vertices lie up to 16 voxels out there, and the spline reaches 1.5.
constexpr int kBeyond = 6;
// Cells along the boxes in which a whole grid is found.
constexpr int kTile = 32;

std::ptrdiff_t volume(const Eigen::Vector3i& size) {
  return std::ptrdiff_t{size.x()} * size.y() * size.z();
}

}  // namespace

WideDensity::WideDensity(const VoxelModel& model, const Density& density)
    : first_(Eigen::Vector3i::Constant(-kBeyond)),
      dims_(density.quarter_dims() + Eigen::Vector3i::Constant(2 * kBeyond)),
      samples_(static_cast<std::size_t>(volume(dims_))) {
  for_each_tile(first_, first_ + dims_, kTile, [&](const Cell& low, const Cell& high) {
    find(model, density, {low, high});
  });
}

void WideDensity::update(const VoxelModel& model, const Density& density,
                         std::span<const std::uint32_t> leaves) {
  // What is near one another is found in one box, as long as that is less work than apart.
  const auto work = [](const Box& box) {
    return volume(box.high - box.low + Eigen::Vector3i::Constant(2 * kWideBlur));
  };
  std::vector<Box> boxes;
  for (const std::uint32_t leaf : leaves) {
    const Eigen::Vector3i low = model.grid.leaf_origin(leaf) / kCell;
    Box box{low - Eigen::Vector3i::Constant(kWideBlur),
            low + Eigen::Vector3i::Constant(kLeafEdge / kCell + kWideBlur)};
    box.low = box.low.cwiseMax(first_);
    box.high = box.high.cwiseMin(first_ + dims_);
    for (std::size_t i = 0; i < boxes.size();) {
      const Box both{box.low.cwiseMin(boxes[i].low), box.high.cwiseMax(boxes[i].high)};
      if (work(both) <= work(box) + work(boxes[i])) {
        box = both;
        boxes[i] = boxes.back();
        boxes.pop_back();
        i = 0;  // what was too far from the smaller one
      } else {
        ++i;
      }
    }
    boxes.push_back(box);
  }
  for (const Box& box : boxes) find(model, density, box);
}

void WideDensity::find(const VoxelModel& model, const Density& density, const Box& box) {
  thread_local DensityBlock block;
  thread_local std::vector<float> scratch;
  constexpr int kLevel = 2;
  static_assert(1 << kLevel == kCell);
  const Eigen::Vector3i margin = Eigen::Vector3i::Constant(kWideBlur);
  const Eigen::Vector3i size = box.high - box.low;
  block.reshape(box.low - margin, size + 2 * margin);
  density.sample(model, kLevel, block);
  const auto keep = [&](std::size_t which) {
    for (int z = 0; z < size.z(); ++z) {
      for (int y = 0; y < size.y(); ++y) {
        const Eigen::Vector3i to = box.low + Eigen::Vector3i(0, y, z) - first_;
        const Eigen::Vector3i from = Eigen::Vector3i(0, y, z) + margin;
        Sample* const row = &samples_[static_cast<std::size_t>(
            to.x() + std::ptrdiff_t{dims_.x()} * (to.y() + std::ptrdiff_t{dims_.y()} * to.z()))];
        const float* const found = &block.values[static_cast<std::size_t>(
            from.x() + std::ptrdiff_t{block.dims.x()} *
                           (from.y() + std::ptrdiff_t{block.dims.y()} * from.z()))];
        for (int x = 0; x < size.x(); ++x) {
          row[x][which] = static_cast<std::uint16_t>(std::lround(found[x] * 65535.0f));
        }
      }
    }
  };
  blur(block, kMiddleBlur, scratch);
  keep(0);
  blur(block, kMiddleBlur, scratch);
  keep(1);
}

WideDensity::Gradients WideDensity::gradients(const Eigen::Vector3f& p_index) const {
  const Eigen::Vector3f p =
      (p_index + Eigen::Vector3f::Constant(0.5f)) / float{kCell} - Eigen::Vector3f::Constant(0.5f);
  const SplineWeights weights(p);
  const Eigen::Vector3i from = weights.first - first_;
  Gradients sum{Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      const Sample* const row = &samples_[static_cast<std::size_t>(
          from.x() +
          std::ptrdiff_t{dims_.x()} * (from.y() + j + std::ptrdiff_t{dims_.y()} * (from.z() + k)))];
      float along[2] = {}, change[2] = {};
      for (int i = 0; i < 3; ++i) {
        for (int s = 0; s < 2; ++s) {
          along[s] += weights.weight[0][i] * static_cast<float>(row[i][s]);
          change[s] += weights.slope[0][i] * static_cast<float>(row[i][s]);
        }
      }
      const float wy = weights.weight[1][j], wz = weights.weight[2][k];
      const float sy = weights.slope[1][j] * wz, sz = wy * weights.slope[2][k];
      sum.middle += Eigen::Vector3f(wy * wz * change[0], sy * along[0], sz * along[0]);
      sum.wide += Eigen::Vector3f(wy * wz * change[1], sy * along[1], sz * along[1]);
    }
  }
  constexpr float kFull = 1.0f / 65535.0f;
  return {sum.middle * kFull, sum.wide * kFull};
}

}  // namespace sulcus
