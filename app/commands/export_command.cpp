#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/common_options.hpp"
#include "app/playback/recorded_run.hpp"
#include "app/playback/recorded_sound.hpp"
#include "app/playback/ticks_csv.hpp"
#include "app/playback/tool_path.hpp"
#include "app/report/output_file.hpp"
#include "app/report/page/page_mesh.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/meshes/write_glb.hpp"
#include "engine/import/volumes/write_volume.hpp"
#include "engine/surface/surface_colour.hpp"
#include "engine/surface/surface_mesh.hpp"

namespace sulcus {

namespace {

struct ExportOptions {
  std::string recording, mesh, volume, fills, csv, path, sound;
  std::string geometry;        // empty: file where the workpiece came from one, else scene
  std::optional<double> at_s;  // none: the end
  std::optional<double> simplify_mm;
  bool per_tissue = false;
};

/// In which space the result is written; none: the scene's.
std::optional<InputGeometry> wanted_space(const ExportOptions& options,
                                          const RecordingReader& reader) {
  std::optional<InputGeometry> input = reader.input();
  if (options.geometry == "scene") return {};
  if (!input && !options.geometry.empty()) {
    throw InputError(options.recording, "/input", "none: a built-in shape, or an older recording",
                     "--geometry scene");
  }
  const bool voxels = !options.volume.empty() || !options.fills.empty();
  if (options.geometry == "input" && voxels && !input->has_lattice()) {
    throw InputError(options.recording, "/input", "a mesh, which has no voxels",
                     "--geometry file or scene for a volume");
  }
  return input;
}

void export_volume(const std::string& file, const ExportOptions& options, const VoxelModel& model,
                   VolumeContent content, const std::optional<InputGeometry>& space) {
  if (!space) {
    write_volume(file, model, content);
  } else if (options.geometry == "input") {
    write_volume_on_input(file, model, content, *space);
  } else {
    write_volume_in_file_space(file, model, content, *space);
  }
}

/// In the format that the file's name asks for; .glb with the colours of the tissues. `mesh`: of
/// the model, in world space, which `space_from_world` moves where it is written.
void write_surface(const std::string& file, TriangleMesh mesh, const VoxelModel& model,
                   std::span<const TissueSettings> tissues,
                   const Eigen::Affine3d& space_from_world) {
  if (lower_extension(file) != ".glb") {
    transform(space_from_world, mesh);
    return write_mesh(file, mesh);
  }
  std::vector<TissueLook> looks;
  for (const TissueSettings& tissue : tissues) looks.push_back({tissue.name, tissue.colour});
  const SurfaceColour surface(std::move(looks));
  const std::vector<Eigen::Vector3f> normals = smoothed_normals(mesh);
  std::vector<Eigen::Vector3f> colours;
  colours.reserve(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Eigen::Vector3d p = model.grid.index_from_world(mesh.positions[v].cast<double>());
    const auto packed = surface.at(model, {}, p.cast<float>(), normals[v], false).colour_cut;
    const Eigen::Vector3f root = Eigen::Vector3f(packed[0], packed[1], packed[2]) / 255.0f;
    colours.emplace_back(root.cwiseProduct(root));
  }
  transform(space_from_world, mesh);
  write_glb(file, mesh, colours);
}

/// A tissue's name as a part of a file's: a scene from elsewhere must name no other folder.
std::string file_part(std::string name) {
  constexpr std::size_t kLongest = 64;
  std::ranges::replace_if(
      name, [](unsigned char c) { return c < ' ' || c == '/' || c == '\\' || c == 127; }, '_');
  return name.substr(0, kLongest);
}

/// A file for each tissue beside `file`: "cut.stl" gives "cut_enamel.stl" and so on. A name that is
/// taken gets its number.
std::vector<OutputOption> tissue_files(const std::string& file,
                                       std::span<const TissueSettings> tissues) {
  const std::filesystem::path path(file);
  std::vector<OutputOption> files;
  std::set<std::string> taken;
  for (const TissueSettings& tissue : tissues) {
    std::string name = file_part(tissue.name);
    if (!taken.insert(name).second) name += "_" + std::to_string(files.size() + 1);
    taken.insert(name);
    std::filesystem::path one = path;
    one.replace_filename(path.stem().string() + "_" + name + path.extension().string());
    files.push_back({"--mesh", one.string()});
  }
  return files;
}

/// The surface of each tissue (tissue_surfaces), moved by `space_from_world`, in its file; none of
/// a tissue with no voxel left.
void write_tissue_meshes(std::span<const OutputOption> files, const VoxelModel& model,
                         std::span<const TissueSettings> tissues,
                         const Eigen::Affine3d& space_from_world) {
  std::vector<TriangleMesh> meshes = tissue_surfaces(model, tissues.size());
  for (std::size_t t = 0; t < meshes.size(); ++t) {
    const std::string& file = files[t].file;
    const std::size_t triangles = meshes[t].triangles.size();
    if (triangles == 0) {
      say("%s: no voxel left\n", file_part(tissues[t].name).c_str());
      continue;
    }
    write_surface(file, std::move(meshes[t]), model, tissues, space_from_world);
    say("%s: %zu triangles\n", file.c_str(), triangles);
  }
}

/// Of all of the recording, from its first row on.
void export_sound(const std::string& file, const RecordingReader& reader,
                  const std::string& recording) {
  WholeFile sound(file);
  const Scene scene = recorded_scene(reader, recording);
  const double begin_s = reader.ticks(0, 1).front().time_s;
  write_recorded_sound(reader, scene, begin_s, std::numeric_limits<double>::infinity(), "--sound",
                       sound);
  sound.finish();
  say("%s\n", file.c_str());
}

void export_recording(const ExportOptions& options) {
  if (options.mesh.empty() && options.volume.empty() && options.fills.empty() &&
      options.csv.empty() && options.path.empty() && options.sound.empty()) {
    throw InputError("", "export", "nothing to write",
                     "--mesh, --volume, --fills, --csv, --path or --sound");
  }
  check_output("--mesh", options.mesh, {".stl", ".obj", ".ply", ".glb"});
  check_output("--volume", options.volume, {".nrrd", ".mha", ".nii.gz"});
  check_output("--fills", options.fills, {".nrrd", ".mha", ".nii.gz"});
  check_output("--csv", options.csv, {".csv"});
  check_output("--path", options.path, {".vtk", ".ply"});
  check_output("--sound", options.sound, {".wav"});
  std::vector<OutputOption> outputs{{"--volume", options.volume},
                                    {"--fills", options.fills},
                                    {"--csv", options.csv},
                                    {"--path", options.path},
                                    {"--sound", options.sound}};
  if (!options.per_tissue) outputs.push_back({"--mesh", options.mesh});
  check_outputs_differ(outputs);
  Progress progress("exporting");
  const RecordingReader reader(options.recording);
  if (reader.tick_count() == 0) {
    throw InputError(options.recording, "/ticks", "no rows", "at least one tick");
  }
  say_what_is_missing(reader);
  std::optional<Scene> scene;  // knows the tissues by name
  const bool coloured = lower_extension(options.mesh) == ".glb";
  if (options.per_tissue || coloured) scene = recorded_scene(reader, options.recording);
  std::vector<OutputOption> of_tissues;
  if (options.per_tissue) {
    of_tissues = tissue_files(options.mesh, scene->tissues);
    outputs.insert(outputs.end(), of_tissues.begin(), of_tissues.end());
    check_outputs_differ(outputs);
  }
  if (!options.sound.empty()) export_sound(options.sound, reader, options.recording);
  RecordedShape shape(reader, scene ? recorded_workpiece(reader, *scene) : reader.workpiece());
  const std::size_t row = options.at_s
                              ? asked_row(shape.rows(), *options.at_s, "--at", options.recording)
                              : shape.rows().size() - 1;
  shape.seek_row(row);
  const VoxelModel& model = shape.model();
  const std::optional<InputGeometry> space = wanted_space(options, reader);
  const Eigen::Affine3d space_from_world =
      space ? space->file_from_world : Eigen::Affine3d::Identity();
  if (options.per_tissue) {
    write_tissue_meshes(of_tissues, model, scene->tissues, space_from_world);
  } else if (!options.mesh.empty()) {
    TriangleMesh mesh = closed_surface(model);
    if (options.simplify_mm) mesh = simplified(mesh, *options.simplify_mm * kMillimetre).mesh;
    const std::size_t triangles = mesh.triangles.size();
    const auto tissues =
        scene ? std::span<const TissueSettings>(scene->tissues) : std::span<const TissueSettings>();
    write_surface(options.mesh, std::move(mesh), model, tissues, space_from_world);
    say("%s: %zu triangles\n", options.mesh.c_str(), triangles);
  }
  if (!options.volume.empty()) {
    export_volume(options.volume, options, model,
                  model.tissues ? VolumeContent::kLabels : VolumeContent::kMask, space);
    say("%s: %llu solid voxels%s\n", options.volume.c_str(),
        static_cast<unsigned long long>(model.solid_count()),
        options.geometry == "input" ? " of the run's grid, resampled" : "");
  }
  if (!options.fills.empty()) {
    export_volume(options.fills, options, model, VolumeContent::kFills, space);
    say("%s: fill levels\n", options.fills.c_str());
  }
  if (!options.csv.empty()) {
    write_ticks_csv(options.csv, reader, shape, row + 1);
    say("%s: %zu rows\n", options.csv.c_str(), row + 1);
  }
  if (!options.path.empty()) {
    write_tool_path(options.path, std::span(shape.rows()).first(row + 1), space_from_world);
    say("%s: %zu points\n", options.path.c_str(), row + 1);
  }
}

}  // namespace

void add_export_command(CLI::App& program) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command =
      program.add_subcommand("export", "Write the cut tooth, the curves or the sound");
  add_recording_argument(*command, options->recording);
  add_option(*command, "--at", options->at_s, "S", "Time, s (the end)");
  CLI::Option* mesh = add_option(
      *command, "--mesh", options->mesh, "FILE",
      "Closed surface, .stl, .obj or .ply, mm; .glb, m, +y up, with the tissues' colours");
  CLI::Option* per_tissue =
      command
          ->add_flag("--per-tissue", options->per_tissue,
                     "One closed mesh for each tissue, FILE_TISSUE.stl, with shared borders")
          ->needs(mesh);
  add_option(*command, "--simplify", options->simplify_mm, "MM",
             "Fewer triangles: of the vertices that go, none lies further than this from what\n"
             "stays, mm")
      ->check(number_within(0.001, 1.0))
      ->needs(mesh)
      ->excludes(per_tissue);
  add_option(*command, "--volume", options->volume, "FILE",
             "Voxels, .nrrd, .mha or .nii.gz: 0 empty, else 1 + tissue in the scene's order");
  add_option(*command, "--fills", options->fills, "FILE",
             "How much of each voxel is filled, 0 to 255, as --volume is written");
  add_option(*command, "--geometry", options->geometry, "SPACE",
             "file: in the space of the workpiece's file, over the scan (the default where\n"
             "it came from one); input: on the scan's own voxels; scene: the scene's space")
      ->check(CLI::IsMember({"file", "input", "scene"}));
  add_option(*command, "--csv", options->csv, "FILE",
             "One row per tick up to then, .csv: times, poses, forces; a [trajectory] takes it");
  add_option(*command, "--path", options->path, "FILE",
             "The way of the burr's tip up to then as a line, .vtk or .ply, mm, with times,\n"
             "forces and voxels removed; in the space of --geometry");
  add_option(*command, "--sound", options->sound, "FILE",
             "The handpiece as it sounds over the whole recording, .wav");
  command->callback([options] { export_recording(*options); });
}

}  // namespace sulcus
