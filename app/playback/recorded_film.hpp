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
#include "engine/surface/drawn_surface.hpp"
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
    back ? take_back(edits, drawing) : apply(edits, drawing);
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
  static bool is_with(const Edit& a, const Edit& b) { return a.body == b.body && a.tick == b.tick; }

  /// Runs of one body and tick, one after another.
  template <class Drawing>
  void apply(std::span<const Edit> edits, Drawing& drawing) {
    for (std::size_t i = 0, end = 0; i < edits.size(); i = end) {
      clear_run();
      for (; end < edits.size() && is_with(edits[end], edits[i]); ++end) {
        const Edit& edit = edits[end];
        edit.is_gone() ? voxels_.push_back(edit.voxel)
                       : levels_.push_back({edit.voxel, edit.level});
      }
      const std::size_t body = edits[i].body;
      if (!levels_.empty()) drawing.set_levels(body, levels_);
      if (voxels_.empty()) continue;
      drawing.remove(body, voxels_, static_cast<double>(edits[i].tick) * dt_s_);
    }
  }
  /// The latest first. A voxel that comes back has the level with which it went.
  template <class Drawing>
  void take_back(std::span<const Edit> edits, Drawing& drawing) {
    for (std::size_t end = edits.size(), i = end; end > 0; end = i) {
      clear_run();
      for (; i > 0 && is_with(edits[i - 1], edits[end - 1]); --i) {
        const Edit& edit = edits[i - 1];
        edit.is_gone() ? voxels_.push_back(edit.voxel)
                       : levels_.push_back({edit.voxel, shape_.level_before(edit)});
      }
      const std::size_t body = edits[i].body;
      if (!voxels_.empty()) drawing.restore(body, voxels_);
      if (!levels_.empty()) drawing.set_levels(body, levels_);
    }
  }
  void clear_run() {
    voxels_.clear();
    levels_.clear();
  }

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
  // Of a run of edits.
  std::vector<std::uint32_t> voxels_;
  std::vector<VoxelLevel> levels_;
};

}  // namespace sulcus
