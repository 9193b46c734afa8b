#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/loose_schedule.hpp"
#include "app/simulation.hpp"
#include "engine/recording/recording_reader.hpp"

namespace sulcus {

/// A recording opened to be run again: the simulation as it was before the first tick, and the
/// device's poses; none where it did not answer.
struct RecordedRun {
  std::string path;
  RecordingReader reader;
  std::unique_ptr<Simulation> simulation;
  std::vector<std::optional<Pose>> poses;
  std::vector<TakenAnswer> taken_answers;  // of loose pieces
};

/// Opens a recording; it needs neither the scan nor the burr's mesh that it was made from.
/// InputError as RecordingReader; also where its scene no longer reads.
RecordedRun open_recorded_run(const std::string& path);

/// The scene that a recording carries.
Scene recorded_scene(const RecordingReader& reader, const std::string& path);
/// The workpiece and the other bodies that it carries. InputError where they are not those of its
/// scene: another number, another grid, a tissue that it does not name.
VoxelModel recorded_workpiece(const RecordingReader& reader, const Scene& scene);
std::vector<VoxelModel> recorded_bodies(const RecordingReader& reader, const Scene& scene);
/// The burr that a recording carries or its scene generates.
Burr recorded_burr(const RecordingReader& reader, const Scene& scene);

/// The recorded workpiece over time: the model at the start, and the edits applied up to a time.
class RecordedShape {
 public:
  /// `start`: the workpiece at the start.
  RecordedShape(const RecordingReader& reader, VoxelModel start);

  /// Applies the edits of all rows up to and with that row; forward only. Returns those it passed,
  /// of all bodies.
  std::span<const Edit> advance_to_row(std::size_t row);
  const VoxelModel& model() const { return model_; }
  const std::vector<TickRecord>& rows() const { return rows_; }
  /// Last row at or before a time; the first where none is.
  std::size_t row_at(double time_s) const;

 private:
  VoxelModel model_;
  std::vector<TickRecord> rows_;
  std::vector<Edit> edits_;
  std::size_t applied_ = 0;
};

/// The recorded pieces that were cut loose, over time; forward only.
class RecordedPieces {
 public:
  explicit RecordedPieces(const RecordingReader& reader);

  /// Voxels of the pieces that have come loose up to and with a tick, since the last call.
  std::vector<std::span<const std::uint32_t>> advance_to_tick(std::uint64_t tick);
  /// Of the pieces so far, world now from world where they were.
  std::span<const Pose> poses() const { return poses_; }

 private:
  std::vector<PieceRow> pieces_;
  std::vector<PiecePoseRow> rows_;
  std::vector<std::uint32_t> loose_voxels_;  // in the order of their edits
  std::vector<Pose> poses_;
  std::size_t next_ = 0;
};

}  // namespace sulcus
