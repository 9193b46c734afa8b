#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "app/common_options.hpp"
#include "app/recorded_run.hpp"
#include "app/scene_trajectory.hpp"
#include "app/shipped_scene.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/medical_volume.hpp"
#include "engine/import/mesh_file.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

namespace {

void inspect_recording(const std::string& file) {
  const RecordingReader reader(file);
  const RecordingHeader& header = reader.header();
  const Scene scene = recorded_scene(reader, file);
  std::printf("recording        %s\n", scene.title.c_str());
  std::printf("scene_sha256     %s\n", header.scene_sha256.c_str());
  std::printf("build            %s\n", header.build.c_str());
  std::printf("rate             %g Hz\n", header.rate_hz);
  const std::vector<TickRecord> rows = reader.ticks();
  std::printf("ticks            %zu (%.3f s)\n", rows.size(),
              static_cast<double>(rows.size()) / header.rate_hz);
  const std::vector<Edit> edits = reader.edits();
  const auto loose = std::ranges::count(edits, EditCause::kLoose, &Edit::cause);
  const auto others = std::ranges::count_if(edits, [](const Edit& e) { return e.body != 0; });
  std::printf("removed voxels   %zd cut",
              static_cast<std::ptrdiff_t>(edits.size()) - loose - others);
  if (scene.loose_pieces) std::printf(", %zd in pieces cut loose", loose);
  if (!scene.bodies.empty()) std::printf(", %zd of other bodies", others);
  std::printf("\n");
  const VoxelGrid& grid = reader.grid();
  std::printf("cells            %d x %d x %d of %g mm\n", grid.cells.x(), grid.cells.y(),
              grid.cells.z(), grid.voxel_m / kMillimetre);
  std::printf("solid voxels     %llu at the start\n",
              static_cast<unsigned long long>(reader.workpiece().solid_count()));
  if (!header.parent.empty()) std::printf("goes on from     %s\n", header.parent.c_str());
  for (const RecordingGap& gap : reader.gaps()) {
    std::printf("not recorded     ticks %llu to %llu\n", static_cast<unsigned long long>(gap.first),
                static_cast<unsigned long long>(gap.end - 1));
  }
  if (!header.repaired.empty()) std::printf("repaired         %s\n", header.repaired.c_str());
  std::printf("state            %s\n",
              reader.missing().empty() ? "whole" : reader.missing().c_str());
}

void inspect_scene(const std::string& file, const std::vector<std::string>& overrides) {
  const Scene scene = load_scene(file, overrides);
  const WorkpieceSettings& w = scene.workpiece;
  const Trajectory trajectory = scene_trajectory(scene);
  std::printf("scene            %s\n", scene.title.c_str());
  std::printf("workpiece        %s\n", w.shape ? "built-in shape" : w.file.c_str());
  std::printf("cells            %d x %d x %d of %g mm\n", w.cells.x(), w.cells.y(), w.cells.z(),
              w.voxel_m / kMillimetre);
  for (const TissueSettings& t : scene.tissues) {
    std::printf("tissue           %s: %g N/mm, %g J/mm3\n", t.name.c_str(),
                t.stiffness_N_per_m / kNewtonPerMillimetre,
                t.specific_energy_J_per_m3 / kJoulePerMm3);
  }
  for (const BodySettings& body : scene.bodies) {
    std::printf("body             %s%s\n", body.name.c_str(), body.cuttable ? ", cuttable" : "");
  }
  std::printf("trajectory       %.3f s, %.0f ticks\n", trajectory.duration_s(),
              trajectory.duration_s() * scene.haptics.rate_hz);
  std::printf("parts            %s%s%s%s%s\n", scene.device ? "device " : "",
              scene.coupling ? "coupling " : "", scene.cutting ? "cutting " : "",
              scene.render ? "render " : "", scene.record ? "record" : "");
}

/// Signed volume within the triangles, and how many edges have no partner in the other direction.
void inspect_mesh(const std::string& file) {
  const TriangleMesh mesh = read_mesh(file);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) box.extend(p);
  double volume_m3 = 0.0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[t[2]].cast<double>();
    volume_m3 += a.dot(b.cross(c)) / 6.0;
    for (int e = 0; e < 3; ++e) edges.emplace_back(t[e], t[(e + 1) % 3]);
  }
  std::sort(edges.begin(), edges.end());
  const auto open = std::count_if(edges.begin(), edges.end(), [&](const auto& e) {
    return !std::binary_search(edges.begin(), edges.end(), std::pair(e.second, e.first));
  });
  const Eigen::Vector3d size_mm = box.sizes().cast<double>() / kMillimetre;
  std::printf("mesh             %zu triangles, %zu vertices\n", mesh.triangles.size(),
              mesh.positions.size());
  std::printf("size             %.3f x %.3f x %.3f mm\n", size_mm.x(), size_mm.y(), size_mm.z());
  std::printf("volume           %.3f mm3\n", volume_m3 * 1e9);
  std::printf("open edges       %td%s\n", open, open == 0 ? " (closed)" : "");
}

void inspect_volume(const std::string& file) {
  const MedicalVolume volume = read_medical_volume(file);
  const auto [least, most] = std::minmax_element(volume.values.begin(), volume.values.end());
  const auto solid =
      std::count_if(volume.values.begin(), volume.values.end(), [](float v) { return v > 0.0f; });
  const Eigen::Vector3d mm = volume.spacing_m / kMillimetre;
  std::printf("volume           %d x %d x %d voxels\n", volume.sizes.x(), volume.sizes.y(),
              volume.sizes.z());
  std::printf("spacing          %g x %g x %g mm%s\n", mm.x(), mm.y(), mm.z(),
              volume.spacing_known ? "" : " (not said by the file)");
  std::printf("values           %g to %g\n", static_cast<double>(*least),
              static_cast<double>(*most));
  std::printf("voxels above 0   %td (%.3f mm3)\n", solid, static_cast<double>(solid) * mm.prod());
}

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
