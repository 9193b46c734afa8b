#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/surface/density.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The density of a whole grid in cells of 4 voxels, blurred to standard deviations of about 6 and
/// 8 voxels (the second by blurring the first again): what the wide normals of a surface are taken
/// from. A sample serves everything within 40 voxels of it, so it is kept rather than found for
/// each brick, and found anew only round what has changed. 4 bytes a cell.
class WideDensity {
 public:
  static constexpr int kCell = 4;                                     // edge in voxels
  static constexpr int kMiddleBlur = 4, kWideBlur = 2 * kMiddleBlur;  // radii, cells
  /// Voxels from a voxel to the farthest point whose gradients it can change: the blur, 1.5 cells
  /// of spline, and half a cell.
  static constexpr int kReach = (kWideBlur + 2) * kCell;

  WideDensity(const VoxelModel& model, const Density& density);

  /// After the density of these leaves has changed. All samples are then as if all of them had
  /// been found anew.
  void update(const VoxelModel& model, const Density& density,
              std::span<const std::uint32_t> leaves);

  /// Up the density, per cell; zero where there is none near.
  struct Gradients {
    Eigen::Vector3f middle, wide;
  };
  /// At a point of index space, at most 16 voxels beyond the grid. Any thread, while no update
  /// runs.
  Gradients gradients(const Eigen::Vector3f& p_index) const;

  std::size_t memory_bytes() const { return samples_.capacity() * sizeof(Sample); }

 private:
  // Sixteen bits are 1.5e-5 of a full cell: the gradient at a surface, some 0.2 a cell, turns by
  // less than 0.01 degrees.
  using Sample = std::array<std::uint16_t, 2>;  // middle, wide
  struct Box {
    Eigen::Vector3i low, high;  // cells, [low, high)
  };
  void find(const VoxelModel& model, const Density& density, const Box& box);

  Eigen::Vector3i first_ = Eigen::Vector3i::Zero(), dims_ = Eigen::Vector3i::Zero();
  std::vector<Sample> samples_;  // x fastest, from the cell first_ on
};

}  // namespace sulcus
