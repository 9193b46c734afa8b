#include "app/pictures/asked_pictures.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "app/pictures/camera_option.hpp"
#include "app/pictures/goal_section.hpp"
#include "app/pictures/image_sets.hpp"
#include "app/pictures/picture_files.hpp"
#include "app/pictures/section_range.hpp"
#include "app/playback/recorded_sound.hpp"
#include "app/report/output_file.hpp"
#include "app/report/video_writer.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/graphics/pinhole.hpp"
#include "engine/graphics/shown_voxel.hpp"

namespace sulcus {

namespace {

constexpr const char* kNoSection = "none";

bool shows_goal(const PictureOptions& options) { return options.colour_by == "goal"; }

std::optional<VoxelSet> shown_target(const RecordingReader& reader, const RecordedFilm& film,
                                     const PictureOptions& options) {
  if (!shows_goal(options) && !options.ghost) return {};
  return recorded_target(reader, options.recording, film,
                         options.ghost ? "--ghost" : "--colour-by");
}

/// Of each camera of --camera, else the scene's, the picture of each eye. Where a goal is shown and
/// no section was asked for, the tooth is cut open through it.
std::vector<Shot> shots_of(const PictureOptions& options, const RenderSettings& settings,
                           const std::optional<VoxelSet>& target) {
  std::vector<NamedViewpoint> cameras;
  for (const std::string& text : options.cameras) cameras.push_back(viewpoint_of(text));
  if (cameras.empty()) {
    cameras.push_back(
        {std::string(kCameraNames[static_cast<std::size_t>(settings.camera)]), settings.camera});
  }
  std::vector<Shot> shots;
  for (const NamedViewpoint& camera : cameras) {
    const auto is_it = [&](const Shot& shot) { return shot.name == camera.name; };
    if (std::ranges::any_of(shots, is_it)) {
      throw InputError("", "--camera", "'" + camera.name + "' twice", "cameras that differ");
    }
    Shot shot{camera.name, camera.from, settings.section};
    if (target && options.section.empty() && !settings.section) {
      shot.section = section_through(*target, camera.from);
    }
    shots.push_back(shot);
    if (options.stereo_mm <= 0.0) continue;
    shot.name += "_right";
    shot.eye_m = options.stereo_mm * kMillimetre;
    shots.push_back(shot);
  }
  return shots;
}

/// Every 1 / fps from a time on.
std::vector<std::size_t> rows_at_fps(const RecordedFilm& film, const PictureOptions& options) {
  const auto asked = [&](const std::optional<double>& time_s, const char* option, double other_s) {
    if (time_s) (void)asked_row(film.rows(), *time_s, option, options.recording);
    return time_s.value_or(other_s);
  };
  const double from_s = asked(options.from_s, "--from", film.rows().front().time_s);
  const double to_s = asked(options.to_s, "--to", film.rows().back().time_s);
  if (to_s < from_s) {
    throw InputError("", "--to", formatted("%g s", to_s),
                     formatted("%g s, which is --from, or later", from_s));
  }
  constexpr double kRounding = 1e-9;  // of frames
  std::vector<std::size_t> rows;
  for (std::uint64_t frame = 0;
       static_cast<double>(frame) <= (to_s - from_s) * options.fps + kRounding; ++frame) {
    rows.push_back(film.row_at(from_s + static_cast<double>(frame) / options.fps));
  }
  return rows;
}

/// Rows to be drawn, rising: those of --at, else every 1 / fps, else the last.
std::vector<std::size_t> rows_to_draw(const RecordedFilm& film, const PictureOptions& options) {
  if (options.fps > 0.0) return rows_at_fps(film, options);
  std::vector<std::size_t> rows;
  for (const double time_s : options.at_s) {
    rows.push_back(asked_row(film.rows(), time_s, "--at", options.recording));
  }
  std::sort(rows.begin(), rows.end());
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
  std::string section_text = options.section;
  if (options.section == kNoSection) {
    settings.section.reset();
  } else if (!options.section.empty()) {
    settings.section = parse_section(options.section);
    if (!settings.section) {
      throw InputError("", "--section", "'" + options.section + "'",
                       std::string(kSectionForm) + ", or none");
    }
  } else if (settings.section) {
    section_text =
        formatted("%c=%g", "xyz"[settings.section->axis], settings.section->at_m / kMillimetre) +
        ", of the scene's [render]";
  }
  if (settings.section) check_section(*settings.section, film.bodies(), section_text);
  return settings;
}

ColourBy colour_by(const PictureOptions& options) {
  return ColourBy(std::ranges::find(kColourByNames, options.colour_by) - kColourByNames.begin());
}

FilmColouring colouring(const PictureOptions& options, const RenderSettings& settings,
                        const std::optional<VoxelSet>& target) {
  FilmColouring asked{.by = colour_by(options),
                      .contact_marks = options.contacts,
                      .section = settings.section,
                      .target = target ? &*target : nullptr};
  if (options.scale_mm > 0.0) asked.goal_scale_m = options.scale_mm * kMillimetre;
  return asked;
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
      target_(shown_target(reader, film_, options)),
      shots_(shots_of(options, settings_, target_)),
      renderer_(settings_, film_.bodies(), film_.burr().mesh_tool, film_.burr().head_length_m),
      colours_(reader, options.recording, film_, colouring(options, settings_, target_), renderer_),
      rows_(rows_to_draw(film_, options)) {
  renderer_.set_handpiece(!options.no_handpiece);
  if (options.ghost) renderer_.set_ghost(model_of(*target_));
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
    const double end_s = film_.rows()[rows_.back()].time_s + 1.0 / options_.fps;
    write_recorded_sound(reader_, film_.scene(), film_.rows()[rows_.front()].time_s, end_s,
                         "--sound", *sound);
  }
  VideoWriter video(options_.video, settings_.width, settings_.height, options_.fps,
                    sound ? sound->beside() : "");
  draw([&](const Image& image, const Shot&, std::size_t) { video.add(image); });
  video.close();
  say("%s\n", options_.video.c_str());
}

void AskedPictures::write_sheet() {
  constexpr double kMostPixels = 1 << 28;
  const std::size_t count = rows_.size() * shots_.size();
  if (static_cast<double>(count) * settings_.width * settings_.height > kMostPixels) {
    throw InputError("", "--sheet", std::to_string(count) + " pictures of this --size",
                     "268 million pixels at most");
  }
  set_hud(false);
  std::vector<Image> images;
  draw([&](Image image, const Shot&, std::size_t) { images.push_back(std::move(image)); });
  // A row to each time where there are several cameras.
  const auto columns = shots_.size() > 1 ? shots_.size() : std::min<std::size_t>(rows_.size(), 4);
  write_png(sheet_of(images, static_cast<int>(columns)), options_.sheet);
  say("%s\n", options_.sheet.c_str());
}

std::string AskedPictures::make_folder() const {
  std::string folder = options_.folder;
  if (folder.empty()) {
    folder = (std::filesystem::path(options_.recording).parent_path() / "render").string();
  }
  make_output_folder("-o", folder);
  return folder;
}

void AskedPictures::write_files() {
  const std::string folder = make_folder();
  const PictureNames names(film_, options_);
  std::size_t drawn = 0;
  draw([&](const Image& image, const Shot& shot, std::size_t row) {
    const std::string file =
        write_beside_others(text_of(png_bytes(image)), folder,
                            names.of(shot.name, film_.rows()[row], shot.section), ".png");
    ++drawn;
    if (options_.fps <= 0.0) say("%s\n", file.c_str());
  });
  if (options_.fps > 0.0) say("%s: %zu pictures\n", folder.c_str(), drawn);
}

ImageFrame AskedPictures::frame_of(const FrameState& state, const Shot& shot, std::size_t row,
                                   const ImageKinds& kinds) {
  ImageFrame frame;
  frame.camera = shot.name;
  frame.time_s = film_.rows()[row].time_s;
  frame.tick = film_.rows()[row].tick;
  if (kinds.colour) frame.colour = renderer_.draw(state);
  if (kinds.depth || kinds.labels || kinds.normals || kinds.contact) {
    frame.geometry = renderer_.draw_geometry(state);
  }
  frame.pinhole = pinhole_of(renderer_.view(), settings_.width, settings_.height);
  if (!kinds.labels && !kinds.contact) return frame;
  const std::vector<std::uint32_t> voxels = shown_voxels(renderer_, frame.geometry, state.pieces);
  if (kinds.labels) frame.labels = labels_of(film_.scene(), renderer_, frame.geometry, voxels);
  if (kinds.contact) frame.contact = contacts_of(frame.geometry, voxels, contacts_->voxels());
  return frame;
}

void AskedPictures::write_kinds() {
  const ImageKinds kinds(options_.kinds);
  ImageSetFacts facts{options_.recording,
                      kinds,
                      kinds.labels ? label_table(film_.scene()) : std::vector<ImageLabel>{},
                      options_.stereo_mm,
                      rows_.size(),
                      static_cast<std::size_t>(settings_.width),
                      static_cast<std::size_t>(settings_.height)};
  // Figures are none of what is seen.
  renderer_.set_hud({.title = false, .figures = false, .arrows = false, .scales = false});
  if (kinds.contact) contacts_.emplace(options_.recording, false);
  const PictureNames names(film_, options_);
  std::optional<ImageSetInFile> file;
  std::optional<ImageSetInFolder> folder;
  if (options_.data.empty()) {
    folder.emplace(make_folder(), std::move(facts));
  } else {
    file.emplace(options_.data, std::move(facts));
  }
  std::size_t drawn = 0;
  const auto begin = std::chrono::steady_clock::now();
  std::size_t frames_begun = 0, last_row = film_.rows().size();
  go_through([&](const FrameState& state, const Shot& shot, std::size_t row) {
    if (&shot == &shots_.front()) {
      ++frames_begun;
      if (contacts_ && row != last_row) contacts_->seek_row(row);
      last_row = row;
    }
    ImageFrame frame = frame_of(state, shot, row, kinds);
    frame.frame = frames_begun - 1;
    if (file) file->add(frame);
    if (folder) folder->add(frame, names.of(shot.name, film_.rows()[row], shot.section));
    ++drawn;
  });
  if (file) file->finish();
  const std::string written = folder ? folder->finish() : options_.data;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  say("%s: %zu pictures of %zu kinds, %.1f a second\n", written.c_str(), drawn, kinds.count(),
      static_cast<double>(drawn) / took.count());
}

}  // namespace sulcus
