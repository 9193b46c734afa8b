#include "app/pictures/asked_pictures.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "app/pictures/picture_files.hpp"
#include "app/pictures/section_range.hpp"
#include "app/playback/recorded_sound.hpp"
#include "app/report/output_file.hpp"
#include "app/report/video_writer.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {

namespace {

/// Those of --camera, else the scene's.
std::vector<NamedViewpoint> viewpoints(const PictureOptions& options,
                                       const RenderSettings& settings) {
  std::vector<NamedViewpoint> cameras;
  for (const std::string& text : options.cameras) cameras.push_back(viewpoint_of(text));
  if (cameras.empty()) {
    cameras.push_back(
        {std::string(kCameraNames[static_cast<std::size_t>(settings.camera)]), settings.camera});
  }
  return cameras;
}

/// Rows to be drawn, rising: those of --at, else every 1 / fps, else the last.
std::vector<std::size_t> rows_to_draw(const RecordedFilm& film, const PictureOptions& options) {
  std::vector<std::size_t> rows;
  for (const double time_s : options.at_s) {
    rows.push_back(asked_row(film.rows(), time_s, "--at", options.recording));
  }
  std::sort(rows.begin(), rows.end());
  if (options.fps > 0.0) {
    const double end_s = film.rows().back().time_s;
    for (std::uint64_t frame = 0; static_cast<double>(frame) / options.fps <= end_s; ++frame) {
      rows.push_back(film.row_at(static_cast<double>(frame) / options.fps));
    }
  }
  if (rows.empty()) rows.push_back(film.rows().size() - 1);
  return rows;
}

RenderSettings render_settings(const RecordedFilm& film, const PictureOptions& options) {
  RenderSettings settings = film.scene().render.value_or(RenderSettings{});
  if (!options.size.empty()) {
    const std::vector<double> size = numbers_of(options.size, 'x');
    const auto fits = [](double pixels) {
      return pixels >= 16 && pixels <= 8192 && pixels == static_cast<int>(pixels);
    };
    if (size.size() != 2 || !fits(size[0]) || !fits(size[1])) {
      throw InputError("", "--size", "'" + options.size + "'", "WxH, 16 to 8192 each");
    }
    settings.width = static_cast<int>(size[0]);
    settings.height = static_cast<int>(size[1]);
  }
  settings.arrows = settings.arrows || options.arrows;
  settings.hud = settings.hud && !options.no_hud;
  if (!options.section.empty()) {
    settings.section = parse_section(options.section);
    if (!settings.section) {
      throw InputError("", "--section", "'" + options.section + "'", kSectionForm);
    }
    check_section(*settings.section, film.bodies(), options.section);
  }
  return settings;
}

ColourBy colour_by(const PictureOptions& options) {
  return ColourBy(std::ranges::find(kColourByNames, options.colour_by) - kColourByNames.begin());
}

std::string_view text_of(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

AskedPictures::AskedPictures(const RecordingReader& reader, const PictureOptions& options)
    : options_(options),
      reader_(reader),
      film_(reader, options.recording),
      settings_(render_settings(film_, options)),
      cameras_(viewpoints(options, settings_)),
      renderer_(settings_, film_.bodies(), film_.burr().mesh_tool, film_.burr().head_length_m),
      colours_(reader, options.recording, film_, colour_by(options), options.contacts,
               settings_.section, renderer_),
      rows_(rows_to_draw(film_, options)) {
  renderer_.set_handpiece(!options.no_handpiece);
  set_hud(settings_.hud);
}

/// Colours that stand for a quantity mean nothing without their scale, which stays.
void AskedPictures::set_hud(bool figures) {
  renderer_.set_hud({.title = settings_.hud, .figures = figures, .arrows = settings_.arrows});
}

void AskedPictures::write_video() {
  // Beside the video for as long as that is written, and never finished.
  std::optional<WholeFile> sound;
  if (options_.sound) {
    sound.emplace(options_.video + ".wav");
    write_recorded_sound(reader_, film_.scene(), 0.0, "--sound", sound->beside());
  }
  VideoWriter video(options_.video, settings_.width, settings_.height, options_.fps,
                    sound ? sound->beside() : "");
  draw([&](const Image& image, const NamedViewpoint&, std::size_t) { video.add(image); });
  video.close();
  say("%s\n", options_.video.c_str());
}

void AskedPictures::write_sheet() {
  constexpr double kMostPixels = 1 << 28;
  const std::size_t count = rows_.size() * cameras_.size();
  if (static_cast<double>(count) * settings_.width * settings_.height > kMostPixels) {
    throw InputError("", "--sheet", std::to_string(count) + " pictures of this --size",
                     "268 million pixels at most");
  }
  set_hud(false);
  std::vector<Image> images;
  draw(
      [&](Image image, const NamedViewpoint&, std::size_t) { images.push_back(std::move(image)); });
  // A row to each time where there are several cameras.
  const auto columns =
      cameras_.size() > 1 ? cameras_.size() : std::min<std::size_t>(rows_.size(), 4);
  write_png(sheet_of(images, static_cast<int>(columns)), options_.sheet);
  say("%s\n", options_.sheet.c_str());
}

void AskedPictures::write_files() {
  std::string folder = options_.folder;
  if (folder.empty()) {
    folder = (std::filesystem::path(options_.recording).parent_path() / "render").string();
  }
  make_output_folder("-o", folder);
  const PictureNames names(film_, options_, settings_);
  std::size_t drawn = 0;
  draw([&](const Image& image, const NamedViewpoint& camera, std::size_t row) {
    const std::string file = write_beside_others(text_of(png_bytes(image)), folder,
                                                 names.of(camera.name, film_.rows()[row]), ".png");
    ++drawn;
    if (options_.fps <= 0.0) say("%s\n", file.c_str());
  });
  if (options_.fps > 0.0) say("%s: %zu pictures\n", folder.c_str(), drawn);
}

}  // namespace sulcus
