#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <tbb/parallel_for.h>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/shapes/molar.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/pareto/pareto_measurement.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

namespace {

// The scene: the tooth as scenes/probe_sulcus.toml has it, its crown probed by a round burr.
constexpr double kVoxel = 34.8e-6;
constexpr double kBurrRadius = 20.0 * kVoxel, kDepth = 4.0 * kVoxel;
constexpr double kNeck = 1e-3;  // the crown is above
constexpr int kPoses = 200;
constexpr std::uint64_t kSeed = 1;
constexpr int kLinesPerVoxel = 4;

/// Samples across the burr; 0: "auto". The first is a scene's own, whose marks the chart joins.
constexpr int kFields[] = {128, 64, 32, 16, 0};
/// The truth's: a quarter of a voxel apart.
constexpr int kFineField = 192;

Burr burr_with(int samples) {
  BurrSettings settings;
  settings.diameter_m = 2.0 * kBurrRadius;
  settings.field_samples.reset();
  if (samples > 0) settings.field_samples = Eigen::Vector3i(samples, 4 * samples, samples);
  return make_burr(settings, kVoxel);
}

/// What making voxels of the tooth does to the force, in truth.
struct Voxelisation {
  double whole_pct = 0.0, magnitude_pct = 0.0;  // RMS
  double direction_deg = 0.0;                   // RMS
};

Voxelisation voxelisation_error(const KnownSurface& surface, const Burr& burr,
                                const std::vector<PressedPose>& poses) {
  std::vector<Eigen::Vector3d> forces(poses.size());
  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t p) {
    forces[p] = continuum_force(surface, burr, poses[p].world_from_tool, poses[p].truth.box_world,
                                TissueSettings().stiffness_N_per_m, kLinesPerVoxel);
  });
  double whole = 0.0, magnitude = 0.0, direction = 0.0;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    const Eigen::Vector3d& voxels = poses[p].truth.force_N;
    const Eigen::Vector3d& smooth = forces[p];
    whole += (voxels - smooth).squaredNorm() / smooth.squaredNorm();
    magnitude += std::pow(voxels.norm() / smooth.norm() - 1.0, 2);
    direction += std::pow(std::atan2(voxels.cross(smooth).norm(), voxels.dot(smooth)), 2);
  }
  const auto rms = [&](double sum) { return std::sqrt(sum / static_cast<double>(poses.size())); };
  return {100.0 * rms(whole), 100.0 * rms(magnitude), rms(direction) / kDegree};
}

std::string field_name(int samples) { return samples > 0 ? std::to_string(samples) : "auto"; }

std::string name_of(const ParetoSetting& setting) {
  return std::string(kNormalMethodNames[static_cast<std::size_t>(setting.method)]);
}

std::string csv_line(const ParetoRow& row, const Burr& burr) {
  char numbers[160];
  std::snprintf(numbers, sizeof numbers, ",%d,%d,%.2f,%.2f,%.4f,%.4f,%d,%.4f,%.4f",
                row.setting.neighbourhood, burr.field.samples().x(), row.tick_us, row.normals_us,
                row.whole_pct, row.normal_error_deg, row.on_front ? 1 : 0, row.directions_pct,
                row.own_weights_pct);
  return name_of(row.setting) + numbers;
}

void print(const std::vector<ParetoRow>& rows, const Voxelisation& voxelisation) {
  std::printf(
      "Net force of a burr of 20 voxels, 4 deep, at %d poses on the crown: RMS error in %%\n",
      kPoses);
  std::printf("%-22s %10s %10s %12s %12s %12s %10s\n", "", "tick us", "normals us", "whole tick",
              "directions", "own weights", "mean deg");
  const auto line = [](const ParetoRow& row, const std::string& field) {
    std::printf("%-16s %2d %-5s %7.1f %10.1f %12.3f %12.3f %12.3f %10.3f\n",
                name_of(row.setting).c_str(), row.setting.neighbourhood, field.c_str(), row.tick_us,
                row.normals_us, row.whole_pct, row.directions_pct, row.own_weights_pct,
                row.normal_error_deg);
  };
  for (const ParetoRow& row : rows) {
    if (row.setting.neighbourhood == HapticsSettings().neighbourhood && row.setting.field == 0) {
      line(row, field_name(kFields[0]));
    }
  }
  std::printf("The front\n");
  for (const ParetoRow& row : rows) {
    if (row.on_front) line(row, field_name(kFields[row.setting.field]));
  }
  std::printf(
      "The voxels themselves, with analytic normals, against the continuous surface:\n"
      "  %.3f %%; magnitude %.3f %%, direction %.3f degrees\n",
      voxelisation.whole_pct, voxelisation.magnitude_pct, voxelisation.direction_deg);
}

void pareto(const std::string& folder) {
  Results results(folder);
  const ProgressLine line;
  const auto progress = [&](const std::string& what) { line.say(what); };
  progress("the tooth and the poses");
  const Molar molar;
  VoxelGrid grid;
  grid.cells = Eigen::Vector3i::Constant(512);
  grid.voxel_m = kVoxel;
  const Workpiece workpiece{voxelise_implicit(molar, grid, nullptr)};
  const ComposedShape shape({side_of(molar)}, molar.bounds());
  KnownSurface surface(workpiece, shape);
  const Burr fine = burr_with(kFineField);
  const std::vector<PressedPose> poses =
      pressed_poses(surface, fine, kBurrRadius, kDepth, kNeck, kPoses, kSeed, HapticsSettings());

  progress("the continuous surface");
  const Voxelisation voxelisation = voxelisation_error(surface, fine, poses);

  std::vector<Burr> burrs;
  for (const int samples : kFields) burrs.push_back(burr_with(samples));
  const std::vector<ParetoRow> rows =
      measure_pareto(surface, burrs, poses, pareto_settings(burrs.size()), progress);
  line.clear();

  CsvFile csv(results.table("pareto.csv"),
              "method,ns,field_samples,tick_us,normals_us,force_error_pct,normal_error_deg,"
              "on_front,directions_error_pct,own_weights_error_pct");
  for (const ParetoRow& row : rows) csv.write(csv_line(row, burrs[row.setting.field]));
  results.draw("pareto", "pareto");
  print(rows, voxelisation);
  results.print();
}

}  // namespace

void add_pareto_command(CLI::App& program) {
  auto folder = std::make_shared<std::string>("out/lab/pareto");
  CLI::App* command = program.add_subcommand(
      "pareto", "Time of a tick against the error of its force, by method, NS and distance field");
  command->add_option("-o", *folder, "Folder for the results (out/lab/pareto)");
  command->footer(
      "The built-in molar at 512^3, a round burr of 20 voxels' radius, 4 deep, at 200 random "
      "poses\n"
      "on the crown. The truth: the same voxels with the analytic normals at their closest "
      "points, and\n"
      "depths there. Writes into the folder:\n"
      "  pareto.csv   force_error_pct: of a tick's force as it is, RMS; directions_error_pct: "
      "with\n"
      "               the true depths and weights; own_weights_error_pct: with the tick's, "
      "against\n"
      "               the true normals; normal_error_deg: mean over the contacts\n"
      "  pareto.png   force_error_pct against tick_us, and the front\n"
      "Times are thread CPU time, best of three.");
  command->callback([folder] { pareto(*folder); });
}

}  // namespace sulcus::lab
