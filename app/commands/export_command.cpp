#include <cstdio>
#include <memory>
#include <optional>

#include "app/commands/common_options.hpp"
#include "app/commands/output_file.hpp"
#include "app/commands/tissue_meshes.hpp"
#include "app/playback/recorded_run.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/volumes/write_volume.hpp"
#include "engine/surface/surface_mesh.hpp"

namespace sulcus {

namespace {

struct ExportOptions {
  std::string recording, mesh, volume, csv;
  std::string geometry;        // empty: file where the workpiece came from one, else scene
  std::optional<double> at_s;  // none: the end
  bool per_tissue = false;
};

void write_csv(const std::string& file, std::span<const TickRecord> rows) {
  WholeFile table(file);
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(table.beside().c_str(), "w"),
                                                      std::fclose);
  if (!out) table.fail_incomplete();
  std::fputs(
      "tick,time_s,tool_x_mm,tool_y_mm,tool_z_mm,tool_qw,tool_qx,tool_qy,tool_qz,"
      "force_x_N,force_y_N,force_z_N,torque_x_mNm,torque_y_mNm,torque_z_mNm,"
      "contacts,removed,step_us,late_us,faults\n",
      out.get());
  for (const TickRecord& r : rows) {
    const double *p = r.tool_position_m, *q = r.tool_orientation;
    const double *f = r.force_N, *t = r.torque_Nm;
    std::fprintf(out.get(),
                 "%llu,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,"
                 "%u,%u,%.4g,%.4g,%llu\n",
                 static_cast<unsigned long long>(r.tick), r.time_s, p[0] * 1e3, p[1] * 1e3,
                 p[2] * 1e3, q[0], q[1], q[2], q[3], f[0], f[1], f[2], t[0] * 1e3, t[1] * 1e3,
                 t[2] * 1e3, r.contacts, r.removed, static_cast<double>(r.step_us),
                 static_cast<double>(r.late_us), static_cast<unsigned long long>(r.faults));
  }
  const bool failed = std::ferror(out.get()) != 0;
  if (std::fclose(out.release()) != 0 || failed) table.fail_incomplete();
  table.finish();
}

/// In which space the result is written; none: the scene's.
std::optional<InputGeometry> wanted_space(const ExportOptions& options,
                                          const RecordingReader& reader) {
  std::optional<InputGeometry> input = reader.input();
  if (options.geometry == "scene") return {};
  if (!input && !options.geometry.empty()) {
    throw InputError(options.recording, "/input", "none: a built-in shape, or an older recording",
                     "--geometry scene");
  }
  if (options.geometry == "input" && !options.volume.empty() && !input->has_lattice()) {
    throw InputError(options.recording, "/input", "a mesh, which has no voxels",
                     "--geometry file or scene for a volume");
  }
  return input;
}

void export_volume(const ExportOptions& options, const VoxelModel& model,
                   const std::optional<InputGeometry>& space) {
  const VolumeContent content = model.tissues ? VolumeContent::kLabels : VolumeContent::kMask;
  if (!space) {
    write_volume(options.volume, model, content);
  } else if (options.geometry == "input") {
    write_volume_on_input(options.volume, model, content, *space);
  } else {
    write_volume_in_file_space(options.volume, model, content, *space);
  }
}

void export_recording(const ExportOptions& options) {
  if (options.mesh.empty() && options.volume.empty() && options.csv.empty()) {
    throw InputError("", "export", "nothing to write", "--mesh, --volume or --csv");
  }
  if (!options.mesh.empty()) check_output("--mesh", options.mesh, {".stl", ".obj", ".ply"});
  if (!options.volume.empty()) {
    check_output("--volume", options.volume, {".nrrd", ".mha", ".nii.gz"});
  }
  if (!options.csv.empty()) check_output("--csv", options.csv, {".csv"});
  Progress progress("exporting");
  const RecordingReader reader(options.recording);
  if (reader.tick_count() == 0) {
    throw InputError(options.recording, "/ticks", "no rows", "at least one tick");
  }
  say_what_is_missing(reader);
  std::optional<Scene> scene;  // knows the tissues by name
  if (options.per_tissue) scene = recorded_scene(reader, options.recording);
  RecordedShape shape(reader, scene ? recorded_workpiece(reader, *scene) : reader.workpiece());
  const std::size_t row = options.at_s
                              ? asked_row(shape.rows(), *options.at_s, "--at", options.recording)
                              : shape.rows().size() - 1;
  shape.seek_row(row);
  const VoxelModel& model = shape.model();
  const std::optional<InputGeometry> space = wanted_space(options, reader);
  const Eigen::Affine3d space_from_world =
      space ? space->file_from_world : Eigen::Affine3d::Identity();
  if (scene) {
    write_tissue_meshes(options.mesh, model, scene->tissues, space_from_world);
  } else if (!options.mesh.empty()) {
    TriangleMesh mesh = closed_surface(model);
    transform(space_from_world, mesh);
    write_mesh(options.mesh, mesh);
    say("%s: %zu triangles\n", options.mesh.c_str(), mesh.triangles.size());
  }
  if (!options.volume.empty()) {
    export_volume(options, model, space);
    say("%s: %llu solid voxels%s\n", options.volume.c_str(),
        static_cast<unsigned long long>(model.solid_count()),
        options.geometry == "input" ? " of the run's grid, resampled" : "");
  }
  if (!options.csv.empty()) {
    write_csv(options.csv, std::span(shape.rows()).first(row + 1));
    say("%s: %zu rows\n", options.csv.c_str(), row + 1);
  }
}

}  // namespace

void add_export_command(CLI::App& program) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = program.add_subcommand("export", "Write the cut tooth or the curves");
  add_recording_argument(*command, options->recording);
  command->add_option("--at", options->at_s, "Time, s (the end)")->type_name("S");
  CLI::Option* mesh =
      command->add_option("--mesh", options->mesh, "Closed surface, .stl, .obj or .ply, mm")
          ->type_name("FILE");
  command
      ->add_flag("--per-tissue", options->per_tissue,
                 "One closed mesh for each tissue, FILE_TISSUE.stl, with shared borders")
      ->needs(mesh);
  command
      ->add_option("--volume", options->volume,
                   "Voxels, .nrrd, .mha or .nii.gz: 0 empty, else 1 + tissue in the scene's order")
      ->type_name("FILE");
  command
      ->add_option("--geometry", options->geometry,
                   "file: in the space of the workpiece's file, over the scan (the default where\n"
                   "it came from one); input: on the scan's own voxels; scene: the scene's space")
      ->type_name("SPACE")
      ->check(CLI::IsMember({"file", "input", "scene"}));
  command->add_option("--csv", options->csv, "One row per tick up to then, .csv")
      ->type_name("FILE");
  command->callback([options] { export_recording(*options); });
}

}  // namespace sulcus
