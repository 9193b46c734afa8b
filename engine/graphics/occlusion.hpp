#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/graphics/density.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The solid seen from far: its density in cells of about 0.14 mm, blurred, for a 3D texture. How
/// much of it stands above a surface point says how little light falls there, so fissures and
/// cavities read as deep.
class Occlusion {
 public:
  Occlusion(const VoxelModel& model, const Density& density);

  /// Cells of the texture that `update` changed: [low, high) along each axis; empty: none.
  struct Box {
    Eigen::Vector3i low = Eigen::Vector3i::Zero();
    Eigen::Vector3i high = Eigen::Vector3i::Zero();
  };
  /// After the density of these leaves has changed.
  Box update(const VoxelModel& model, const Density& density,
             std::span<const std::uint32_t> leaves);

  const Eigen::Vector3i& dims() const { return dims_; }
  double cell_m() const { return cell_m_; }
  /// The blurred density, 0 to 65535, x fastest. (Eight bits would show as steps of light.)
  const std::vector<std::uint16_t>& values() const { return values_; }

 private:
  void gather(const Density& density, const Eigen::Vector3i& low, const Eigen::Vector3i& high);
  void smooth(const Box& box);

  int level_;  // log2 of the cell's edge in voxels, at least that of the density kept
  double cell_m_;
  Eigen::Vector3i dims_;
  std::vector<float> raw_;
  std::vector<std::uint16_t> values_;
  DensityBlock block_;
  std::vector<float> scratch_;
};

}  // namespace sulcus
