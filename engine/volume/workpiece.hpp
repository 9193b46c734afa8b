#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/core/zeroed_array.hpp"
#include "engine/volume/column_bits.hpp"
#include "engine/volume/octree.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// The body that is probed and cut: leaves of 512 bits, their surface masks, the octree over them,
/// the columns for the local distance maps, and the tissues. The haptic thread is the only writer;
/// nothing here allocates after construction, and nothing walks the volume in a tick.
///
/// A surface voxel is a solid voxel with at least one of its six neighbours empty. Outside the
/// grid all is empty.
class Workpiece {
 public:
  explicit Workpiece(VoxelModel model);

  const VoxelGrid& grid() const { return model_.grid; }
  const VoxelModel& model() const { return model_; }
  const Octree& octree() const { return octree_; }
  const ColumnBits& columns() const { return columns_; }
  bool solid(const Cell& c) const { return model_.solid(c); }
  const LeafBits& surface(std::uint32_t leaf) const { return surface_[leaf]; }
  bool is_surface(const Cell& c) const;
  std::uint8_t tissue(const Cell& c) const { return model_.tissue(c); }

  /// Whether its voxels carry fractions; else all that are solid are full.
  bool has_fills() const { return model_.fills.has_value(); }
  FillLevel level(const Cell& c) const { return model_.level(c); }

  std::uint64_t solid_voxels() const { return solid_voxels_; }
  std::uint64_t surface_voxels() const { return surface_voxels_; }
  /// XOR over non-empty leaves of XXH3-64 of their bits, seeded by their number, and over voxels
  /// that are not full of a mix of voxel and level: the shape as it is, kept up edit by edit.
  std::uint64_t hash() const { return hash_; }
  /// Shape and tissues together; walks the volume, for loading only.
  std::uint64_t hash_with_tissues() const;

  /// Room for as many leaves more with voxels that are not full, as cutting makes them; without it
  /// `set_level` has none. Nothing where there are no fractions.
  void reserve_fills(std::uint32_t leaves);
  /// Sets the fill level of a solid voxel, above 0. False, and nothing is done, where there is no
  /// room left for its leaf. Constant time.
  bool set_level(const Cell& c, FillLevel level) noexcept;
  /// Empties a solid voxel: bits, surface, columns, hash, the leaf's status. Constant time.
  void remove(const Cell& c) noexcept;
  /// The reverse: a voxel that was solid when the workpiece was made, and has been removed, with
  /// the level that it had then. For going back in a recording, not for a tick.
  void put_back(const Cell& c, FillLevel level = kFullLevel) noexcept;
  /// See Octree::switch_off.
  void switch_off(std::span<const std::uint32_t> nodes) noexcept { octree_.switch_off(nodes); }

  /// Of leaves and their surface what the pages with a solid voxel take; no others are written.
  std::size_t memory_bytes() const;

 private:
  std::uint64_t leaf_hash(std::uint32_t leaf) const noexcept;
  std::uint64_t fills_hash() const noexcept;
  void expose(const Cell& c) noexcept;
  void update_surface(const Cell& c) noexcept;

  VoxelModel model_;
  ZeroedArray<LeafBits> surface_;
  Octree octree_;
  ColumnBits columns_;
  std::uint64_t solid_voxels_ = 0;
  std::uint64_t surface_voxels_ = 0;
  std::uint64_t hash_ = 0;
  std::size_t leaf_pages_ = 0;  // of the leaves, where one had a voxel at the start
};

/// Surface voxels of one leaf of a model, from its bits and those of its six neighbours.
LeafBits surface_of_leaf(const VoxelModel& model, std::uint32_t leaf);

}  // namespace sulcus
