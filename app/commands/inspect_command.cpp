#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/common_options.hpp"
#include "app/commands/shipped_files.hpp"
#include "app/inspect/inspect.hpp"
#include "app/report/output_file.hpp"
#include "app/terminal/progress.hpp"
#include "engine/core/error.hpp"
#include "engine/core/file_kind.hpp"
#include "engine/core/units.hpp"
#include "engine/import/meshes/mesh_file.hpp"

namespace sulcus {

namespace {

struct InspectOptions {
  std::string file, picture, unit;
  std::vector<std::string> overrides;
  std::vector<double> spacing_mm;
  bool as_burr = false;
};

/// None: that of the file.
std::optional<Eigen::Vector3d> spacing_of(const InspectOptions& options) {
  if (options.spacing_mm.empty()) return std::nullopt;
  return Eigen::Vector3d(options.spacing_mm.data()) * kMillimetre;
}

/// Millimetres where none is said.
MeshUnit unit_of(const InspectOptions& options) {
  const auto* const named = std::ranges::find(kMeshUnitNames, options.unit);
  return named == kMeshUnitNames.end() ? MeshUnit::kMillimetre
                                       : MeshUnit(named - kMeshUnitNames.begin());
}

void inspect(const InspectOptions& options) {
  const std::string file = recording_file_of(scene_file_of(options.file));
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    throw InputError(file, "", "no such file", "a scene, recording, volume or mesh");
  }
  const bool scene = lower_extension(file) == ".toml", mesh = is_mesh_file(file);
  const bool recording = is_recording_file(file);
  if (!scene && !options.overrides.empty()) {
    throw InputError(file, "--set", "no scene", "a scene, .toml, whose keys it changes");
  }
  if (!mesh && options.as_burr) {
    throw InputError(file, "--as-burr", "no mesh", "a burr, .stl, .obj or .ply");
  }
  if (recording && !options.picture.empty()) {
    throw InputError(file, "--picture", "a recording", "sulcus render, which draws those");
  }
  if (!mesh && !options.unit.empty()) {
    throw InputError(file, "--unit", "no mesh", "a mesh, .stl, .obj or .ply");
  }
  if (!options.spacing_mm.empty() && (scene || mesh || recording)) {
    throw InputError(file, "--spacing-mm", "no volume", "a volume, whose voxels have that size");
  }
  check_output("--picture", options.picture, {".png"});
  const Progress progress("reading");
  if (scene) {
    inspect_scene(file, options.overrides, options.picture);
  } else if (recording) {
    inspect_recording(file);
  } else if (options.as_burr) {
    inspect_burr(file, unit_of(options), options.picture);
  } else if (mesh) {
    inspect_mesh(file, unit_of(options), options.picture);
  } else {
    inspect_volume(file, spacing_of(options), options.picture);
  }
}

}  // namespace

void add_inspect_command(CLI::App& program) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command =
      program.add_subcommand("inspect", "Show what a scene, recording, volume or mesh holds");
  add_option(*command, "FILE", options->file, "FILE", "File to look at")->required();
  add_option(*command, "--picture", options->picture, "FILE",
             "Draw a volume's sections and histogram, a mesh from three sides with axes, or a\n"
             "scene's burr, into a PNG file");
  constexpr double kLeast_mm = 1e-4, kMost_mm = 100.0;
  add_option(*command, "--spacing-mm", options->spacing_mm, "X Y Z",
             "Size of a volume's voxels, where its file does not say it")
      ->expected(3)
      ->check(number_within(kLeast_mm, kMost_mm));
  add_option(*command, "--unit", options->unit, "UNIT", "Of the numbers in a mesh file (mm)")
      ->check(
          CLI::IsMember(std::vector<std::string>(kMeshUnitNames.begin(), kMeshUnitNames.end())));
  command->add_flag("--as-burr", options->as_burr, "A mesh as the burr that it would be");
  add_set_option(*command, options->overrides, "Change a key of a scene; repeatable");
  command->callback([options] { inspect(*options); });
}

}  // namespace sulcus
