#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/common_options.hpp"
#include "app/pictures/asked_pictures.hpp"
#include "app/playback/film_colours.hpp"
#include "app/report/output_file.hpp"
#include "app/report/review_page.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/recording/image_set_file.hpp"

namespace sulcus {

namespace {

struct RenderOptions : PictureOptions {
  std::string review;
};

void check(const RenderOptions& options) {
  if (!options.at_s.empty() && options.fps > 0.0) {
    throw InputError("", "--fps", "both --at and --fps", "one of them");
  }
  if (!options.video.empty() && options.cameras.size() > 1) {
    throw InputError("", "--video", std::to_string(options.cameras.size()) + " cameras",
                     "one of them");
  }
  const bool has_kinds = !options.kinds.empty() || !options.data.empty();
  if (!options.review.empty() &&
      (has_kinds || options.stereo_mm > 0.0 || options.ghost || options.no_tool ||
       options.scale_mm > 0.0 || !options.at_s.empty() || options.fps > 0.0 ||
       !options.cameras.empty() || !options.size.empty() || !options.section.empty() ||
       !options.video.empty() || !options.sheet.empty() || !options.folder.empty() ||
       options.colour_by != "tissue" || options.contacts)) {
    throw InputError("", "--review", "other options beside it", "it alone: the page has its own");
  }
  if (!options.video.empty() && !options.sheet.empty()) {
    throw InputError("", "--video", "both --video and --sheet", "one of them");
  }
  if (options.sound && options.video.empty() && options.review.empty()) {
    throw InputError("", "--sound", "no video", "--video or --review beside it");
  }
  if (!options.video.empty() || !options.sheet.empty()) {
    const char* const one = options.video.empty() ? "--sheet" : "--video";
    if (has_kinds) throw InputError("", one, "--kind or --data beside it", "one of them");
    if (options.stereo_mm > 0.0) throw InputError("", one, "--stereo beside it", "one of them");
  }
  if (has_kinds && options.contacts) {
    throw InputError("", "--contacts", "marks over pictures of --kind", "--kind contact");
  }
  if (options.scale_mm > 0.0 && options.colour_by != "goal") {
    throw InputError("", "--scale", "colours by " + options.colour_by, "--colour-by goal");
  }
  if ((options.from_s || options.to_s) && options.fps <= 0.0) {
    throw InputError("", options.from_s ? "--from" : "--to", "no --fps", "--fps beside it");
  }
  check_output("--data", options.data, {".h5", ".hdf5"});
  if (is_other_hdf5_file(options.data)) {
    throw InputError(options.data, "--data", "another file of HDF5",
                     "a new name, or pictures to be replaced");
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
  } else if (!options.data.empty() || !options.kinds.empty()) {
    pictures.write_kinds();
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
      ->check(number_within(0.01, 1000.0));
  add_option(*command, "--from", options->from_s, "S", "From there on, with --fps (the start)");
  add_option(*command, "--to", options->to_s, "S", "Up to there, with --fps (the end)");
  add_option(*command, "--size", options->size, "WxH", "Pixels (as the scene says)");
  add_option(*command, "--camera", options->cameras, "CAMERA",
             "review, occlusal, buccal, mesial, burr (which follows it), or\n"
             "AZIMUTH,ELEVATION[,ZOOM[,X,Y,Z]]: degrees from mesial to lingual and up, times\n"
             "nearer, the point in the middle, mm; repeatable")
      ->expected(1)
      ->take_all();
  add_option(*command, "--section", options->section, "AXIS=MM",
             "Cut open across an axis, such as y=0 (mm), or none (as the scene says; of\n"
             "pictures of a goal: through its middle, unless one looks down into it)");
  add_option(*command, "--colour-by", options->colour_by, "WHAT",
             "tissue; time: when it was cut; goal: how far it is from the wall of the\n"
             "scene's [goal]; contacts: in how many ticks it was touched (the run is computed\n"
             "again); normal_error: how far the normals that are felt are off those of the\n"
             "exact method (slow: found anew for each time); temperature: of a scene with\n"
             "[heat], also in a section")
      ->check(
          CLI::IsMember(std::vector<std::string>(kColourByNames.begin(), kColourByNames.end())));
  add_option(*command, "--scale", options->scale_mm, "MM",
             "Of --colour-by goal: the scale ends so far from the planned wall (0.5)")
      ->check(number_within(0.001, 100.0));
  command->add_flag("--ghost", options->ghost,
                    "Show the planned cavity of [goal], palely over everything");
  command->add_flag("--arrows", options->arrows, "Show force and torque at the burr");
  command->add_flag("--contacts", options->contacts,
                    "Show the voxels in contact, by their force (some ticks are computed again)");
  command->add_flag("--no-hud", options->no_hud, "No figures; a scale of colours stays");
  command->add_flag("--no-handpiece", options->no_handpiece, "The burr alone, without a handpiece");
  command->add_flag("--no-tool", options->no_tool, "Neither burr nor handpiece");
  add_option(*command, "--kind", options->kinds, "KIND,...",
             "Pictures for data sets, without figures: colour, depth (mm along the optical\n"
             "axis; 0: nothing), labels (tissue, as in the volume), normals (camera space),\n"
             "contact (which pixels show a voxel in contact); PNG and images.json in -o")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(kImageKinds.begin(), kImageKinds.end())));
  add_option(*command, "--data", options->data, "FILE",
             "Write them into one file of HDF5, .h5, instead (all kinds, without --kind)");
  add_option(*command, "--stereo", options->stereo_mm, "MM",
             "A second picture from so far to the right, axes parallel")
      ->check(number_within(0.001, 1000.0));
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
