#include <memory>

#include "app/commands/common_options.hpp"
#include "app/commands/shipped_files.hpp"
#include "app/report/output_file.hpp"
#include "app/window/view_windows.hpp"
#include "engine/core/error.hpp"
#include "engine/core/file_kind.hpp"

namespace sulcus {

namespace {

struct ViewArguments : ViewOptions {
  std::string device = "scene", plugins;
};

void view(ViewArguments options) {
  options.mouse = options.device == "mouse";
  options.plugin_folders = plugin_folders(options.plugins);
  options.file = recording_file_of(scene_file_of(options.file));
  check_output_folder("-o", options.folder);
  if (is_recording_file(options.file)) {
    if (!options.overrides.empty()) {
      throw InputError("", "--set", "a recording to be looked at",
                       "a scene, or replay --from S --set");
    }
    view_recording(options);
  } else if (lower_extension(options.file) == ".toml") {
    view_scene(options);
  } else {
    throw InputError(options.file, "", "neither a scene nor a recording", "a .toml or .h5 file");
  }
}

}  // namespace

void add_view_command(CLI::App& program) {
  auto options = std::make_shared<ViewArguments>();
  CLI::App* command = program.add_subcommand(
      "view", "Open a window: a scene under the hand or the mouse, or a recording to be scrubbed");
  add_option(*command, "FILE", options->file, "FILE",
             "Scene, .toml; or recording, .h5, or the folder of a run with one")
      ->required();
  add_folder_options(*command, options->folder, options->force, "out/<name>_view");
  add_option(*command, "--device", options->device, "WHAT",
             "Who holds the burr: scene, its [device], or the mouse where it has none; or mouse")
      ->check(CLI::IsMember({"scene", "mouse"}));
  add_option(*command, "--plugins", options->plugins, "DIR",
             "Folder in which the scene's device plug-in is looked for first (the installed one)")
      ->check(CLI::ExistingDirectory);
  add_set_option(*command, options->overrides, "Change a key of the scene; repeatable");
  command->callback([options] { view(*options); });
}

}  // namespace sulcus
