#pragma once

#include <cstddef>
#include <vector>

#include "app/pictures/camera_option.hpp"
#include "app/pictures/picture_options.hpp"
#include "app/playback/film_colours.hpp"
#include "app/playback/recorded_film.hpp"
#include "app/terminal/progress.hpp"
#include "engine/graphics/renderer.hpp"

namespace sulcus {

/// The pictures that were asked for: rows of a recording, each from every camera.
class AskedPictures {
 public:
  /// Both outlive it. InputError as RecordedFilm and FilmColours, and where an option is not of
  /// this recording.
  AskedPictures(const RecordingReader& reader, const PictureOptions& options);

  void write_video();
  void write_sheet();
  void write_files();

 private:
  void set_hud(bool figures);
  /// Draws them all, and hands on what is drawn: `take(image, camera, row)`.
  template <class Take>
  void draw(const Take& take) {
    Progress progress("drawing");
    std::size_t drawn = 0;
    for (const std::size_t row : rows_) {
      progress.at(drawn++, rows_.size());
      FrameState state = film_.seek_row(row, renderer_);
      colours_.show(row, film_, renderer_, state);
      for (const NamedViewpoint& camera : cameras_) {
        renderer_.set_viewpoint(camera.from);
        take(renderer_.draw(state), camera, row);
      }
    }
  }

  const PictureOptions& options_;
  const RecordingReader& reader_;
  RecordedFilm film_;
  RenderSettings settings_;
  std::vector<NamedViewpoint> cameras_;
  Renderer renderer_;
  FilmColours colours_;
  std::vector<std::size_t> rows_;
};

}  // namespace sulcus
