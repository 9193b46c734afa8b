#include "app/report/results.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "app/report/gnuplot.hpp"
#include "app/report/log_file.hpp"
#include "app/report/summary.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/core/user_text.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {

namespace {

/// Draws force, torque and contacts over the ticks, as figs. 5 and 6 of [Kim and Park 2019], and
/// the speed of a spindle that `sags`, with gnuplot. False, and no file, where gnuplot cannot be
/// run.
bool draw_force_chart(const RunStatistics& statistics, const std::string& title, bool sags,
                      const std::string& file_png) {
  return draw_with_gnuplot(file_png, 1200, 900, [&](std::FILE* gnuplot) {
    std::fputs("$data << EOD\n", gnuplot);
    for (const ChartPoint& p : statistics.chart.points()) {
      std::fprintf(gnuplot, "%llu %g %g %u %g %g\n", static_cast<unsigned long long>(p.tick),
                   static_cast<double>(p.force_N), static_cast<double>(p.torque_mNm), p.contacts,
                   static_cast<double>(p.tick_us), static_cast<double>(p.spindle_krpm));
    }
    if (statistics.ticks == 0) std::fputs("0 0 0 0 0 0\n", gnuplot);
    std::fprintf(
        gnuplot,
        "EOD\n"
        "set multiplot layout %d,1 title %s\n"
        "set grid lc rgb '#dddddd'\nset key off\nset lmargin 9\nset yrange [0:*]\n"
        "set ylabel 'force, N'\nplot $data using 1:2 with lines lw 1 lc rgb '#1f4e9c'\n"
        "set ylabel 'torque, mN m'\nplot $data using 1:3 with lines lw 1 lc rgb '#1f4e9c'\n"
        "set ylabel 'voxels in contact'\n"
        "plot $data using 1:4 with lines lw 1 lc rgb '#555555'\n"
        "%s"
        "set ylabel 'tick, us'\nset xlabel 'tick'\n"
        "plot $data using 1:5 with lines lw 1 lc rgb '#b5651d'\n"
        "unset multiplot\n",
        sags ? 5 : 4, for_gnuplot(title).c_str(),
        sags ? "set ylabel 'speed, krpm'\n"
               "plot $data using 1:6 with lines lw 1 lc rgb '#6b4aa0'\n"
             : "");
  });
}

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

}  // namespace

std::string folder_of_scene(const std::string& file, const std::string& suffix) {
  return "out/" + std::filesystem::path(file).stem().string() + suffix;
}

std::string folder_of_recording(const std::string& file, const std::string& suffix) {
  const std::filesystem::path path = std::filesystem::absolute(file).lexically_normal();
  const std::filesystem::path folder = path.parent_path().filename();
  const bool by_folder = path.stem() == "recording" && !folder.empty();
  return "out/" + (by_folder ? folder : path.stem()).string() + suffix;
}

namespace {

void write_and_tell(ResultsFolder& folder, const Scene& scene, const SessionResult& result,
                    const SessionOptions& options, const nlohmann::ordered_json& summary) {
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
    spdlog::warn("fault {} in {} ticks", fault, ticks.dump());
  }
  if (scene.least_pulp_distance_m && result.outcome && result.outcome->progress.pulp_near_tick()) {
    spdlog::warn("{:.2f} mm of tooth are left over the pulp, and {:.2f} mm were to stay",
                 result.outcome->progress.wall_over_pulp_m().value_or(0.0) / kMillimetre,
                 *scene.least_pulp_distance_m / kMillimetre);
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
    write_and_tell(folder, simulation.scene(), result, options, summary);
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
