#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

#include "app/inspect/burr_facts.hpp"
#include "app/inspect/inspect.hpp"
#include "app/playback/scene_trajectory.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/scene_keys.hpp"

namespace sulcus {

namespace {

void check_file(const Scene& scene, const std::string& key, const std::string& file) {
  std::error_code error;
  if (file.empty() || std::filesystem::exists(file, error)) return;
  throw InputError(scene.file, key, "'" + file + "', which is not there", "a file");
}

/// That what it names is there; what it holds, a run looks at.
void check_files(const Scene& scene) {
  check_file(scene, "workpiece.file", scene.workpiece.file);
  check_file(scene, "workpiece.labels", scene.workpiece.labels);
  for (const TissueSettings& tissue : scene.tissues) {
    check_file(scene, "tissue '" + tissue.name + "': file", tissue.file);
  }
  check_file(scene, "burr.file", scene.burr.file);
  for (const BodySettings& body : scene.bodies) {
    check_file(scene, "body '" + body.name + "': file", body.solid.file);
    check_file(scene, "body '" + body.name + "': labels", body.solid.labels);
  }
  if (scene.goal) check_file(scene, "goal.file", scene.goal->file);
}

/// The word that a scene has for one of a key's choices.
template <class Choice>
std::string word_of(const char* table, const char* key, Choice choice) {
  return std::string(find_scene_key(table, key)->words[static_cast<std::size_t>(choice)]);
}

std::string burr_text(const BurrSettings& burr) {
  std::string text = burr.shape == BurrShape::kFile
                         ? burr.file
                         : word_of("burr", "shape", burr.shape) +
                               formatted(", %.3g mm", burr.diameter_m / kMillimetre);
  if (burr.length_m) text += formatted(", head of %.3g mm", *burr.length_m / kMillimetre);
  return text + formatted(", %.0f rpm", burr.speed_rad_per_s / kRevolutionPerMinute);
}

std::string goal_text(const GoalSettings& goal) {
  const Eigen::Vector3d size = goal.size_m / kMillimetre, at = goal.position_m / kMillimetre;
  std::string text = goal.file;
  if (goal.shape == GoalShape::kBox) {
    text = formatted("box of %.4g x %.4g x %.4g mm", size.x(), size.y(), size.z());
  } else if (goal.shape == GoalShape::kCylinder) {
    text = formatted("cylinder of %.4g mm, %.4g mm deep", goal.diameter_m / kMillimetre,
                     goal.depth_m / kMillimetre);
  }
  return text + formatted(", at (%.4g, %.4g, %.4g) mm", at.x(), at.y(), at.z());
}

std::string device_text(const DeviceSettings& device) {
  const std::string limit = formatted(", at most %.3g N", device.force_limit_N);
  if (device.plugin) return "plug-in " + device.plugin->name;
  return (device.played_back ? "that of the recording" : "simulated") + limit;
}

/// What is felt, and how it is computed.
void print_haptics(const Scene& scene) {
  const HapticsSettings& h = scene.haptics;
  say("burr             %s\n", burr_text(scene.burr).c_str());
  say("haptics          %g Hz, normals %s over %d voxels, scaling %s\n", h.rate_hz,
      word_of("haptics", "normals", h.normals).c_str(), h.neighbourhood,
      word_of("haptics", "scaling", h.scaling).c_str());
  say("device           %s\n",
      scene.device ? device_text(*scene.device).c_str() : "none: the burr follows the trajectory");
  if (scene.coupling) {
    say("coupling         %.3g N/mm, at most %.3g N\n",
        scene.coupling->stiffness_N_per_m / kNewtonPerMillimetre, scene.coupling->force_limit_N);
  } else {
    say("coupling         none\n");
  }
}

/// What it does: its way, and what is cut of what.
void print_work(const Scene& scene, const Trajectory& trajectory) {
  say("trajectory       %.3f s, %.0f ticks%s\n", trajectory.duration_s(),
      trajectory.duration_s() * scene.haptics.rate_hz,
      scene.trajectory.load_N
          ? formatted(", under a load of %.3g N", *scene.trajectory.load_N).c_str()
          : "");
  if (trajectory.clock_at_start_s() != 0.0) {
    say("                 its table begins at %g s, which is 0 s of the run\n",
        trajectory.clock_at_start_s());
  }
  say("cutting          %s\n",
      scene.cutting ? ("law " + word_of("cutting", "law", scene.cutting->law)).c_str() : "none");
  if (scene.goal) say("goal             %s\n", goal_text(*scene.goal).c_str());
  if (scene.least_pulp_distance_m) {
    say("goal             %.3g mm of tooth over the pulp\n",
        *scene.least_pulp_distance_m / kMillimetre);
  }
}

}  // namespace

void inspect_scene(const std::string& file, const std::vector<std::string>& overrides,
                   const std::string& picture_png) {
  const Scene scene = load_scene(file, overrides);
  check_files(scene);
  const WorkpieceSettings& w = scene.workpiece;
  const Trajectory trajectory = scene_trajectory(scene);
  say("scene            %s\n", scene.title.c_str());
  say("workpiece        %s\n",
      w.shape ? ("built-in " + word_of("workpiece", "shape", *w.shape)).c_str() : w.file.c_str());
  say("cells            %d x %d x %d of %g mm\n", w.cells.x(), w.cells.y(), w.cells.z(),
      w.voxel_m / kMillimetre);
  for (const TissueSettings& t : scene.tissues) {
    say("tissue           %s: %g N/mm, %g J/mm3%s%s\n", t.name.c_str(),
        t.stiffness_N_per_m / kNewtonPerMillimetre, t.specific_energy_J_per_m3 / kJoulePerMm3,
        t.file.empty() ? "" : ", ", t.file.c_str());
  }
  for (const BodySettings& body : scene.bodies) {
    say("body             %s%s\n", body.name.c_str(), body.cuttable ? ", cuttable" : "");
  }
  print_haptics(scene);
  print_work(scene, trajectory);
  say("parts            %s%s%s%s%s\n", scene.device ? "device " : "",
      scene.coupling ? "coupling " : "", scene.cutting ? "cutting " : "",
      scene.render ? "render " : "", scene.record ? "record" : "");
  if (!picture_png.empty()) show_burr(scene, picture_png);
}

}  // namespace sulcus
