#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/recording/tick_record.hpp"
#include "engine/volume/edit.hpp"

namespace sulcus {

/// What of a run changes the temperature of the tooth, in stretches of 10 ms: the work of cutting,
/// where the burr was, and the voxels that went. Made of the rows of a run, as they come or from
/// its recording, with the same result. Used by one thread.
class HeatLog {
 public:
  struct Stretch {
    double work_J = 0.0;  // of the tangential force, in it
    // At its last row; of one without rows as at the end of the one before it.
    bool has_rows = false;
    bool turns = false;  // whether the burr does
    Eigen::Vector3d tip_world{0, 0, 0};
  };
  struct GoneVoxel {
    std::uint32_t stretch = 0;
    std::uint32_t voxel = 0;  // VoxelGrid::linear
    std::uint16_t body = 0;
    EditCause cause = EditCause::kCut;
  };

  /// `first_tick`: of the run.
  HeatLog(double rate_hz, std::uint64_t first_tick);

  /// The rows of a run, rising; some may be missing.
  void add(const TickRecord& record, const CuttingRecord& cutting);
  /// The edits of the same run, rising: before or after their rows.
  void add(const Edit& edit);

  /// One after another, from the first tick on.
  std::span<const Stretch> stretches() const { return stretches_; }
  /// On the clock of the run.
  double end_s(std::size_t stretch) const {
    return (static_cast<double>(first_tick_) / rate_hz_) +
           static_cast<double>(stretch + 1) * stretch_s();
  }
  /// In the order of their stretches.
  std::span<const GoneVoxel> gone() const { return gone_; }
  double stretch_s() const { return static_cast<double>(stretch_ticks_) / rate_hz_; }
  std::size_t memory_bytes() const {
    return stretches_.capacity() * sizeof(Stretch) + gone_.capacity() * sizeof(GoneVoxel);
  }

 private:
  /// The stretch of a tick, made where it was not there.
  std::uint32_t stretch_of(std::uint64_t tick);

  double rate_hz_;
  std::uint64_t stretch_ticks_, first_tick_;
  std::optional<double> work_J_;  // up to the last row; none before the first
  std::vector<Stretch> stretches_;
  std::vector<GoneVoxel> gone_;
};

}  // namespace sulcus
