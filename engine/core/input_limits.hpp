#pragma once

#include <cstdint>

namespace sulcus {

/// What input files may ask for before they are refused: a scene is small, and of the others each
/// may take `memory_bytes` while it is read, which `--limit-gib` raises. Every reader compares
/// these with what a file announces before it takes any memory for it.
struct InputLimits {
  /// Of one scene file, or of the scene within a recording.
  static constexpr std::uint64_t kSceneBytes = std::uint64_t{16} << 20;
  /// Levels of arrays and tables in a scene; parts of a key such as workpiece.box.size_mm.
  static constexpr int kSceneDepth = 16;

  static constexpr std::uint64_t kGibibyte = std::uint64_t{1} << 30;
  /// What a triangle takes while the library still holds it as well; a voxel's grey value; a pose.
  static constexpr std::uint64_t kTriangleBytes = 256, kVoxelBytes = 4, kPoseBytes = 128;

  std::uint64_t memory_bytes = 4 * kGibibyte;

  /// Of a volume: 1024 cubed, the largest grid of ours, unless raised.
  std::uint64_t voxels() const { return memory_bytes / kVoxelBytes; }
  /// Of a mesh: 16.8 million unless raised.
  std::uint64_t triangles() const { return memory_bytes / kTriangleBytes; }
  /// Rows of a table of poses: 33.6 million unless raised, 9 hours at 1 kHz.
  std::uint64_t poses() const { return memory_bytes / kPoseBytes; }
};

}  // namespace sulcus
