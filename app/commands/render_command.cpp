#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
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
#include "app/commands/output_file.hpp"
#include "app/commands/section_range.hpp"
#include "app/commands/video_writer.hpp"
#include "app/playback/film_colours.hpp"
#include "app/playback/recorded_film.hpp"
#include "app/report/review_page.hpp"
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
  bool arrows = false, contacts = false, no_hud = false, no_handpiece = false;
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
      char text[48];
      std::snprintf(text, sizeof text, "_%c=%g", "xyz"[settings.section->axis],
                    settings.section->at_m / kMillimetre);
      shown_ += text;
    }
    if (options.contacts) shown_ += "_contacts";
  }

  /// Such as occlusal_7.500s_by_goal, without an end.
  std::string of(const std::string& camera, const TickRecord& row) const {
    char time[48];
    std::snprintf(time, sizeof time, "_%0*.*fs", digits_, decimals_, row.time_s);
    return camera + time + shown_;
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

/// Draws rows from each camera, and hands on what is drawn: `take(image, camera, row)`.
template <class Take>
void draw_rows(RecordedFilm& film, FilmColours& colours, Renderer& renderer,
               std::span<const std::size_t> rows, std::span<const NamedViewpoint> cameras,
               const Take& take) {
  Progress progress("drawing");
  std::size_t drawn = 0;
  for (const std::size_t row : rows) {
    progress.at(drawn++, rows.size());
    FrameState state = film.seek_row(row, renderer);
    colours.show(row, film, renderer, state);
    for (const NamedViewpoint& camera : cameras) {
      renderer.set_viewpoint(camera.from);
      take(renderer.draw(state), camera, row);
    }
  }
}

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
  if (!options.video.empty()) {
    check_output("--video", options.video, {".mp4", ".mov", ".mkv", ".avi"});
  }
  if (!options.sheet.empty()) check_output("--sheet", options.sheet, {".png"});
  if (!options.review.empty()) check_output("--review", options.review, {".html", ".htm"});
  if (!options.folder.empty()) check_output_folder("-o", options.folder);
}

void render(RenderOptions options) {
  check(options);
  std::optional<Progress> progress(std::in_place, "reading");
  const RecordingReader reader(options.recording);
  if (!options.review.empty()) {
    progress.emplace("drawing");
    write_review_page(reader, options.recording, options.review);
    say_what_is_missing(reader);
    say("%s\n", options.review.c_str());
    return;
  }
  RecordedFilm film(reader, options.recording);
  say_what_is_missing(reader);
  const RenderSettings settings = render_settings(film, options);
  std::vector<NamedViewpoint> cameras;
  for (const std::string& text : options.cameras) cameras.push_back(viewpoint_of(text));
  if (cameras.empty()) {
    cameras.push_back(
        {std::string(kCameraNames[static_cast<std::size_t>(settings.camera)]), settings.camera});
  }
  Renderer renderer(settings, film.bodies(), film.burr().mesh_tool, film.burr().head_length_m);
  renderer.set_handpiece(!options.no_handpiece);
  // Colours that stand for a quantity mean nothing without their scale.
  renderer.set_hud({settings.hud, settings.hud, settings.arrows, true});
  const auto by = std::ranges::find(kColourByNames, options.colour_by) - kColourByNames.begin();
  FilmColours colours(reader, options.recording, film, ColourBy(by), options.contacts, renderer);
  if (!options.video.empty() && options.fps <= 0.0) options.fps = 30.0;
  const std::vector<std::size_t> rows = rows_to_draw(film, options);
  progress.reset();

  if (!options.video.empty()) {
    VideoWriter video(options.video, settings.width, settings.height, options.fps);
    draw_rows(film, colours, renderer, rows, cameras,
              [&](const Image& image, const NamedViewpoint&, std::size_t) { video.add(image); });
    video.close();
    say("%s\n", options.video.c_str());
    return;
  }
  if (!options.sheet.empty()) {
    constexpr double kMostPixels = 1 << 28;
    const double pixels =
        static_cast<double>(rows.size() * cameras.size()) * settings.width * settings.height;
    if (pixels > kMostPixels) {
      throw InputError("", "--sheet",
                       std::to_string(rows.size() * cameras.size()) + " pictures of this --size",
                       "268 million pixels at most");
    }
    renderer.set_hud({settings.hud, false, settings.arrows, true});
    std::vector<Image> images;
    draw_rows(film, colours, renderer, rows, cameras,
              [&](Image image, const NamedViewpoint&, std::size_t) {
                images.push_back(std::move(image));
              });
    // A row to each time where there are several cameras.
    const auto columns =
        cameras.size() > 1 ? cameras.size() : std::min<std::size_t>(rows.size(), 4);
    write_png(sheet_of(images, static_cast<int>(columns)), options.sheet);
    say("%s\n", options.sheet.c_str());
    return;
  }
  if (options.folder.empty()) {
    options.folder = (std::filesystem::path(options.recording).parent_path() / "render").string();
  }
  make_output_folder("-o", options.folder);
  const PictureNames names(film, options, settings);
  std::size_t drawn = 0;
  draw_rows(film, colours, renderer, rows, cameras,
            [&](const Image& image, const NamedViewpoint& camera, std::size_t row) {
              const std::string file =
                  write_picture(image, options.folder, names.of(camera.name, film.rows()[row]));
              ++drawn;
              if (options.fps <= 0.0) say("%s\n", file.c_str());
            });
  if (options.fps > 0.0) say("%s: %zu pictures\n", options.folder.c_str(), drawn);
}

}  // namespace

void add_render_command(CLI::App& program) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* command = program.add_subcommand("render", "Draw pictures or a video of a recording");
  add_recording_argument(*command, options->recording);
  command->add_option("-o", options->folder, "Folder for the pictures (render/ beside it)")
      ->type_name("DIR");
  command->add_option("--at", options->at_s, "Time to draw, s; repeatable (the end)")
      ->type_name("S")
      ->expected(1)
      ->take_all();
  command->add_option("--fps", options->fps, "Draw the whole run, this many pictures a second")
      ->type_name("N")
      ->check(CLI::Range(0.01, 1000.0));
  command->add_option("--size", options->size, "Pixels (as the scene says)")->type_name("WxH");
  command
      ->add_option("--camera", options->cameras,
                   "review, occlusal, buccal, mesial, burr (which follows it), or\n"
                   "AZIMUTH,ELEVATION[,ZOOM] in degrees from mesial to lingual and up; repeatable")
      ->type_name("CAMERA")
      ->expected(1)
      ->take_all();
  command->add_option("--section", options->section, "Cut open across an axis, such as y=0 (mm)")
      ->type_name("AXIS=MM");
  command
      ->add_option(
          "--colour-by", options->colour_by,
          "tissue; time: when it was cut; goal: how far it is from the wall of the\n"
          "scene's [goal]; contacts: in how many ticks it was touched (the run is computed\n"
          "again); normal_error: how far the normals that are felt are off those of the\n"
          "exact method (slow: found anew for each time)")
      ->type_name("WHAT")
      ->check(
          CLI::IsMember(std::vector<std::string>(kColourByNames.begin(), kColourByNames.end())));
  command->add_flag("--arrows", options->arrows, "Show force and torque at the burr");
  command->add_flag("--contacts", options->contacts,
                    "Show the voxels in contact, by their force (some ticks are computed again)");
  command->add_flag("--no-hud", options->no_hud, "No figures; a scale of colours stays");
  command->add_flag("--no-handpiece", options->no_handpiece, "The burr alone, without a handpiece");
  command
      ->add_option("--video", options->video,
                   "Write a video, .mp4, .mov, .mkv or .avi (30 pictures a second)")
      ->type_name("FILE");
  command
      ->add_option("--sheet", options->sheet,
                   "Write all into one picture, .png: times down, cameras across")
      ->type_name("FILE");
  command
      ->add_option("--review", options->review,
                   "Write a page on the run, .html, that needs nothing beside it")
      ->type_name("FILE");
  command->callback([options] { render(*options); });
}

}  // namespace sulcus
