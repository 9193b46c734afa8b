#include "app/report/results.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "app/report/force_chart.hpp"
#include "app/report/log_file.hpp"
#include "app/report/summary.hpp"
#include "app/report/untouched.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {

namespace {

/// How a tick at real pace kept its time.
void say_lateness(const SessionResult& result) {
  const RunStatistics& s = result.statistics;
  say("  late               p99 %.1f, max %.1f us; %llu ticks missed\n", s.late_us.quantile(0.99),
      s.late_us.largest(), static_cast<unsigned long long>(result.missed_ticks));
}

/// What went, by what took it, and of a run that goes on from another all since the first tick.
void say_removed(const Scene& scene, const SessionResult& result) {
  const double voxel_mm3 = std::pow(scene.workpiece.voxel_m / kMillimetre, 3);
  const auto say_line = [&](const char* name, const OutcomeResult& outcome, EditCause cause) {
    std::uint64_t voxels = 0;
    double volume = 0.0;
    for (std::size_t t = 0; t < scene.tissues.size(); ++t) {
      voxels += outcome.progress.removed_voxels(cause, t);
      volume += outcome.progress.removed_volume(cause, t);
    }
    if (voxels == 0 && cause == EditCause::kLoose) return;
    say("  %-18s %llu voxels, %.4f mm3\n", name, static_cast<unsigned long long>(voxels),
        volume * voxel_mm3);
  };
  const OutcomeResult& own = result.part ? *result.part : *result.outcome;
  say_line("removed", own, EditCause::kCut);
  say_line("came loose", own, EditCause::kLoose);
  if (!result.part) return;
  say_line("removed in all", *result.outcome, EditCause::kCut);
  say_line("came loose in all", *result.outcome, EditCause::kLoose);
}

/// How warm the pulp's wall became.
void say_heat(const PulpHeat& pulp) {
  say("  pulp               %+.1f K at most, at %.1f s; %+.1f K at the end\n", pulp.greatest_rise_K,
      pulp.greatest_rise_s, pulp.end_change_K());
  if (pulp.over_limit_s > 0.0) {
    spdlog::warn("the pulp's wall was more than {} K warmer than at the start for {:.2f} s",
                 kPulpLimit_K, pulp.over_limit_s);
  }
}

/// Of a fault that a scene's simulated device is to have: which key says so.
std::string asked_for(const Scene& scene, std::string_view fault) {
  if (!scene.device) return {};
  const bool silence = fault == "device_silent" || fault == "pose_bridged";
  if (silence && !scene.device->silences.empty()) return ", as device.silent_s asks";
  if (fault == "device_jumped" && !scene.device->jumps.empty()) return ", as device.jump_s_mm asks";
  return {};
}

}  // namespace

namespace {

/// In out/, where a stem that is only dots would be another folder.
std::string folder_in_out(const std::filesystem::path& stem, const char* otherwise,
                          const std::string& suffix) {
  const bool is_place = stem.empty() || stem == "." || stem == "..";
  return "out/" + (is_place ? otherwise : stem.string()) + suffix;
}

}  // namespace

std::string folder_of_scene(const std::string& file, const std::string& suffix) {
  return folder_in_out(std::filesystem::path(file).stem(), "scene", suffix);
}

std::string folder_of_recording(const std::string& file, const std::string& suffix) {
  const std::filesystem::path path = std::filesystem::absolute(file).lexically_normal();
  const std::filesystem::path folder = path.parent_path().filename();
  const bool by_folder = path.stem() == "recording" && !folder.empty();
  return folder_in_out(by_folder ? folder : path.stem(), "recording", suffix);
}

namespace {

void write_and_tell(ResultsFolder& folder, const Simulation& simulation,
                    const SessionResult& result, const SessionOptions& options,
                    const nlohmann::ordered_json& summary) {
  const Scene& scene = simulation.scene();
  const RunStatistics& s = result.statistics;
  std::vector<std::string> files{options.folder + "/summary.json"};
  write_whole_file(files.back(), result.summary);
  const std::string chart = options.folder + "/forces.png";
  if (draw_force_chart(s, scene.title, scene.spindle.has_value(), chart)) {
    files.push_back(chart);
  } else {
    spdlog::warn("forces.png was not drawn: gnuplot could not be run");
  }
  files.insert(files.end(), result.files.begin(), result.files.end());
  files.push_back(options.folder + "/log.txt");
  folder.finish(!result.interrupted && !result.failure);

  for (const std::string& refused : result.refused) spdlog::warn("not granted: {}", refused);
  for (const auto& [fault, ticks] : summary["faults"].items()) {
    spdlog::warn("{}: fault {} in {} ticks{}", scene.title, fault, ticks.dump(),
                 asked_for(scene, fault));
  }
  if (scene.least_pulp_distance_m && result.outcome && result.outcome->progress.pulp_near_tick()) {
    spdlog::warn("{:.2f} mm of tooth are left over the pulp, and {:.2f} mm were to stay",
                 result.outcome->progress.wall_over_pulp_m().value_or(0.0) / kMillimetre,
                 *scene.least_pulp_distance_m / kMillimetre);
  }
  if (!result.interrupted) {  // who stops a run knows that it is not all of it
    if (const std::string text = say_untouched(simulation, s); !text.empty()) {
      spdlog::warn("{}", text);
    }
  }
  if (result.interrupted) spdlog::warn("stopped on request after {} ticks", s.ticks);

  const auto& contacts = summary["voxels_in_contact"];
  say("%s: %llu ticks in %.1f s\n", scene.title.c_str(), static_cast<unsigned long long>(s.ticks),
      result.wall_seconds);
  say("  voxels in contact  mean %.1f, max %u\n", contacts["mean"].get<double>(),
      contacts["max"].get<unsigned>());
  say("  force              mean %.3f, max %.3f N\n", s.force_N.mean(),
      static_cast<double>(summary["force_N"]["max"]));
  say("  tick               mean %.1f, p99 %.1f us\n", s.tick_us.mean(), s.tick_us.quantile(0.99));
  if (options.pace == Pace::kReal) say_lateness(result);
  if (result.outcome) say_removed(scene, result);
  if (result.heat && result.heat->pulp) say_heat(*result.heat->pulp);
  if (const auto& sent = result.stream) {
    say("  stream             %llu clients, %llu samples, %llu of them dropped\n",
        static_cast<unsigned long long>(sent->clients),
        static_cast<unsigned long long>(sent->samples),
        static_cast<unsigned long long>(sent->dropped));
  }
  if (result.frames > 0) {
    say("  pictures           %llu\n", static_cast<unsigned long long>(result.frames));
  }
  for (const std::string& file : files) {
    say("%s\n", (folder.path() + file.substr(options.folder.size())).c_str());
  }
}

}  // namespace

void run_into(ResultsFolder& folder, Simulation& simulation, Device& device,
              SessionOptions& options, const std::vector<PartUse>& loading) {
  options.folder = folder.at();
  nlohmann::ordered_json summary;
  options.summarise = [&](const SessionResult& result) {
    summary = make_summary(simulation, result, options, loading);
    return summary.dump(2) + "\n";
  };
  const SessionResult result = run_session(simulation, device, options);
  options.summarise = nullptr;  // it refers into this call
  try {
    write_and_tell(folder, simulation, result, options, summary);
    check_log();
  } catch (const std::exception&) {
    if (!result.failure) throw;
  }
  if (!result.failure) return;
  try {
    std::rethrow_exception(result.failure);  // the first of all
  } catch (const InputError& why) {          // of no input: the run is over
    throw std::runtime_error(why.what());
  }
}

}  // namespace sulcus
