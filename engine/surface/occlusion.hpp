#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/surface/density.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The solid seen from far: its density in cells of about 0.14 mm, blurred, for a 3D texture. How
/// much of it stands above a surface point says how little light falls there, so fissures and
/// cavities read as deep. Pieces that were cut loose are put into it where they are, so that they
/// and the rest shade each other.
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

  /// A piece that is to be removed from the model: its voxels, VoxelGrid::linear. It is nowhere
  /// until it is placed.
  void add_piece(const VoxelGrid& grid, std::span<const std::uint32_t> voxels);
  /// Puts the pieces where they are now: world now from world at the start, in the order of
  /// `add_piece`; pieces beyond the poses, and what lies beyond the texture, are nowhere. Returns
  /// what changed, a box for each piece that has moved since the last call.
  std::vector<Box> place_pieces(const Density& density, std::span<const Pose> world_now_from_start);

  const Eigen::Vector3i& dims() const { return dims_; }
  double cell_m() const { return cell_m_; }
  /// The blurred density, 0 to 65535, x fastest. (Eight bits would show as steps of light.)
  const std::vector<std::uint16_t>& values() const { return values_; }
  std::size_t memory_bytes() const;

 private:
  void fill_row(const Density& density, const Cell& first, int cells, float* to) const;
  void smooth(const Density& density, const Box& box);
  void smooth_tile(const Density& density, const Box& box);

  struct PieceCell {
    Eigen::Vector3i cell;
    float density;
  };
  struct Piece {
    std::vector<PieceCell> cells;  // at the start
    std::optional<Pose> pose;      // none: nowhere
    Box box;                       // of the cells that it has a part in now
  };
  void put(Piece& piece);

  int level_;  // log2 of the cell's edge in voxels, at least that of the density kept
  double cell_m_;
  Eigen::Vector3i dims_;
  Eigen::Vector3d half_m_;  // of the grid
  std::vector<Piece> pieces_;
  std::vector<float> raw_pieces_;  // empty where there are none
  std::vector<std::uint16_t> values_;
};

}  // namespace sulcus
