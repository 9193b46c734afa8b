#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/common_options.hpp"
#include "app/inspect/inspect.hpp"
#include "app/shipped_scene.hpp"
#include "engine/core/error.hpp"
#include "engine/import/mesh_file.hpp"

namespace sulcus {

namespace {

void inspect(const std::string& given, const std::vector<std::string>& overrides) {
  const std::string file = scene_file_of(given);
  if (!std::filesystem::exists(file)) {
    throw InputError(file, "", "no such file", "a scene, recording, volume or mesh");
  }
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension != ".toml" && !overrides.empty()) {
    throw InputError(file, "--set", "no scene", "a scene, .toml, whose keys it changes");
  }
  if (extension == ".toml") {
    inspect_scene(file, overrides);
  } else if (extension == ".h5") {
    inspect_recording(file);
  } else if (is_mesh_file(file)) {
    inspect_mesh(file);
  } else {
    inspect_volume(file);
  }
}

}  // namespace

void add_inspect_command(CLI::App& program) {
  auto file = std::make_shared<std::string>();
  CLI::App* command =
      program.add_subcommand("inspect", "Say what a scene, recording, volume or mesh holds");
  command->add_option("FILE", *file, "File to look at")->required()->type_name("FILE");
  auto overrides = std::make_shared<std::vector<std::string>>();
  add_set_option(*command, *overrides, "Change a key of a scene; repeatable");
  command->callback([file, overrides] { inspect(*file, *overrides); });
}

}  // namespace sulcus
