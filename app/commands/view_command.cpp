#include <memory>

#include "app/commands/common_options.hpp"
#include "app/commands/output_file.hpp"
#include "app/commands/shipped_scene.hpp"
#include "app/window/view_windows.hpp"
#include "engine/core/error.hpp"
#include "engine/core/file_kind.hpp"

namespace sulcus {

namespace {

void view(ViewOptions options) {
  options.file = scene_file_of(options.file);
  if (!options.folder.empty()) check_output_folder("-o", options.folder);
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
  auto options = std::make_shared<ViewOptions>();
  CLI::App* command = program.add_subcommand(
      "view", "Open a window: a scene under the mouse, or a recording to be scrubbed");
  command->add_option("FILE", options->file, "Scene, .toml, or recording, .h5")
      ->required()
      ->type_name("FILE");
  command->add_option("-o", options->folder, "Folder for the results (out/<name>_view)")
      ->type_name("DIR");
  add_force_option(*command, options->force);
  add_set_option(*command, options->overrides, "Change a key of the scene; repeatable");
  command->callback([options] { view(*options); });
}

}  // namespace sulcus
