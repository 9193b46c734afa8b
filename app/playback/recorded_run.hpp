#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/playback/edit_cursor.hpp"
#include "app/session/simulation.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/volume/edit.hpp"
#include "haptics/device/pedal.hpp"
#include "haptics/loose_schedule.hpp"

namespace sulcus {

/// A recording opened to be run again: the simulation as it was before the first row.
struct RecordedRun {
  std::string path;
  RecordingReader reader;
  std::unique_ptr<Simulation> simulation;
  std::vector<TickRecord> rows;
  std::vector<std::optional<Pose>> poses;     // of the device, by row; none where it did not answer
  std::vector<PedalChange> pedal;             // rising by tick
  std::vector<TakenAnswer> taken_answers;     // of loose pieces
  std::shared_ptr<const EarlierRun> earlier;  // what came before; null where the run began here
};

/// Each change of the pedal, as a PlaybackDevice takes them.
std::vector<PedalChange> recorded_pedal(const RecordingReader& reader);

/// Opens a recording; it needs neither the scan nor the burr's mesh that it was made from.
/// InputError as RecordingReader; also where its scene no longer reads.
RecordedRun open_recorded_run(const std::string& path);

/// Tells the user, on the error stream, where a recording does not hold all of its run.
void say_what_is_missing(const RecordingReader& reader);

/// The scene that a recording carries.
Scene recorded_scene(const RecordingReader& reader, const std::string& path);
/// The workpiece and the other bodies that it carries. InputError where they are not those of its
/// scene: another number, another grid, a tissue that it does not name.
VoxelModel recorded_workpiece(const RecordingReader& reader, const Scene& scene);
std::vector<VoxelModel> recorded_bodies(const RecordingReader& reader, const Scene& scene);
/// What came before it, where it goes on from another and says so; null else. InputError where that
/// is not of its scene.
std::shared_ptr<const EarlierRun> recorded_earlier(const RecordingReader& reader,
                                                   const Scene& scene);
/// The burr that a recording carries or its scene generates.
Burr recorded_burr(const RecordingReader& reader, const Scene& scene);

/// Last row at or before a time; the first where none is.
std::size_t row_at(std::span<const TickRecord> rows, double time_s);

/// The same of a time that the user gives. @throws InputError with the times that there are, where
/// it is none of the recording: of it are the first row's to one tick after the last, at which the
/// run was over. `option` names what was given.
std::size_t asked_row(std::span<const TickRecord> rows, double time_s, const std::string& option,
                      const std::string& path);

/// The recorded workpiece over time, with its fill levels where it carries any.
class RecordedShape {
 public:
  /// `start`: the workpiece at the start. `others`: the other bodies, where `level_before` is asked
  /// for their voxels; not kept. InputError as EditCursor.
  RecordedShape(const RecordingReader& reader, VoxelModel start,
                std::span<const VoxelModel> others = {});

  /// To right after a row, on or back. Returns the edits on the way, of all bodies and in their
  /// order: made on the way on, taken back on the way back.
  std::span<const Edit> seek_row(std::size_t row);
  /// The level that the voxel of one of them had before it.
  FillLevel level_before(const Edit& edit) const {
    return edits_.level_before(static_cast<std::uint64_t>(&edit - edits_.edits().data()));
  }
  /// All edits up to right after a row.
  std::span<const Edit> edits_before(std::size_t row) const {
    return edits_.between(0, edits_.end_of_row(row));
  }
  const VoxelModel& model() const { return model_; }
  const std::vector<TickRecord>& rows() const { return rows_; }
  std::size_t row_at(double time_s) const { return sulcus::row_at(rows_, time_s); }

 private:
  VoxelModel model_;
  std::vector<TickRecord> rows_;
  EditCursor edits_;
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
