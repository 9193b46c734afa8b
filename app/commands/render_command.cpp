#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/commands/common_options.hpp"
#include "app/commands/section_range.hpp"
#include "app/playback/film_colours.hpp"
#include "app/playback/recorded_film.hpp"
#include "app/playback/recorded_sound.hpp"
#include "app/report/output_file.hpp"
#include "app/report/review_page.hpp"
#include "app/report/video_writer.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/graphics/renderer.hpp"

namespace sulcus {

namespace {

struct RenderOptions {
  std::string recording, folder, size, section, colour_by = "tissue", video, sheet, review;
  std::vector<std::string> cameras;
  std::vector<double> at_s;
  double fps = 0.0;
  bool arrows = false, contacts = false, no_hud = false, no_handpiece = false, sound = false;
};

/// Reads numbers from all of a text, `separator` between them; empty where it is not that.
std::vector<double> numbers_of(std::string_view text, char separator) {
  std::vector<double> numbers;
  const char *at = text.data(), *end = at + text.size();
  while (at != end) {
    double number = 0.0;
    const auto [next, error] = std::from_chars(at, end, number);
    const bool more = error == std::errc{} && next != end;
    if (error != std::errc{} || (more && (*next != separator || next + 1 == end))) return {};
    numbers.push_back(number);
    at = more ? next + 1 : next;
  }
  return numbers;
}

struct NamedViewpoint {
  std::string name;
  Viewpoint from;
};

NamedViewpoint viewpoint_of(const std::string& text) {
  const auto found = std::find(kCameraNames.begin(), kCameraNames.end(), text);
  if (found != kCameraNames.end()) return {text, Camera(found - kCameraNames.begin())};
  const std::vector<double> numbers = numbers_of(text, ',');
  const bool fits = numbers.size() >= 2 && numbers.size() <= 3 && std::abs(numbers[0]) <= 360.0 &&
                    std::abs(numbers[1]) <= 90.0;
  if (!fits || (numbers.size() == 3 && !(numbers[2] >= 0.1 && numbers[2] <= 100.0))) {
    throw InputError(
        "", "--camera", "'" + text + "'",
        "review, occlusal, buccal, mesial, burr or AZIMUTH,ELEVATION[,ZOOM] in degrees");
  }
  NamedViewpoint given{text, Viewpoint(numbers[0], numbers[1])};
  if (numbers.size() == 3) given.from.zoom = numbers[2];
  std::ranges::replace(given.name, ',', '_');
  return given;
}

/// Those of --camera, else the scene's.
std::vector<NamedViewpoint> viewpoints(const RenderOptions& options,
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
std::vector<std::size_t> rows_to_draw(const RecordedFilm& film, const RenderOptions& options) {
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

RenderSettings render_settings(const RecordedFilm& film, const RenderOptions& options) {
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

/// What pictures are named by: what they show.
class PictureNames {
 public:
  PictureNames(const RecordedFilm& film, const RenderOptions& options,
               const RenderSettings& settings) {
    // Every tick has a time of its own.
    while (film.scene().haptics.rate_hz > std::pow(10.0, decimals_) && decimals_ < 9) ++decimals_;
    // Of many, so that they are in their order in a list.
    if (options.fps > 0.0) {
      digits_ = static_cast<int>(
                    std::to_string(static_cast<long long>(film.rows().back().time_s)).size()) +
                1 + decimals_;
    }
    if (options.colour_by != "tissue") shown_ += "_by_" + options.colour_by;
    if (settings.section) {
      shown_ +=
          formatted("_%c=%g", "xyz"[settings.section->axis], settings.section->at_m / kMillimetre);
    }
    if (options.contacts) shown_ += "_contacts";
  }

  /// Such as occlusal_7.500s_by_goal, without an end.
  std::string of(const std::string& camera, const TickRecord& row) const {
    return camera + formatted("_%0*.*fs", digits_, decimals_, row.time_s) + shown_;
  }

 private:
  int digits_ = 0, decimals_ = 3;
  std::string shown_;
};

/// Another picture of that name stays, and this one gets the next free one. Returns its file.
std::string write_picture(const Image& image, const std::string& folder, const std::string& name) {
  const std::vector<std::uint8_t> png = png_bytes(image);
  const std::string_view bytes(reinterpret_cast<const char*>(png.data()), png.size());
  for (int number = 1;; ++number) {
    const std::string file =
        folder + '/' + name + (number == 1 ? "" : "-" + std::to_string(number)) + ".png";
    std::ifstream before(file, std::ios::binary);
    if (!before) {
      write_whole_file(file, bytes);
      return file;
    }
    if (std::string(std::istreambuf_iterator<char>(before), {}) == bytes) return file;
  }
}

/// The pictures that were asked for: rows of a recording, each from every camera.
class AskedPictures {
 public:
  AskedPictures(const RecordingReader& reader, const RenderOptions& options)
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

  void write_video() {
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

  void write_sheet() {
    constexpr double kMostPixels = 1 << 28;
    const std::size_t count = rows_.size() * cameras_.size();
    if (static_cast<double>(count) * settings_.width * settings_.height > kMostPixels) {
      throw InputError("", "--sheet", std::to_string(count) + " pictures of this --size",
                       "268 million pixels at most");
    }
    set_hud(false);
    std::vector<Image> images;
    draw([&](Image image, const NamedViewpoint&, std::size_t) {
      images.push_back(std::move(image));
    });
    // A row to each time where there are several cameras.
    const auto columns =
        cameras_.size() > 1 ? cameras_.size() : std::min<std::size_t>(rows_.size(), 4);
    write_png(sheet_of(images, static_cast<int>(columns)), options_.sheet);
    say("%s\n", options_.sheet.c_str());
  }

  void write_files() {
    std::string folder = options_.folder;
    if (folder.empty()) {
      folder = (std::filesystem::path(options_.recording).parent_path() / "render").string();
    }
    make_output_folder("-o", folder);
    const PictureNames names(film_, options_, settings_);
    std::size_t drawn = 0;
    draw([&](const Image& image, const NamedViewpoint& camera, std::size_t row) {
      const std::string file =
          write_picture(image, folder, names.of(camera.name, film_.rows()[row]));
      ++drawn;
      if (options_.fps <= 0.0) say("%s\n", file.c_str());
    });
    if (options_.fps > 0.0) say("%s: %zu pictures\n", folder.c_str(), drawn);
  }

 private:
  static ColourBy colour_by(const RenderOptions& options) {
    return ColourBy(std::ranges::find(kColourByNames, options.colour_by) - kColourByNames.begin());
  }
  /// Colours that stand for a quantity mean nothing without their scale, which stays.
  void set_hud(bool figures) {
    renderer_.set_hud({.title = settings_.hud, .figures = figures, .arrows = settings_.arrows});
  }
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

  const RenderOptions& options_;
  const RecordingReader& reader_;
  RecordedFilm film_;
  RenderSettings settings_;
  std::vector<NamedViewpoint> cameras_;
  Renderer renderer_;
  FilmColours colours_;
  std::vector<std::size_t> rows_;
};

void check(const RenderOptions& options) {
  if (!options.at_s.empty() && options.fps > 0.0) {
    throw InputError("", "--fps", "both --at and --fps", "one of them");
  }
  if (!options.video.empty() && options.cameras.size() > 1) {
    throw InputError("", "--video", std::to_string(options.cameras.size()) + " cameras",
                     "one of them");
  }
  if (!options.review.empty() &&
      (!options.at_s.empty() || options.fps > 0.0 || !options.cameras.empty() ||
       !options.size.empty() || !options.section.empty() || !options.video.empty() ||
       !options.sheet.empty() || !options.folder.empty() || options.colour_by != "tissue" ||
       options.contacts)) {
    throw InputError("", "--review", "other options beside it", "it alone: the page has its own");
  }
  if (!options.video.empty() && !options.sheet.empty()) {
    throw InputError("", "--video", "both --video and --sheet", "one of them");
  }
  if (options.sound && options.video.empty() && options.review.empty()) {
    throw InputError("", "--sound", "no video", "--video or --review beside it");
  }
  check_output("--video", options.video, {".mp4", ".mov", ".mkv", ".avi"});
  check_output("--sheet", options.sheet, {".png"});
  check_output("--review", options.review, {".html", ".htm"});
  check_output_folder("-o", options.folder);
}

void render(RenderOptions options) {
  check(options);
  if (!options.video.empty() && options.fps <= 0.0) options.fps = 30.0;
  std::optional<Progress> progress(std::in_place, "reading");
  const RecordingReader reader(options.recording);
  if (!options.review.empty()) {
    progress.emplace("drawing");
    write_review_page(reader, options.recording, options.review,
                      options.sound ? ReviewVideo::kWithSound : ReviewVideo::kNone);
    say_what_is_missing(reader);
    say("%s\n", options.review.c_str());
    return;
  }
  AskedPictures pictures(reader, options);
  say_what_is_missing(reader);
  progress.reset();
  if (!options.video.empty()) {
    pictures.write_video();
  } else if (!options.sheet.empty()) {
    pictures.write_sheet();
  } else {
    pictures.write_files();
  }
}

}  // namespace

void add_render_command(CLI::App& program) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* command = program.add_subcommand("render", "Draw pictures or a video of a recording");
  add_recording_argument(*command, options->recording);
  add_option(*command, "-o", options->folder, "DIR", "Folder for the pictures (render/ beside it)");
  add_option(*command, "--at", options->at_s, "S", "Time to draw, s; repeatable (the end)")
      ->expected(1)
      ->take_all();
  add_option(*command, "--fps", options->fps, "N",
             "Draw the whole run, this many pictures a second")
      ->check(CLI::Range(0.01, 1000.0));
  add_option(*command, "--size", options->size, "WxH", "Pixels (as the scene says)");
  add_option(*command, "--camera", options->cameras, "CAMERA",
             "review, occlusal, buccal, mesial, burr (which follows it), or\n"
             "AZIMUTH,ELEVATION[,ZOOM] in degrees from mesial to lingual and up; repeatable")
      ->expected(1)
      ->take_all();
  add_option(*command, "--section", options->section, "AXIS=MM",
             "Cut open across an axis, such as y=0 (mm)");
  add_option(*command, "--colour-by", options->colour_by, "WHAT",
             "tissue; time: when it was cut; goal: how far it is from the wall of the\n"
             "scene's [goal]; contacts: in how many ticks it was touched (the run is computed\n"
             "again); normal_error: how far the normals that are felt are off those of the\n"
             "exact method (slow: found anew for each time); temperature: of a scene with\n"
             "[heat], also in a section")
      ->check(
          CLI::IsMember(std::vector<std::string>(kColourByNames.begin(), kColourByNames.end())));
  command->add_flag("--arrows", options->arrows, "Show force and torque at the burr");
  command->add_flag("--contacts", options->contacts,
                    "Show the voxels in contact, by their force (some ticks are computed again)");
  command->add_flag("--no-hud", options->no_hud, "No figures; a scale of colours stays");
  command->add_flag("--no-handpiece", options->no_handpiece, "The burr alone, without a handpiece");
  add_option(*command, "--video", options->video, "FILE",
             "Write a video, .mp4, .mov, .mkv or .avi (30 pictures a second)");
  command->add_flag("--sound", options->sound,
                    "Let the video sound as the handpiece did; of --review: with such a video");
  add_option(*command, "--sheet", options->sheet, "FILE",
             "Write all into one picture, .png: times down, cameras across");
  add_option(*command, "--review", options->review, "FILE",
             "Write a page on the run, .html, that needs nothing beside it");
  command->callback([options] { render(*options); });
}

}  // namespace sulcus
