#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// A block of samples of a scalar on a lattice, x fastest.
struct DensityBlock {
  Eigen::Vector3i first = Eigen::Vector3i::Zero();  // lattice coordinates of values[0]
  Eigen::Vector3i dims = Eigen::Vector3i::Zero();
  std::vector<float> values;

  /// Sets the extent and makes room for the values.
  void reshape(const Eigen::Vector3i& first_sample, const Eigen::Vector3i& sample_dims);
};

/// How much of each cubic cell of 1, 2, 4 or 8 voxels (level 0 to 3) is solid, 0 to 1. Cell
/// (i, j, k) of level n holds the voxels from (i, j, k) 2^n on; cells outside the grid are empty.
/// Levels 0 and 1 are read off the model; level 2 is kept and updated per leaf, and level 3 added
/// up from it. With fractions a voxel counts by what of it is filled, in level 2 to whole voxels in
/// all.
class Density {
 public:
  explicit Density(const VoxelModel& model);

  /// After the voxels of a leaf, or their levels, have changed.
  void update(const VoxelModel& model, std::uint32_t leaf);
  /// Fills a block whose extent is set. Any thread, while no update runs.
  void sample(const VoxelModel& model, int level, DensityBlock& block) const;
  /// Voxels, 0 to 64, in a cell of level 2.
  int quarter_count(int i, int j, int k) const {
    return quarter_[static_cast<std::size_t>(i) +
                    static_cast<std::size_t>(quarter_dims_.x()) *
                        (static_cast<std::size_t>(j) +
                         static_cast<std::size_t>(quarter_dims_.y()) * k)];
  }
  const Eigen::Vector3i& quarter_dims() const { return quarter_dims_; }
  std::size_t memory_bytes() const { return quarter_.capacity(); }

 private:
  Eigen::Vector3i quarter_dims_;
  std::vector<std::uint8_t> quarter_;  // level 2, x fastest
};

/// Convolves a block with the binomial weights of 2 radius + 1 taps (variance radius / 2) along
/// each axis. Samples nearer than `radius` to the block's border are not valid afterwards.
/// `scratch` is overwritten. Radius 1, 2 or 4.
void blur(DensityBlock& block, int radius, std::vector<float>& scratch);

/// A quadratic B-spline at a point of a lattice: smooth, and a slight blur (variance 1/4) itself.
struct SplineWeights {
  explicit SplineWeights(const Eigen::Vector3f& p_lattice);
  Eigen::Vector3i first;  // of the 3 x 3 x 3 samples that it is made of
  float weight[3][3];     // by axis and sample
  float slope[3][3];      // their derivatives, per lattice step
};

/// Value and gradient, per lattice step, of a block's spline at `p_lattice`. The 27 samples around
/// must lie in the block.
struct DensityAt {
  float value;
  Eigen::Vector3f gradient;
};
DensityAt spline(const DensityBlock& block, const Eigen::Vector3f& p_lattice);

}  // namespace sulcus
