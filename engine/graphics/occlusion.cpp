#include "engine/graphics/occlusion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/core/units.hpp"

namespace sulcus {
namespace {

// The blur's standard deviation is two cells: a quarter of a fissure's depth, a fifth of a burr.
// One cell would do for the depth, but the lattice would show.
constexpr double kCell = 0.14 * kMillimetre;
constexpr int kHalfBlur = 4;
constexpr int kBlur = 2 * kHalfBlur;
constexpr int kKeptLevel = 2;  // of Density::quarter_count

std::size_t at(const Eigen::Vector3i& dims, int x, int y, int z) {
  return static_cast<std::size_t>(x) +
         static_cast<std::size_t>(dims.x()) *
             (static_cast<std::size_t>(y) + static_cast<std::size_t>(dims.y()) * z);
}

}  // namespace

Occlusion::Occlusion(const VoxelModel& model, const Density& density)
    : level_(std::clamp(static_cast<int>(std::lround(std::log2(kCell / model.grid.voxel_m))),
                        kKeptLevel, 6)),
      cell_m_(model.grid.voxel_m * (1 << level_)),
      dims_((model.grid.cells + Eigen::Vector3i::Constant((1 << level_) - 1)) / (1 << level_)),
      raw_(static_cast<std::size_t>(dims_.x()) * dims_.y() * dims_.z()),
      values_(raw_.size()) {
  gather(density, Eigen::Vector3i::Zero(), dims_);
  smooth({Eigen::Vector3i::Zero(), dims_});
}

void Occlusion::gather(const Density& density, const Eigen::Vector3i& low,
                       const Eigen::Vector3i& high) {
  const int edge = 1 << (level_ - kKeptLevel);
  const float full = 1.0f / (64.0f * static_cast<float>(edge * edge * edge));
  for (int z = low.z(); z < high.z(); ++z) {
    for (int y = low.y(); y < high.y(); ++y) {
      for (int x = low.x(); x < high.x(); ++x) {
        const Eigen::Vector3i from = Eigen::Vector3i(x, y, z) * edge;
        const Eigen::Vector3i to =
            (from + Eigen::Vector3i::Constant(edge)).cwiseMin(density.quarter_dims());
        int count = 0;
        for (int k = from.z(); k < to.z(); ++k) {
          for (int j = from.y(); j < to.y(); ++j) {
            for (int i = from.x(); i < to.x(); ++i) count += density.quarter_count(i, j, k);
          }
        }
        raw_[at(dims_, x, y, z)] = full * static_cast<float>(count);
      }
    }
  }
}

void Occlusion::smooth(const Box& box) {
  const Eigen::Vector3i margin = Eigen::Vector3i::Constant(kBlur);
  block_.reshape(box.low - margin, box.high - box.low + 2 * margin);
  std::fill(block_.values.begin(), block_.values.end(), 0.0f);
  const Eigen::Vector3i from = block_.first.cwiseMax(0);
  const Eigen::Vector3i to = (block_.first + block_.dims).cwiseMin(dims_);
  for (int z = from.z(); z < to.z(); ++z) {
    for (int y = from.y(); y < to.y(); ++y) {
      for (int x = from.x(); x < to.x(); ++x) {
        block_.values[at(block_.dims, x - block_.first.x(), y - block_.first.y(),
                         z - block_.first.z())] = raw_[at(dims_, x, y, z)];
      }
    }
  }
  blur(block_, kHalfBlur, scratch_);
  blur(block_, kHalfBlur, scratch_);
  for (int z = box.low.z(); z < box.high.z(); ++z) {
    for (int y = box.low.y(); y < box.high.y(); ++y) {
      for (int x = box.low.x(); x < box.high.x(); ++x) {
        const float value = block_.values[at(block_.dims, x - block_.first.x(),
                                             y - block_.first.y(), z - block_.first.z())];
        values_[at(dims_, x, y, z)] = static_cast<std::uint16_t>(std::lround(65535.0f * value));
      }
    }
  }
}

Occlusion::Box Occlusion::update(const VoxelModel& model, const Density& density,
                                 std::span<const std::uint32_t> leaves) {
  if (leaves.empty()) return {};
  Box box{dims_, Eigen::Vector3i::Zero()};
  for (const std::uint32_t leaf : leaves) {
    const Cell first = model.grid.leaf_origin(leaf);
    const Eigen::Vector3i low = first / (1 << level_);
    const Eigen::Vector3i high =
        (first + Cell::Constant(kLeafEdge - 1)) / (1 << level_) + Eigen::Vector3i::Ones();
    gather(density, low, high);
    box.low = box.low.cwiseMin(low);
    box.high = box.high.cwiseMax(high);
  }
  box.low = (box.low - Eigen::Vector3i::Constant(kBlur)).cwiseMax(0);
  box.high = (box.high + Eigen::Vector3i::Constant(kBlur)).cwiseMin(dims_);
  smooth(box);
  return box;
}

}  // namespace sulcus
