#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/playback/recorded_run.hpp"
#include "app/playback/recorded_state.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/volume/voxel_values.hpp"

namespace sulcus {

/// Which voxels a recorded run was in contact with. A recording does not hold them: its ticks are
/// run again.
class RecordedContacts {
 public:
  /// `counted`: of all ticks, for `counts`, so that all are run again; else only those that lead to
  /// a row from a state that was recorded. InputError as open_recorded_run.
  RecordedContacts(const std::string& path, bool counted);

  /// To right after a row, on from the last. InputError as RecordedState::seek_row. Ticks after
  /// rows that were not recorded are skipped, up to the next state that was.
  void seek_row(std::size_t row);
  /// Of a body, at those of its voxels that still stand: the number of ticks in which each took
  /// part in the force. Others have none.
  VoxelValues counts(std::size_t body) const;
  /// Those that took part in the force of the row, of all bodies; none of one that was skipped.
  const std::vector<ContactMark>& marks() const { return marks_; }
  /// The same as voxels (VoxelGrid::linear) of their bodies, beside the marks.
  struct Voxel {
    std::size_t body;
    std::uint32_t voxel;
  };
  const std::vector<Voxel>& voxels() const { return voxels_; }
  std::size_t body_count() const { return counts_.size(); }

 private:
  void skip_gap(std::size_t row);
  void look(const TickRecord& again);

  RecordedRun run_;
  RecordedState state_;
  bool counted_;
  std::vector<VoxelValues> counts_;  // by body
  std::vector<ContactMark> marks_;
  std::vector<Voxel> voxels_;
};

}  // namespace sulcus
