#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/normals/filled_map.hpp"
#include "engine/normals/map_space.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Reads the heights of filled maps, those of one leaf's voxels together: what neighbouring maps
/// share is read once. No result depends on the order. Needs fractions; the workpiece must outlive
/// it, and not change.
class FilledHeights {
 public:
  static constexpr int kMostPart = 5;  // voxels of a column that are not full, one after another

  explicit FilledHeights(const Workpiece& workpiece) : model_(workpiece.model()) {}

  /// Those of the columns that were traced, of a voxel's map along `axes`. A column has a height
  /// where no more than kMostPart voxels, within 15 of the voxel, are not full; but a wall of
  /// part-filled voxels has one, too: there the fullest counts for both sides.
  void fill(const Cell& voxel, const MapAxes& axes, const HeightMap& traced,
            FilledMap& map) noexcept;

  /// The height of a voxel's own column along one axis, voxels above its centre, outward; none
  /// where the column has no surface within three voxels of it.
  std::optional<float> own_height(const Cell& voxel, const MapAxes& axes) const noexcept;

 private:
  ColumnLacks& lacks_of(const Cell& voxel, const MapAxes& axes) noexcept;

  const VoxelModel& model_;
  Cell origin_ = Cell::Constant(-1);  // of the leaf
  std::array<bool, 6> made_{};        // by axis and sign
  std::array<ColumnLacks, 6> lacks_;
};

}  // namespace sulcus
