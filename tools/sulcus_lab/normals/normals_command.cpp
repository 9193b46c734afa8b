#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "engine/normals/ldm.hpp"
#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/normals/error_tiles.hpp"
#include "tools/sulcus_lab/normals/normals_measurement.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/truth/truth_file.hpp"

namespace sulcus::lab {

namespace {

/// The neighbourhood that the paper settles on: of it a table is printed, and charts mark it.
constexpr int kMarkedNeighbourhood = 6;

/// What was measured on one shape.
struct ShapeResult {
  std::string shape;
  std::vector<NormalsRow> rows;
};

struct NormalsOptions {
  std::string shape, volume, truth, folder = "out/lab/normals";
  std::string fills;
  SurfaceKind surface = SurfaceKind::kBinary;
  std::vector<int> neighbourhoods;
  std::vector<std::string> methods;
};

/// Every method at every neighbourhood that was asked for, or at its usual ones.
std::vector<MethodRun> runs_of(const NormalsOptions& options) {
  std::vector<Method> methods;
  for (const std::string& name : options.methods) {
    const Method method = method_named(name);
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) {
      methods.push_back(method);
    }
  }
  const bool named = !methods.empty();
  for (const MethodInfo& info : all_methods()) {
    if (!named && is_available(info.method)) methods.push_back(info.method);
  }
  std::vector<int> asked = options.neighbourhoods;
  std::sort(asked.begin(), asked.end());
  asked.erase(std::unique(asked.begin(), asked.end()), asked.end());

  std::vector<MethodRun> runs;
  for (const Method method : methods) {
    const MethodInfo& info = info_of(method);
    for (const int ns : asked.empty() ? usual_neighbourhoods(method) : asked) {
      if (ns <= info.largest_ns) {
        runs.push_back({method, ns});
      } else if (named) {
        throw InputError(
            "", "--ns", std::to_string(ns),
            "at most " + std::to_string(info.largest_ns) + " for " + std::string(info.name));
      }
    }
  }
  return runs;
}

/// With one shape zones are named as they are, with several after their shape.
std::string zone_label(const std::string& shape, const std::string& zone, bool several) {
  if (!several) return zone;
  return zone == "all" ? shape : shape + "/" + zone;
}

/// What both tables begin a row with.
std::string key_of(const ShapeResult& result, const NormalsRow& row, bool several) {
  return std::string(info_of(row.method).name) + "," + std::to_string(row.neighbourhood) + "," +
         zone_label(result.shape, row.zone, several) + "," + std::to_string(row.voxels) + ",";
}

std::string csv_line(const ShapeResult& result, const NormalsRow& row, bool several) {
  return key_of(result, row, several) + number_cell("%.4f", row.mean_deg) + "," +
         number_cell("%.4f", row.p95_deg) + "," + number_cell("%.3f", row.max_deg) + "," +
         std::to_string(row.undefined) + "," + number_cell("%.1f", row.ns_per_normal) + "," +
         number_cell("%.3f", row.ratio_to_ldm);
}

std::string tool_csv_line(const ShapeResult& result, const NormalsRow& row, bool several) {
  return key_of(result, row, several) + number_cell("%.3f", *row.max_with_tool_deg);
}

/// Mean errors and times at the marked neighbourhood, or the largest measured below it.
void print_table(const ShapeResult& result, bool several) {
  int ns = 0;
  for (const NormalsRow& row : result.rows) {
    if (row.neighbourhood <= kMarkedNeighbourhood) ns = std::max(ns, row.neighbourhood);
  }
  if (ns == 0) return;
  std::printf("%-26s %-16s %9s %9s %9s %9s %10s\n", several ? "" : result.shape.c_str(),
              ("NS = " + std::to_string(ns)).c_str(), "mean deg", "p95", "max", "undefined", "ns");
  std::string last;
  for (const MethodInfo& info : all_methods()) {
    for (const NormalsRow& row : result.rows) {
      if (row.method != info.method || row.neighbourhood != ns) continue;
      std::printf("%-26s %-16s %9.3f %9.2f %9.2f %9zu %10.1f\n",
                  zone_label(result.shape, row.zone, several).c_str(),
                  std::string(info.name).c_str(), row.mean_deg, row.p95_deg, row.max_deg,
                  row.undefined, row.ns_per_normal);
    }
  }
  std::printf("\n");
  std::fflush(stdout);
}

bool is_pictured(const std::string& shape) {
  return shape == "sphere" || shape == "cube" || shape == "rotated_cube";
}

/// The one of that name, else the first.
const ShapeResult& preferred(const std::vector<ShapeResult>& results, const std::string& shape) {
  const auto at = std::find_if(results.begin(), results.end(),
                               [&](const ShapeResult& r) { return r.shape == shape; });
  return at == results.end() ? results.front() : *at;
}

void print_growth(const std::string& shape, const std::vector<CostRow>& costs) {
  bool any = false;
  for (const MethodInfo& info : all_methods()) {
    const CostGrowth growth = growth_of(info.method, costs);
    if (!std::isfinite(growth.time)) continue;
    if (!any) std::printf("Growth with n = 2 NS + 1 on the %s: time, places read\n", shape.c_str());
    any = true;
    std::printf("  %-16s n^%.2f  n^%.2f\n", std::string(info.name).c_str(), growth.time,
                growth.readouts);
  }
  if (any) std::printf("\n");
}

void write_cost(const ShapeResult& result, Results& outputs) {
  const std::vector<CostRow> costs = costs_of(result.rows);
  CsvFile csv(outputs.table("cost.csv"), "method,ns,readouts,ns_per_normal");
  for (const CostRow& cost : costs) {
    csv.write(std::string(info_of(cost.method).name) + "," + std::to_string(cost.neighbourhood) +
              "," + number_cell("%.0f", cost.readouts) + "," +
              number_cell("%.1f", cost.ns_per_normal));
  }
  print_growth(result.shape, costs);
}

std::string panel_title(const std::string& shape, const std::string& zone) {
  if (zone == "all") return spaced_name(shape);
  if (zone == "near") return spaced_name(shape) + ", 2 to 10 voxels from an edge";
  if (zone == "edge") return spaced_name(shape) + ", under 2 voxels from an edge";
  if (zone.starts_with(shape + "_")) {
    return spaced_name(shape) + ", " + zone.substr(shape.size() + 1) +
           (zone.ends_with("_1") ? " voxel thick" : " voxels thick");
  }
  return spaced_name(shape) + ", " + spaced_name(zone);
}

/// The zones of a shape that the chart of all has a panel for: each, or the whole where there are
/// none.
std::vector<std::string> panels_of(const ShapeResult& result) {
  std::vector<std::string> zones;
  for (const NormalsRow& row : result.rows) {
    if (row.zone != "all" && std::ranges::find(zones, row.zone) == zones.end()) {
      zones.push_back(row.zone);
    }
  }
  // Upright faces are no test: every method is exact on them.
  if (zones.empty() || result.shape == "cube") zones = {"all"};
  return zones;
}

/// The charts, with what each draws: normals_charts.csv, by the zones of normals.csv.
void draw_charts(const std::vector<ShapeResult>& results, Results& outputs) {
  const bool several = results.size() > 1;
  CsvFile csv(outputs.table("normals_charts.csv"), "chart,zone,title");
  const auto add = [&](const char* chart, const ShapeResult& result, const std::string& zone) {
    csv.write(std::string(chart) + "," + zone_label(result.shape, zone, several) + "," +
              text_cell(panel_title(result.shape, zone)));
  };
  for (const ShapeResult& result : results) {
    for (const std::string& zone : panels_of(result)) add("normals", result, zone);
  }
  add("speed_accuracy", preferred(results, "molar"), "all");
  add("cost", preferred(results, "sphere"), "all");
  for (const char* chart : {"normals", "speed_accuracy", "cost"}) outputs.draw(chart, chart);
}

void normals(const NormalsOptions& options) {
  const std::vector<MethodRun> runs = runs_of(options);
  std::vector<TruthShape> from_file;  // all input is read before anything is written
  std::vector<std::string> names;
  if (!options.volume.empty()) {
    from_file.push_back(read_truth_file(options.truth,
                                        model_of_mask(read_medical_volume(options.volume)),
                                        std::filesystem::path(options.volume).stem().string()));
    if (!options.fills.empty()) {
      from_file.back().model =
          model_of_fills(read_medical_volume(options.fills), from_file.back().model);
    }
    names.push_back(from_file.front().name);
  } else if (!options.shape.empty()) {
    names.push_back(options.shape);
  } else {
    names.assign(std::begin(kShapeNames), std::end(kShapeNames));
  }

  Results outputs(options.folder);
  CsvFile csv(outputs.table("normals.csv"),
              "method,ns,zone,voxels,mae_deg,p95_deg,max_deg,undefined,ns_per_normal,ratio_to_ldm");
  CsvFile tool_csv(outputs.table("normals_tool.csv"), "method,ns,zone,voxels,max_deg");
  const ProgressLine progress;
  const bool several = names.size() > 1;
  std::vector<ShapeResult> results;
  for (const std::string& name : names) {
    progress.say(name + ": shape");
    const std::vector<TruthShape> parts =
        from_file.empty() ? truth_shapes(name, options.surface) : from_file;
    results.push_back(
        {name, measure_normals(parts, runs, [&](const std::string& what) { progress.say(what); })});
    for (const NormalsRow& row : results.back().rows) {
      csv.write(csv_line(results.back(), row, several));
      if (row.max_with_tool_deg) tool_csv.write(tool_csv_line(results.back(), row, several));
    }
    if (from_file.empty() && is_pictured(name)) {
      progress.say(name + ": picture");
      const std::string tiles = "errors_" + name;
      if (write_error_tiles(parts.front(), runs, outputs.path(tiles + ".csv"))) {
        outputs.table(tiles + ".csv");
        outputs.draw("errors", tiles, name);
      }
    }
    progress.clear();
    print_table(results.back(), several);
  }
  write_cost(preferred(results, "sphere"), outputs);
  draw_charts(results, outputs);
  outputs.print();
}

}  // namespace

void add_normals_command(CLI::App& program) {
  auto options = std::make_shared<NormalsOptions>();
  CLI::App* command = program.add_subcommand(
      "normals", "Errors and times of the normal methods where the normals are known, with charts");
  std::vector<std::string> shapes(std::begin(kShapeNames), std::end(kShapeNames));
  CLI::Option* shape =
      command->add_option("--shape", options->shape, "One shape with known normals (all of them)")
          ->check(CLI::IsMember(shapes));
  CLI::Option* volume = command->add_option(
      "--volume", options->volume, "Volume of your own, solid where above 0; with --truth");
  CLI::Option* truth = command->add_option(
      "--truth", options->truth, "Its normals: i,j,k,nx,ny,nz,zone, outward, unit, in index space");
  volume->needs(truth)->excludes(shape);
  truth->needs(volume);
  command
      ->add_option("--fills", options->fills,
                   "Its fill levels, 0 to 255, a volume of the same size: fractions")
      ->needs(volume);
  command
      ->add_option_function<std::string>(
          "--surface",
          [options](const std::string& name) {
            options->surface =
                name == kSurfaceNames[1] ? SurfaceKind::kFractions : SurfaceKind::kBinary;
          },
          "What voxels say of a shape: binary, their centres; fractions, how much is filled")
      ->check(CLI::IsMember(std::vector<std::string>(kSurfaceNames.begin(), kSurfaceNames.end())))
      ->excludes(volume);
  command
      ->add_option("--ns", options->neighbourhoods,
                   "Neighbourhoods, 1,2,.. (1 to 6, 8 and 12 where a method is not too slow)")
      ->delimiter(',')
      ->check(CLI::Range(1, kMaxNeighbourhood));
  std::string methods = "Methods, by name:";
  for (const MethodInfo& info : all_methods()) {
    if (is_available(info.method)) methods.append(" ").append(info.name);
  }
  command->add_option("--method", options->methods, methods + " (all)")->delimiter(',');
  command->add_option("-o", options->folder, "Folder for the results (out/lab/normals)");
  command->footer(
      "Writes into the folder:\n"
      "  normals.csv         errors in degrees and nanoseconds per normal, by method, NS and zone\n"
      "  normals_tool.csv    largest error of the ldm methods where the tool hint is given\n"
      "  normals_charts.csv  chart,zone,title: what the next three charts draw\n"
      "  normals.png         error against time, a panel for each shape or zone\n"
      "  speed_accuracy.png  the same of one shape: the molar, or the only one\n"
      "  cost.csv, cost.png  places read and time against 2 NS + 1: the sphere, or the only shape\n"
      "  errors_SHAPE.csv    x,y,METHOD_NS..: degrees at each pixel of a tile\n"
      "  errors_SHAPE.png    the error in colour, of the sphere and the cubes\n"
      "Times are thread CPU time, best of three. Slow methods are measured on a part of the "
      "voxels.\n"
      "Zones near and edge: 2 to 10 voxels and under 2 voxels from an edge. With several shapes a\n"
      "zone is written SHAPE/ZONE, and SHAPE for all of it; with one, all.");
  command->callback([options] { normals(*options); });
}

}  // namespace sulcus::lab
