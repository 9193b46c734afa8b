#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/volume/fill_map.hpp"

namespace sulcus {

enum class EditCause : std::uint8_t { kCut = 0, kLoose = 1, kUndo = 2 };

/// Bodies that a scene may have besides the workpiece.
inline constexpr std::size_t kMaxBodies = 15;

/// One voxel that changed: what leaves the haptic thread, and from which every shape follows. It is
/// gone, or, with fractions, still there and filled up to `level`.
struct Edit {
  std::uint64_t tick = 0;
  std::uint32_t voxel = 0;  // VoxelGrid::linear
  std::uint16_t body = 0;   // 0: the workpiece, then the others in the order of the scene
  EditCause cause = EditCause::kCut;
  FillLevel level = 0;

  bool is_gone() const { return level == 0; }
};

}  // namespace sulcus
