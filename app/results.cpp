#include "app/results.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "app/build_info.hpp"
#include "app/force_chart.hpp"
#include "app/log_file.hpp"
#include "app/output_file.hpp"
#include "app/summary.hpp"
#include "app/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {

std::string default_folder(const std::string& file, const std::string& suffix) {
  return "out/" + std::filesystem::path(file).stem().string() + suffix;
}

void open_log(const std::string& folder) {
  make_output_folder("-o", folder);
  auto file = std::make_shared<LogFile>(folder + "/log.txt");
  file->set_formatter(one_line_formatter("[%Y-%m-%d %H:%M:%S.%e] [%l] %*"));
  auto terminal = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  terminal->set_level(spdlog::level::warn);
  terminal->set_formatter(one_line_formatter("sulcus: %*"));
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("sulcus", spdlog::sinks_init_list{file, terminal}));
  spdlog::info("{}", build_info());
}

namespace {

/// Whether log.txt has all that was told to it.
void check_log() {
  for (const auto& sink : spdlog::default_logger()->sinks()) {
    if (const auto file = std::dynamic_pointer_cast<LogFile>(sink)) file->check();
  }
}

void write_and_tell(const Simulation& simulation, const SessionResult& result,
                    const SessionOptions& options, const std::vector<PartUse>& loading) {
  const Scene& scene = simulation.scene();
  const RunStatistics& s = result.statistics;
  const nlohmann::ordered_json summary = make_summary(simulation, result, options.pace, loading);
  std::vector<std::string> files{options.folder + "/summary.json"};
  write_whole_file(files.back(), summary.dump(2) + "\n");
  const std::string chart = options.folder + "/forces.png";
  if (draw_force_chart(s, scene.title, chart)) {
    files.push_back(chart);
  } else {
    spdlog::warn("forces.png was not drawn: gnuplot could not be run");
  }
  files.insert(files.end(), result.files.begin(), result.files.end());
  files.push_back(options.folder + "/log.txt");

  for (const std::string& refused : result.refused) spdlog::warn("not granted: {}", refused);
  for (const auto& [fault, ticks] : summary["faults"].items()) {
    spdlog::warn("fault {} in {} ticks", fault, ticks.dump());
  }
  if (result.interrupted) spdlog::warn("stopped on request after {} ticks", s.ticks);

  const auto& contacts = summary["voxels_in_contact"];
  const double voxel_mm = scene.workpiece.voxel_m / kMillimetre;
  say("%s: %llu ticks in %.1f s\n", scene.title.c_str(), static_cast<unsigned long long>(s.ticks),
      result.wall_seconds);
  say("  voxels in contact  mean %.1f, max %u\n", contacts["mean"].get<double>(),
      contacts["max"].get<unsigned>());
  say("  force              mean %.3f, max %.3f N\n", s.force_N.mean(),
      static_cast<double>(summary["force_N"]["max"]));
  say("  tick               mean %.1f, p99 %.1f us\n", s.tick_us.mean(), s.tick_us.quantile(0.99));
  if (scene.cutting) {
    say("  removed            %llu voxels, %.4f mm3\n", static_cast<unsigned long long>(s.removed),
        static_cast<double>(s.removed) * std::pow(voxel_mm, 3));
  }
  if (result.frames > 0) {
    say("  pictures           %llu\n", static_cast<unsigned long long>(result.frames));
  }
  for (const std::string& file : files) say("%s\n", file.c_str());
}

}  // namespace

void write_results(const Simulation& simulation, const SessionResult& result,
                   const SessionOptions& options, const std::vector<PartUse>& loading) {
  try {
    write_and_tell(simulation, result, options, loading);
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
