#include "tools/sulcus_lab/program/program_trials.hpp"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "app/terminal/child_process.hpp"
#include "engine/core/realtime.hpp"

namespace sulcus::lab {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kCutSulcus = SULCUS_SCENES "/cut_sulcus.toml";
constexpr std::array kOneTick{"--duration", "0.001"};

double children_cpu_s() {
  rusage use{};
  ::getrusage(RUSAGE_CHILDREN, &use);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(use.ru_utime) + seconds(use.ru_stime);
}

struct Spent {
  double wall_s, cpu_s;
};

Spent run(const std::vector<std::string>& arguments) {
  const std::uint64_t begin_ns = steady_ns();
  const double begin_cpu_s = children_cpu_s();
  if (ChildProcess(arguments, {}).wait() != 0) {
    std::string command;
    for (const std::string& argument : arguments) command += argument + ' ';
    throw std::runtime_error(command + "failed");
  }
  return {seconds_since(begin_ns), children_cpu_s() - begin_cpu_s};
}

/// Runs a scene into a folder of the scratch; returns its summary, and what it spent.
Json run_scene(const ProgramBuild& build, const std::string& scene, const std::string& folder,
               const std::vector<std::string>& options, Spent* spent = nullptr) {
  const std::string out = build.scratch + "/" + folder;
  std::vector<std::string> words{build.folder + "/sulcus", "run", scene, "-o", out, "--force"};
  words.insert(words.end(), options.begin(), options.end());
  const Spent all = run(words);
  if (spent) *spent = all;
  return Json::parse(std::ifstream(out + "/summary.json"));
}

/// From here on runs keep what they load in an empty folder.
void empty_cache(const ProgramBuild& build) {
  const std::string cache = build.scratch + "/cache";
  fs::remove_all(cache);
  ::setenv("SULCUS_CACHE", cache.c_str(), 1);
}

double part_s(const Json& summary, const std::string& name) {
  for (const Json& part : summary.at("parts")) {
    if (part.at("name") == name) return part.at("time_s");
  }
  throw std::runtime_error("summary.json: no part " + name);
}

double parts_MiB(const Json& summary) {
  double sum = 0.0;
  for (const Json& part : summary.at("parts")) sum += part.at("memory_MiB").get<double>();
  return sum;
}

double ticks_s(const Json& summary) {
  return 1e-6 * summary.at("tick_us").at("mean").get<double>() * summary.at("ticks").get<double>();
}

/// Without pictures and with those that the scene asks for. CPU is that of the whole process, which
/// other work on the machine changes less.
ProgramFigures start(const ProgramBuild& build) {
  ProgramFigures figures;
  for (const std::string drawn : {"", "drawn_"}) {
    empty_cache(build);
    for (const std::string cache : {"cold", "cached"}) {
      std::vector<std::string> options(kOneTick.begin(), kOneTick.end());
      if (drawn.empty()) options.emplace_back("--no-render");
      Spent spent{};
      const Json summary = run_scene(build, kCutSulcus, "start", options, &spent);
      figures.emplace_back(drawn + cache + "_s", summary.at("load_s"));
      figures.emplace_back(drawn + cache + "_cpu_s", spent.cpu_s);
    }
  }
  return figures;
}

ProgramFigures memory(const ProgramBuild& build) {
  ProgramFigures figures;
  for (const std::string drawn : {"", "drawn_"}) {
    std::vector<std::string> options;
    if (drawn.empty()) options.emplace_back("--no-render");
    const Json summary = run_scene(build, kCutSulcus, "memory", options);
    figures.emplace_back(drawn + "parts_MiB", parts_MiB(summary));
    figures.emplace_back(drawn + "peak_MiB", summary.at("memory_MiB").at("peak_rss"));
  }
  return figures;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream row(line);
  for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
  return cells;
}

/// Those after the header.
std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream table(csv);
  std::string line;
  for (std::getline(table, line); std::getline(table, line);) rows.push_back(cells_of(line));
  return rows;
}

/// Camera at rest and turning while the haptic thread probes, then while it cuts.
ProgramFigures frames(const ProgramBuild& build) {
  ProgramFigures figures;
  for (const char* scene : {"probe", "cut"}) {
    const std::string out = build.scratch + "/frames_" + scene;
    run({build.folder + "/sulcus-lab", "frames", "--scene",
         SULCUS_SCENES "/" + std::string(scene) + "_sulcus.toml", "--size", "640x480", "--seconds",
         "4", "-o", out});
    for (const std::vector<std::string>& cells : rows_of(out + "/frames.csv")) {
      if (cells.at(0) == "none") continue;
      const std::string name = std::string(scene) + '_' + cells[0];
      figures.emplace_back(name + "_per_s", std::stod(cells.at(1)));
      figures.emplace_back(name + "_tick_p99_to_undrawn", std::stod(cells.at(8)));
    }
  }
  return figures;
}

/// The mean tick of both methods at three numbers of contacts.
ProgramFigures ticks(const ProgramBuild& build) {
  const std::string out = build.scratch + "/ticks";
  run({build.folder + "/sulcus-lab", "ticks", "--measure", "contacts", "--contacts",
       "350,1200,10000", "-o", out});
  ProgramFigures figures;
  for (const std::vector<std::string>& cells : rows_of(out + "/ticks.csv")) {
    const std::string name = cells.at(0) + '_' + cells.at(1) + '_' + cells.at(2);
    figures.emplace_back(name + "_us", std::stod(cells.at(3)));
  }
  return figures;
}

/// One tooth in as many cells as there may be: 17.8 mm, as cut_sulcus has.
ProgramFigures tooth(const ProgramBuild& build) {
  std::vector<std::string> options{"--set",     "workpiece.cells=[1024, 1024, 1024]",
                                   "--set",     "workpiece.voxel_mm=0.0174",
                                   kOneTick[0], kOneTick[1]};
  empty_cache(build);
  const auto drawn = run_scene(build, kCutSulcus, "tooth", options);
  options.push_back("--no-render");
  empty_cache(build);
  const auto undrawn = run_scene(build, kCutSulcus, "tooth", options);
  fs::remove_all(build.scratch + "/cache");
  return {{"load_s", drawn.at("load_s")},
          {"peak_MiB", undrawn.at("memory_MiB").at("peak_rss")},
          {"drawn_peak_MiB", drawn.at("memory_MiB").at("peak_rss")},
          {"first_frame_s", part_s(drawn, "render")}};
}

/// The cut of cut_sulcus alone, and in a row of 16 teeth: the mean tick.
ProgramFigures jaw(const ProgramBuild& build) {
  constexpr int kOthers = 15;
  constexpr double kApart_mm = 12.0;  // a molar is 11.6 wide
  const std::string scene = build.scratch + "/jaw.toml";
  std::ostringstream text;
  text << std::ifstream(kCutSulcus).rdbuf();
  for (int i = 1; i <= kOthers; ++i) {
    const int place = (i + 1) / 2;  // to the left and the right in turn
    const double x_mm = (i % 2 == 0 ? place : -place) * kApart_mm;
    text << "\n[[body]]\nname = \"tooth " << i << "\"\nshape = \"molar\"\nvoxel_mm = 0.07\n"
         << "cells = [256, 256, 256]\nposition_mm = [" << x_mm << ", 0, 0]\n";
  }
  std::ofstream(scene) << text.str();
  ::setenv("SULCUS_CACHE", (build.scratch + "/cache").c_str(), 1);
  const auto tick_us = [&](const std::string& file) {
    return run_scene(build, file, "jaw", {"--no-render"}).at("tick_us").at("mean").get<double>();
  };
  const double one_us = tick_us(kCutSulcus), all_us = tick_us(scene);
  return {{"one_us", one_us}, {"16_bodies_us", all_us}, {"ratio", all_us / one_us}};
}

/// What verifying takes beyond opening a recording, of one tick, against the ticks: CPU, of one
/// thread but for loading.
ProgramFigures verify(const ProgramBuild& build) {
  const Json summary = run_scene(build, kCutSulcus, "verify", {"--no-render"});
  run_scene(build, kCutSulcus, "one_tick", {"--no-render", kOneTick[0], kOneTick[1]});
  const auto verified = [&](const std::string& folder) {
    return run({build.folder + "/sulcus", "replay", build.scratch + "/" + folder + "/recording.h5",
                "--verify"});
  };
  const Spent opened = verified("one_tick"), all = verified("verify");
  return {{"ticks_s", ticks_s(summary)},
          {"wall_s", all.wall_s},
          {"open_cpu_s", opened.cpu_s},
          {"ratio", (all.cpu_s - opened.cpu_s) / ticks_s(summary)}};
}

ProgramFigures export_mesh(const ProgramBuild& build) {
  const std::string recording = build.scratch + "/export/recording.h5";
  if (!fs::exists(recording)) run_scene(build, kCutSulcus, "export", {"--no-render"});
  ProgramFigures figures;
  for (const std::string kind : {"stl", "obj", "ply"}) {
    const Spent spent = run({build.folder + "/sulcus", "export", recording, "--mesh",
                             build.scratch + "/tooth." + kind});
    figures.emplace_back(kind + "_s", spent.wall_s);
    figures.emplace_back(kind + "_cpu_s", spent.cpu_s);
  }
  return figures;
}

std::string source_of(const std::string& build_folder) {
  std::ifstream cache(build_folder + "/CMakeCache.txt");
  const std::string key = "CMAKE_HOME_DIRECTORY:INTERNAL=";
  for (std::string line; std::getline(cache, line);) {
    if (line.starts_with(key)) return line.substr(key.size());
  }
  throw std::runtime_error(build_folder + ": no build folder of CMake");
}

/// What tools/run builds, in an empty folder and without ccache.
ProgramFigures build_from_nothing(const ProgramBuild& build) {
  const std::string folder = build.scratch + "/build";
  fs::remove_all(folder);
  ::setenv("CCACHE_DISABLE", "1", 1);
  const Spent configured = run({"cmake", "-S", source_of(build.folder), "-B", folder, "-G", "Ninja",
                                "-D", "CMAKE_BUILD_TYPE=Release"});
  const Spent built = run({"cmake", "--build", folder, "--target", "sulcus"});
  fs::remove_all(folder);
  return {{"configure_cpu_s", configured.cpu_s},
          {"build_cpu_s", built.cpu_s},
          {"wall_s", configured.wall_s + built.wall_s}};
}

}  // namespace

const std::vector<ProgramTrial>& program_trials() {
  static const std::vector<ProgramTrial> trials{
      {"start", "from the start of the process to the first tick of cut_sulcus", start},
      {"memory", "of all of cut_sulcus", memory},
      {"frames", "pictures beside ticks at real pace", frames},
      {"tooth", "a tooth of 1024^3 cells", tooth},
      {"jaw", "the mean tick of cut_sulcus among 15 other teeth", jaw},
      {"verify", "replay --verify against the ticks it computes again", verify},
      {"export", "export --mesh at 512^3", export_mesh},
      {"ticks", "the mean tick at 350, 1,200 and 10,000 contacts", ticks, true},
      {"build", "what tools/run builds, from nothing", build_from_nothing, true},
  };
  return trials;
}

}  // namespace sulcus::lab
