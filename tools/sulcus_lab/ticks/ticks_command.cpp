#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/realtime.hpp"
#include "engine/shapes/build_shape.hpp"
#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/normals/normal_methods.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/ticks/ticks_rows.hpp"
#include "tools/sulcus_lab/ticks/ticks_run.hpp"

namespace sulcus::lab {

namespace {

/// By contacts, by the cells of a grid, by bodies.
const std::vector<std::string> kTickMeasurements{"contacts", "cells", "bodies"};

struct TicksOptions {
  std::string folder = "out/lab/ticks";
  std::vector<int> contacts;
  std::vector<std::string> methods{"ldm_fast", "ldm"};
  std::vector<std::string> measured = kTickMeasurements;
  bool quick = false;

  bool measures(const std::string& name) const {
    return std::ranges::find(measured, name) != measured.end();
  }
};

/// What is measured, in full or quickly: coarse voxels, small grids and few ticks.
struct Measured {
  TicksPlan plan;
  int cells;       // of the molar, along an axis
  double voxel_m;  // 17.8 mm hold the crown
  std::vector<int> grids, grid_contacts;
  std::vector<int> bodies{1, 2, 4, 8, 16};
  int body_contacts;
  /// More contacts than the largest ball finds at 512^3, whose walls then turn away from it, are
  /// measured on the same tooth in twice as fine voxels.
  int most_at_coarse = 40000;
};

Measured measured_by(const TicksOptions& options) {
  Measured measured = options.quick
                          ? Measured{{{100, 350}, {}, 60, 60}, 128, 139.2e-6, {64, 128}, {350},
                                     {1, 2, 4, 8, 16},         350}
                          : Measured{{{100, 350, 1200, 4000, 10000, 30000, 100000}, {}},
                                     512,
                                     34.8e-6,
                                     {128, 256, 512, 1024},
                                     {350, 1200},
                                     {1, 2, 4, 8, 16},
                                     350};
  if (options.quick) measured.most_at_coarse = std::numeric_limits<int>::max();
  if (!options.contacts.empty()) {
    measured.plan.contacts = options.contacts;
    std::sort(measured.plan.contacts.begin(), measured.plan.contacts.end());
    const auto last = std::unique(measured.plan.contacts.begin(), measured.plan.contacts.end());
    measured.plan.contacts.erase(last, measured.plan.contacts.end());
  }
  for (const std::string& name : options.methods) {
    const auto at = std::find(kNormalMethodNames.begin(), kNormalMethodNames.end(), name);
    if (at == kNormalMethodNames.end()) {
      std::string all;
      for (const std::string_view known : kNormalMethodNames) {
        all.append(all.empty() ? "" : ", ").append(known);
      }
      throw InputError("", "--method", "'" + name + "'", "a method of a tick: " + all);
    }
    const auto method = static_cast<NormalMethod>(at - kNormalMethodNames.begin());
    if (std::find(measured.plan.methods.begin(), measured.plan.methods.end(), method) ==
        measured.plan.methods.end()) {
      measured.plan.methods.push_back(method);
    }
  }
  return measured;
}

/// Along the central sulcus where the scenes probe and cut: fissures and cusps, not a smooth wall.
const TickGround kSulcus{{0.8e-3, -0.28e-3}, {1.2e-3, -0.31e-3}, 8.5e-3};

Workpiece molar(int cells, double voxel_m) {
  Scene scene;
  scene.workpiece.shape = ShapeKind::kMolar;
  scene.workpiece.cells = Eigen::Vector3i::Constant(cells);
  scene.workpiece.voxel_m = voxel_m;
  scene.tissues = tick_tissues(1.0);
  return Workpiece(build_shape(scene));
}

/// What is cut, and PCL's normals of it where there are any.
struct Tooth {
  Tooth(int cells, double voxel_m) : workpiece(molar(cells, voxel_m)) {
    if (is_available(Method::kPca)) pca.emplace(workpiece, true, std::nullopt);
  }

  Workpiece workpiece;
  std::optional<NormalMethods> pca;
};

/// All that was measured.
struct Tables {
  explicit Tables(Results& results)
      : ticks(results.table("ticks.csv"), kTicksHeader),
        found(results.table("ticks_found.csv"), kFoundHeader),
        stages(results.table("ticks_stages.csv"), kStagesHeader),
        floor(results.table("ticks_floor.csv"), kFloorHeader) {}

  CsvFile ticks, found, stages, floor;
  std::vector<TickRow> rows;

  void add(const TicksGroup& group) {
    const Workpiece& workpiece = group.runs.front().task.start;
    const std::vector<TickRow> added = rows_of(group);
    for (const TickRow& row : added) {
      ticks.write(ticks_line(row));
      found.write(found_line(row));
      for (const std::string& line : stage_lines(row)) stages.write(line);
    }
    const TickPath& path = group.path;
    const TickPlace place{group.wanted,
                          workpiece.grid().cells.x(),
                          path.diameter_m,
                          path.depth_m,
                          group.cutting.front().specific_energy_J_per_m3,
                          path.contacts,
                          path.least,
                          path.most,
                          group.pca_ns.value_or(std::numeric_limits<double>::quiet_NaN()),
                          tick_floor(workpiece, path, group.wanted, true),
                          tick_floor(workpiece, path, group.wanted, false)};
    for (const std::string& line : floor_lines(place)) floor.write(line);
    rows.insert(rows.end(), added.begin(), added.end());
    print_place(place);
    print_rows(added);
  }
};

/// Of the tooth: all contacts, methods and caches.
std::vector<TickRow> measure_contacts(const Measured& measured, Results& results,
                                      const std::function<void(const std::string&)>& progress) {
  Tables tables(results);
  // All teeth at once, so that few and many contacts have their turns one after the other.
  std::vector<std::unique_ptr<Tooth>> teeth;
  std::vector<std::unique_ptr<TicksGroup>> groups;
  const auto plan_on = [&](const char* what, int cells_of, double voxel_m,
                           std::span<const int> contacts) {
    progress(what);
    Tooth& tooth = *teeth.emplace_back(std::make_unique<Tooth>(cells_of, voxel_m));
    for (const int wanted : contacts) {
      groups.push_back(plan_group(tooth.workpiece, tooth.pca ? &*tooth.pca : nullptr, kSulcus,
                                  wanted, measured.plan, progress));
    }
  };
  const std::vector<int>& all = measured.plan.contacts;
  const auto many = std::upper_bound(all.begin(), all.end(), measured.most_at_coarse);
  if (many != all.begin()) {
    plan_on("the tooth", measured.cells, measured.voxel_m, {all.begin(), many});
  }
  if (many != all.end()) {
    plan_on("the tooth in finer voxels", 2 * measured.cells, 0.5 * measured.voxel_m,
            {many, all.end()});
  }
  measure_groups(groups, progress);
  progress("");
  for (const auto& group : groups) tables.add(*group);
  return tables.rows;
}

void write_sweep(Results& results, const std::string& size, std::span<const SweepRow> rows,
                 const ProgressLine& line) {
  line.clear();
  CsvFile csv(results.table("ticks_" + size + ".csv"), size + kSweepColumns);
  for (const SweepRow& row : rows) csv.write(sweep_line(row));
  print_sweep(size.c_str(), rows);
}

void ticks(const TicksOptions& options) {
  const Measured measured = measured_by(options);
  Results results(options.folder);
  const ProgressLine line;
  const auto progress = [&](const std::string& what) { line.say(what); };
  std::printf("Molar, %d^3 voxels of %.1f um; scaling smooth, the default; neighbourhood 6\n",
              measured.cells, 1e6 * measured.voxel_m);
  const InstructionCounter counter;
  if (!counter.refused().empty()) {
    std::printf("Instructions are not counted: %s\n", counter.refused().c_str());
  }
  if (!is_available(Method::kPca)) std::printf("Built without PCL: times only, no ratios to PCA\n");

  std::vector<TickRow> rows;
  std::vector<SweepRow> bodies, cells;
  if (options.measures("contacts")) rows = measure_contacts(measured, results, progress);
  if (options.measures("bodies")) {
    progress("the tooth");
    Workpiece tooth = molar(measured.cells, measured.voxel_m);
    bodies = measure_bodies(tooth, kSulcus, measured.bodies, measured.body_contacts, measured.plan,
                            progress);
    write_sweep(results, "bodies", bodies, line);
  }
  if (options.measures("cells")) {
    cells = measure_cells(measured.grids, measured.grid_contacts, measured.plan, progress);
    write_sweep(results, "cells", cells, line);
  }
  print_ratios(tick_ratios(rows, cells, bodies));
  std::printf("Peak memory %.0f MiB\n", static_cast<double>(peak_resident_bytes()) / (1 << 20));

  if (!rows.empty()) {
    for (const char* chart : {"ticks", "ticks_stages"}) results.draw(chart, chart);
  }
  if (!cells.empty() && !bodies.empty()) results.draw("ticks_sweeps", "ticks_sweeps");
  results.print();
}

}  // namespace

void add_ticks_command(CLI::App& program) {
  auto options = std::make_shared<TicksOptions>();
  CLI::App* command = program.add_subcommand(
      "ticks", "Time of a whole tick by voxels in contact, method and where normals come from");
  command
      ->add_option("--contacts", options->contacts,
                   "Voxels in contact (100,350,1200,4000,10000,30000,100000)")
      ->delimiter(',')
      ->check(CLI::Range(20, 200000));
  command->add_option("--method", options->methods, "Methods of a tick, by name (ldm_fast,ldm)")
      ->delimiter(',');
  command
      ->add_option("--measure", options->measured,
                   "By contacts, by cells of a grid, by bodies (contacts,cells,bodies)")
      ->delimiter(',')
      ->check(CLI::IsMember(kTickMeasurements));
  command->add_flag("--quick", options->quick, "Coarse voxels, small grids, few ticks: a trial");
  command->add_option("-o", options->folder, "Folder for the results (out/lab/ticks)");
  command->footer(
      "The built-in molar at 512^3, a round burr that goes to and fro over the central sulcus at\n"
      "10 mm/s, its size and depth such that as many voxels are in contact; scaling smooth, NS 6.\n"
      "Above 5 mm a bare ball; above 40,000 contacts at 1024^3, where it finds them.\n"
      "cache: fresh (every normal anew), kept (all found before), cutting (voxels go in every "
      "tick).\n"
      "Writes into the folder:\n"
      "  ticks.csv         us of a tick; contacts is what was asked for\n"
      "  ticks_found.csv   contacts found, voxels removed, PCA's time for as many normals\n"
      "  ticks_stages.csv  us of each stage, from a run of its own\n"
      "  ticks_floor.csv   bytes that a tick must touch, and the time to read them\n"
      "  ticks_cells.csv   the same contacts of a plate in grids of 128^3 to 1024^3\n"
      "  ticks_bodies.csv  1 to 16 bodies, one touched\n"
      "  ticks.png, ticks_stages.png, ticks_sweeps.png\n"
      "Times are thread CPU time, best of three repetitions by their means.");
  command->callback([options] { ticks(*options); });
}

}  // namespace sulcus::lab
