#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/playback/recorded_run.hpp"
#include "app/session/frame_history.hpp"
#include "engine/graphics/rendered_body.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"

namespace sulcus {

/// A recording as it is drawn: any time of it, on or back, is brought into a drawing (a Renderer, a
/// GlScene), with what a frame shows besides the tooth.
class RecordedFilm {
 public:
  /// InputError as RecordingReader; also of one without rows.
  RecordedFilm(const RecordingReader& reader, const std::string& path);

  const Scene& scene() const { return scene_; }
  const Burr& burr() const { return burr_; }
  /// What a drawing is made of, as it is before the first row.
  std::vector<RenderedBody> bodies() const;
  const std::vector<TickRecord>& rows() const { return shape_.rows(); }
  /// The workpiece before the first row.
  const VoxelModel& start() const { return start_; }
  /// What came before that, where the recording goes on from another and says so; null else.
  const EarlierRun* earlier() const { return earlier_.get(); }
  std::size_t row_at(double time_s) const { return shape_.row_at(time_s); }
  std::span<const Edit> edits_before(std::size_t row) const { return shape_.edits_before(row); }
  /// Of the workpiece, at the row that was last gone to.
  const VoxelModel& model() const { return shape_.model(); }

  /// Brings to right after a row the one drawing that was made of `bodies()`. The state is valid
  /// until the next call.
  template <class Drawing>
  FrameState seek_row(std::size_t row, Drawing& drawing) {
    const bool back = next_ > row + 1;
    const std::span<const Edit> edits = shape_.seek_row(row);
    for (std::size_t i = 0; i < edits.size();) {  // runs of one body and tick
      std::size_t end = i;
      voxels_.clear();
      while (end < edits.size() && edits[end].body == edits[i].body &&
             edits[end].tick == edits[i].tick) {
        if (edits[end].is_gone()) voxels_.push_back(edits[end].voxel);
        ++end;
      }
      if (voxels_.empty()) {
        // Only less filled than they were.
      } else if (back) {
        drawing.restore(edits[i].body, voxels_);
      } else {
        drawing.remove(edits[i].body, voxels_, static_cast<double>(edits[i].tick) * dt_s_);
      }
      i = end;
    }
    if (back) begin_again();
    FrameState state = add_rows(row, back ? shape_.edits_before(row) : edits);
    std::size_t piece = 0;
    for (const auto& voxels : pieces_->advance_to_tick(state.tick)) {
      if (first_piece_ + piece++ < pieces_drawn_) continue;
      ++pieces_drawn_;
      if (!voxels.empty()) drawing.add_piece(voxels);
    }
    first_piece_ += piece;
    state.pieces = pieces_->poses();
    return state;
  }

 private:
  void begin_again();
  FrameState add_rows(std::size_t row, std::span<const Edit> edits);

  Scene scene_;
  Burr burr_;
  VoxelModel start_;
  std::vector<VoxelModel> others_;
  std::shared_ptr<const EarlierRun> earlier_;
  RecordedShape shape_;
  std::vector<CuttingRecord> cutting_;
  std::vector<PortRecord> port_;
  double dt_s_;
  // Up to the row before `next_`; begun again on the way back.
  const FrameHistory first_history_;
  const RecordedPieces first_pieces_;
  std::optional<FrameHistory> history_;
  std::optional<RecordedPieces> pieces_;
  std::size_t next_ = 0, first_piece_ = 0, pieces_drawn_ = 0;
  std::vector<std::uint32_t> voxels_;
};

}  // namespace sulcus
