#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/triangle_mesh.hpp"
#include "engine/recording/earlier_run.hpp"
#include "engine/recording/recording_header.hpp"
#include "engine/recording/tick_record.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/input_geometry.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Whether any program opens the file as it is: its writer has closed it.
bool opens_without_swmr(const std::string& path);

/// Reads a recording: one closed cleanly, one whose writer was killed, or one that still grows in
/// another process (as far as it was when opened). Not thread-safe.
///
/// What can be trusted is found once, on opening: every row up to the last tick that is intact,
/// follows on the one before it and has all its edits, intact too. What comes after is not given,
/// and `missing` says so. Nothing but the rows asked for is held in memory.
///
/// Errors: InputError where there is no such file, it is no recording, one of a newer version, or
/// damaged before its rows; also later, where the file changed underneath.
class RecordingReader {
 public:
  static constexpr std::size_t kAll = static_cast<std::size_t>(-1);

  explicit RecordingReader(const std::string& path);
  ~RecordingReader();
  RecordingReader(RecordingReader&&) noexcept;

  const std::string& path() const;
  const RecordingHeader& header() const;
  /// Of the workpiece, then of the other bodies.
  const std::vector<VoxelGrid>& grids() const;
  const VoxelGrid& grid() const { return grids().front(); }
  /// Whether one of them carries fractions.
  bool has_fills() const;
  /// The workpiece before the first tick. Labels of leaves without a solid voxel are 0.
  VoxelModel workpiece() const;
  /// The other bodies before the first tick, in the order of the scene.
  std::vector<VoxelModel> bodies() const;
  /// What the file of its goal holds, on the workpiece's grid; none where no goal names one.
  std::optional<VoxelModel> goal() const;
  /// What came before the first tick, where it goes on from another; none else, and in those that
  /// were made before they had it.
  std::optional<EarlierRun> earlier() const;
  /// Where the workpiece's file lies; none of a built-in shape, and in older recordings.
  std::optional<InputGeometry> input() const;
  /// The burr in metres, tool space; empty where the scene alone gives it.
  std::optional<TriangleMesh> burr_mesh() const;

  /// Which of the tables that not every scene needs it has.
  RecordingTables tables() const;
  std::size_t tick_count() const;
  /// Edits of these ticks: voxels that went, and levels that fell.
  std::size_t edit_count() const;
  std::size_t fill_count() const;
  /// Rows `first` to `first + count`, cut at the end.
  std::vector<TickRecord> ticks(std::size_t first = 0, std::size_t count = kAll) const;
  std::vector<Edit> edits(std::size_t first = 0, std::size_t count = kAll) const;
  /// Edits that lowered a level, and how many of them there are up to each tick; empty where no
  /// body carries fractions.
  std::vector<Edit> fills(std::size_t first = 0, std::size_t count = kAll) const;
  std::vector<FillEndRow> fill_ends(std::size_t first = 0, std::size_t count = kAll) const;
  /// What was cut in ticks `first` to `first + count`; none where the recording does not cut.
  std::vector<CuttingRecord> cutting(std::size_t first = 0, std::size_t count = kAll) const;
  /// Of the same ticks; empty where the recording has neither device nor coupling.
  std::vector<PortRecord> port(std::size_t first = 0, std::size_t count = kAll) const;
  /// Of these ticks, rising; none where no pieces may come loose.
  const std::vector<PieceRow>& pieces() const;
  const std::vector<PiecePoseRow>& piece_poses() const;
  const std::vector<TakenAnswerRow>& taken_answers() const;
  /// Changes of these ticks, rising; none where the device has no pedal.
  const std::vector<PedalRow>& pedal() const;
  /// Of these ticks, rising.
  const std::vector<StateHash>& state_hashes() const;
  /// Of these ticks, rising; the first may be of the tick before them, from which a recording goes
  /// on that has a parent.
  const std::vector<KeyframeInfo>& keyframes() const;
  /// The bytes of one; none where they are damaged.
  std::optional<std::vector<std::byte>> keyframe(const KeyframeInfo& info) const;
  /// Ticks between these whose rows were not recorded, rising.
  const std::vector<RecordingGap>& gaps() const;

  /// Empty where the recording is whole, else one line: where it ends and why.
  const std::string& missing() const;
  /// What of it is there but damaged, and hides what comes after; empty where nothing is. One whose
  /// writer was killed lacks its end and is not damaged.
  const std::string& damage() const;
  /// Rows of /ticks that it says it has; `tick_count` of them can be trusted.
  std::uint64_t tick_rows() const;
  /// summary.json of its run; none where that was not ended, and in older recordings.
  const std::optional<std::string>& summary() const;

 private:
  struct File;
  std::unique_ptr<File> file_;
};

}  // namespace sulcus
