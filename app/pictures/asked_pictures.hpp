#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/pictures/image_kinds.hpp"
#include "app/pictures/picture_options.hpp"
#include "app/playback/film_colours.hpp"
#include "app/playback/recorded_contacts.hpp"
#include "app/playback/recorded_film.hpp"
#include "app/terminal/progress.hpp"
#include "engine/graphics/renderer.hpp"

namespace sulcus {

/// One of the pictures of a time.
struct Shot {
  std::string name;  // of the camera
  Viewpoint from;
  std::optional<Section> section;
  double eye_m = 0.0;  // to the right of the viewpoint
};

/// The pictures that were asked for: rows of a recording, each from every camera.
class AskedPictures {
 public:
  /// Both outlive it. InputError as RecordedFilm and FilmColours, and where an option is not of
  /// this recording.
  AskedPictures(const RecordingReader& reader, const PictureOptions& options);

  void write_video();
  void write_sheet();
  void write_files();
  /// Of several kinds, into a file or a folder. Says how many a second.
  void write_kinds();

 private:
  void set_hud(bool figures);
  ImageFrame frame_of(const FrameState& state, const Shot& shot, std::size_t row,
                      const ImageKinds& kinds);
  std::string make_folder() const;
  /// Goes through them all: `take(state, shot, row)`, with the renderer set for it.
  template <class Take>
  void go_through(const Take& take) {
    Progress progress("drawing");
    std::size_t drawn = 0;
    for (const std::size_t row : rows_) {
      progress.at(drawn++, rows_.size());
      FrameState state = film_.seek_row(row, renderer_);
      state.burr_shown = state.burr_shown && !options_.no_tool;
      colours_.show(row, film_, renderer_, state);
      for (const Shot& shot : shots_) {
        renderer_.set_viewpoint(shot.from);
        renderer_.set_section(shot.section);
        renderer_.set_eye_offset(shot.eye_m);
        take(state, shot, row);
      }
    }
  }
  /// The same with what is drawn: `take(image, shot, row)`.
  template <class Take>
  void draw(const Take& take) {
    go_through([&](const FrameState& state, const Shot& shot, std::size_t row) {
      take(renderer_.draw(state), shot, row);
    });
  }

  const PictureOptions& options_;
  const RecordingReader& reader_;
  RecordedFilm film_;
  RenderSettings settings_;
  std::optional<VoxelSet> target_;  // of a goal that is shown
  std::vector<Shot> shots_;
  Renderer renderer_;
  FilmColours colours_;
  std::vector<std::size_t> rows_;
  std::optional<RecordedContacts> contacts_;  // where a kind asks for them
};

}  // namespace sulcus
