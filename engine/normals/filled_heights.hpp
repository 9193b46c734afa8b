#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/normals/filled_map.hpp"
#include "engine/normals/map_space.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// Voxels of a column that may be part-filled, one after another.
inline constexpr int kMostPartFilled = 5;

/// The height of a voxel's own column along one axis, voxels above its centre, outward; none where
/// the column has no surface within three voxels of it. Needs fractions.
std::optional<float> own_height(const VoxelModel& model, const Cell& voxel,
                                const MapAxes& axes) noexcept;

/// How far the surface of a part-filled voxel is from its centre at most, voxels, by its own
/// columns each way along the axes; none where they say nothing, and of a full voxel. What
/// estimate_ldm_filled finds of the voxel is no farther.
std::optional<float> farthest_surface(const VoxelModel& model, const Cell& voxel) noexcept;

/// Reads the heights of filled maps, those of one leaf's voxels together: what neighbouring maps
/// share is read once. No result depends on the order. Needs fractions; the workpiece must outlive
/// it, and not change.
class FilledHeights {
 public:
  explicit FilledHeights(const Workpiece& workpiece) : model_(workpiece.model()) {}

  /// Those of the columns that were traced, of a voxel's map along `axes`. A column has a height
  /// where no more than kMostPartFilled voxels are not full; but a wall of
  /// part-filled voxels has one, too: there the fullest counts for both sides.
  void fill(const Cell& voxel, const MapAxes& axes, const HeightMap& traced,
            FilledMap& map) noexcept;

 private:
  ColumnLacks& lacks_of(const Cell& voxel, const MapAxes& axes) noexcept;

  const VoxelModel& model_;
  Cell origin_ = Cell::Constant(-1);  // of the leaf
  std::array<bool, 6> made_{};        // by axis and sign
  std::array<ColumnLacks, 6> lacks_;
};

}  // namespace sulcus
