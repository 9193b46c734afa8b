#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/triangle_mesh.hpp"
#include "engine/recording/earlier_run.hpp"
#include "engine/recording/recording_header.hpp"
#include "engine/recording/tick_record.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/input_geometry.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What beside the workpiece's voxels a recording needs to be enough by itself.
struct RecordedSolids {
  std::vector<const VoxelModel*> bodies;  // in the order of the scene
  const VoxelModel* goal = nullptr;       // on the workpiece's grid, where it comes from a file
  const InputGeometry* input = nullptr;   // where the workpiece's file lies, where it has one
  const EarlierRun* earlier = nullptr;    // of a run that goes on from another
};

/// Writes a recording that other processes may read while it grows, and that reads whole up to the
/// last flush when this process is killed. Not thread-safe: one thread at a time uses it (HDF5 here
/// is a thread-safe build, so a reader of another file may work beside it).
///
/// The rows given wait in memory for `flush`, which writes edits before the ticks that name them
/// (`TickRecord::edits_end`, `FillEndRow::fills_end`); a tick whose edits were not given yet waits
/// for a later flush. Too many waiting rows flush themselves. The caller flushes every 30 ms.
///
/// Errors: std::runtime_error "PATH: what: reason", one line, when a write fails (disk full). From
/// then on every call but the destructor throws the same; what was flushed before stays readable.
class RecordingWriter {
 public:
  /// Creates PATH.part and writes what never changes; the first flush gives it its name, in place
  /// of a file that is there. `start` is the workpiece before the first tick; `burr_mesh_tool` (m,
  /// tool space) is null where the scene alone gives the burr. Throws InputError where `path`
  /// cannot be created or is no regular file.
  RecordingWriter(const std::string& path, const RecordingHeader& header, const VoxelModel& start,
                  const TriangleMesh* burr_mesh_tool, RecordingTables tables = {},
                  const RecordedSolids& others = {});
  /// Writes what still waits, as far as that works, but leaves the recording marked as not closed:
  /// who gets here without `close` was interrupted. One without rows or a name is removed.
  ~RecordingWriter();
  RecordingWriter(RecordingWriter&&) noexcept;

  /// In the order of their ticks, all edits of a tick in one or several calls. Those that lowered a
  /// level only where a body carries fractions.
  void append_edits(std::span<const Edit> edits);
  /// Whether a body carries fractions.
  bool has_fills() const;
  /// One sealed row for each tick, where `has_fills`, as append_cutting takes them.
  void append_fill_ends(std::span<const FillEndRow> rows);
  /// Sealed rows of consecutive ticks; one that follows on ticks that are left out has the fault
  /// kFaultRowsDropped.
  void append_ticks(std::span<const TickRecord> ticks);
  bool has_cutting() const;
  /// One for each tick, in their order, before or after it; a tick waits for its row. Only with
  /// RecordingTables::cutting.
  void append_cutting(std::span<const CuttingRecord> rows);
  bool has_port() const;
  /// The same with RecordingTables::port.
  void append_port(std::span<const PortRecord> rows);
  /// Pieces before their poses, answers before the tick that took them is flushed. Only with
  /// RecordingTables::pieces.
  void append_piece(const PieceRow& row);
  void append_piece_pose(const PiecePoseRow& row);
  void append_taken_answer(const TakenAnswerRow& row);
  bool has_pedal() const;
  /// Rising by tick, before that tick is flushed. Only with RecordingTables::pedal.
  void append_pedal(const PedalRow& row);
  /// After the tick it names was appended.
  void append_state_hash(const StateHash& hash);
  /// A state (save_state) right after a tick; rising by tick.
  void append_keyframe(std::uint64_t tick, std::span<const std::byte> state);

  /// summary.json of the run; once, before `close`.
  void append_summary(std::string_view text);

  void flush();
  /// Flushes, marks the recording as whole and closes it; nothing can be appended afterwards.
  /// Throws also where ticks still wait for edits that were never given.
  void close();

 private:
  struct File;
  std::unique_ptr<File> file_;
};

}  // namespace sulcus
