#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Rigid motion of the pieces that were cut loose: they fall, collide with one another, with the
/// tooth, which is still being cut, with the other bodies and a floor, and come to rest. In Bullet,
/// as the convex hulls of their voxels. The same calls give the same bits. Free of threads: one at
/// a time may call.
///
/// The tooth is the faces of blocks of 4 x 4 x 4 voxels, solid where half of the voxels are, made
/// into triangles where a piece is and when it is there: it costs no memory and is never out of
/// date.
///
/// Bullet's contact cache cannot be saved, so that a world restored from poses and velocities would
/// go on a little differently from one that just went on. So every `kRebuildEvery` steps the world
/// is rebuilt from them itself: from there both are the same.
class DebrisWorld {
 public:
  static constexpr std::uint64_t kRebuildEvery = 1000;  // steps

  /// All that a later step depends on, with the pieces' voxels.
  struct PieceState {
    std::vector<std::uint32_t> voxels;  // VoxelGrid::linear
    // Of its principal axes, bit for bit as the library has them.
    Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Eigen::Vector3d velocity_mm_per_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d turning_rad_per_s = Eigen::Vector3d::Zero();
    double slow_s = 0.0;  // how long it has been slow
    int activation = 0;
  };
  struct State {
    std::uint64_t steps = 0;
    std::vector<PieceState> pieces;
  };

  /// Another body of the scene, which stays where it is.
  struct StillBody {
    const VoxelModel* model = nullptr;  // as it is now, as long as the world is there
    Pose world_from_grid;
  };

  DebrisWorld(const VoxelGrid& grid, const LoosePiecesSettings& settings,
              std::vector<StillBody> others = {});
  ~DebrisWorld();
  DebrisWorld(DebrisWorld&&) noexcept;

  /// A piece, at rest where its voxels (at least one) are; its number, counted from 0.
  std::size_t add(std::span<const std::uint32_t> voxels);
  /// A tick further.
  void step(double dt_s, const VoxelModel& tooth);
  /// Tooth or another body was cut in this box, voxels of an edge of `voxel_m`: pieces that lie
  /// within half a millimetre, or a block's edge where that is more, may move again.
  void wake(const Eigen::AlignedBox3d& cut_world, double voxel_m);

  std::size_t size() const { return pieces_.size(); }
  /// World now from world where the piece was when it was added.
  Pose pose(std::size_t piece) const;
  bool at_rest(std::size_t piece) const;

  State save() const;
  void restore(const State& state);
  std::size_t memory_bytes() const;

 private:
  struct World;
  struct Piece;
  void rebuild();
  void clear();
  void populate(const State& state);

  VoxelGrid grid_;
  LoosePiecesSettings settings_;
  std::vector<StillBody> others_;
  std::unique_ptr<World> world_;
  std::vector<std::unique_ptr<Piece>> pieces_;
  std::uint64_t steps_ = 0;
};

}  // namespace sulcus
