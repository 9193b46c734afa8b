#include "app/playback/recorded_film.hpp"

#include "engine/core/error.hpp"

namespace sulcus {

RecordedFilm::RecordedFilm(const RecordingReader& reader, const std::string& path)
    : scene_(recorded_scene(reader, path)),
      burr_(recorded_burr(reader, scene_)),
      start_(recorded_workpiece(reader, scene_)),
      others_(recorded_bodies(reader, scene_)),
      earlier_(recorded_earlier(reader, scene_)),
      shape_(reader, start_, others_),
      cutting_(reader.cutting()),
      port_(reader.port()),
      dt_s_(1.0 / scene_.haptics.rate_hz),
      first_history_(scene_, start_, earlier_.get()),
      first_pieces_(reader) {
  if (rows().empty()) throw InputError(path, "/ticks", "no rows", "at least one tick");
  begin_again();
}

std::vector<RenderedBody> RecordedFilm::bodies() const {
  return rendered_bodies(scene_, start_, others_);
}

void RecordedFilm::begin_again() {
  history_.emplace(first_history_);
  pieces_.emplace(first_pieces_);
  next_ = first_piece_ = 0;
}

FrameState RecordedFilm::add_rows(std::size_t row, std::span<const Edit> edits) {
  for (; next_ <= row; ++next_) {
    history_->add(rows()[next_], next_ < cutting_.size() ? &cutting_[next_] : nullptr,
                  next_ < port_.size() ? &port_[next_] : nullptr);
  }
  for (const Edit& edit : edits) history_->add(edit);
  return history_->state();
}

}  // namespace sulcus
