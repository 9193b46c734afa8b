#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/scene/scene_file.hpp"
#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/table1/table1_experiment.hpp"
#include "tools/sulcus_lab/table1/table1_rows.hpp"

namespace sulcus::lab {

namespace {

// Both compare thousands of ticks within minutes: the reference takes tens of microseconds for each
// of the contacts, of which cutting has hundreds.
constexpr int kEveryProbing = 2, kEveryCutting = 10;

struct Table1Options {
  std::string folder = "out/lab/table1";
  std::string probing = SULCUS_SCENES "/probe_sulcus.toml";
  std::string cutting = SULCUS_SCENES "/cut_sulcus.toml";
  int every = 0;  // 0: the two above
};

struct Experiment {
  std::string name;
  Scene scene;
  int every;
};

std::vector<Experiment> experiments_of(const Table1Options& options) {
  std::vector<Experiment> all;
  for (const std::string scaling : {"count", "smooth"}) {
    const std::vector<std::string> settings = {"haptics.normals=ldm", "haptics.neighbourhood=6",
                                               "haptics.trace=12", "haptics.scaling=" + scaling};
    const std::string suffix = scaling == "count" ? "" : "_" + scaling;
    const auto add = [&](const char* name, const std::string& file, int usual) {
      all.push_back(
          {name + suffix, load_scene(file, settings), options.every > 0 ? options.every : usual});
    };
    add("probing", options.probing, kEveryProbing);
    add("cutting", options.cutting, kEveryCutting);
  }
  return all;
}

/// Counts and ticks in full, the rest to five digits; empty where there is nothing.
std::string table_cell(double value) {
  return number_cell(value == std::floor(value) ? "%.0f" : "%.5g", value);
}

void print_rows(const std::vector<Table1Row>& rows) {
  std::printf("%-16s %-34s %12s %12s %12s\n", "", "", "paper", "ours", "exact");
  for (const Table1Row& row : rows) {
    std::printf("%-16s %-34s %12s %12s %12s\n", row.experiment.c_str(), row.quantity.c_str(),
                table_cell(row.paper).c_str(), table_cell(row.ours).c_str(),
                table_cell(row.exact).c_str());
  }
  std::printf("\n");
  std::fflush(stdout);
}

/// What the chart draws: magnitudes of every compared tick.
void write_compared(const std::string& path, const Table1Run& run) {
  CsvFile csv(path,
              "tick,contacts,force_N,exact_force_N,truth_force_N,torque_mNm,exact_torque_mNm,"
              "truth_torque_mNm");
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  for (const ComparedTick& tick : run.compared) {
    std::string line = std::to_string(tick.tick) + "," + std::to_string(tick.contacts);
    const auto add = [&](double ours, double exact, double truth) {
      for (const double value : {ours, exact, run.has_truth ? truth : nothing}) {
        line += ',' + number_cell("%.6g", value);
      }
    };
    add(tick.ours.force_N.norm(), tick.exact.force_N.norm(), tick.truth.force_N.norm());
    add(1e3 * tick.ours.torque_Nm.norm(), 1e3 * tick.exact.torque_Nm.norm(),
        1e3 * tick.truth.torque_Nm.norm());
    csv.write(line);
  }
}

void table1(const Table1Options& options) {
  const std::vector<Experiment> experiments = experiments_of(options);
  Results results(options.folder);
  CsvFile csv(results.table("table1.csv"), "experiment,quantity,paper,ours,exact");
  const ProgressLine progress;
  for (const Experiment& experiment : experiments) {
    const Table1Run run = run_table1_experiment(
        experiment.scene, experiment.every,
        [&](const std::string& what) { progress.say(experiment.name + ": " + what); });
    const std::vector<Table1Row> rows = table1_rows(experiment.name, run);
    for (const Table1Row& row : rows) {
      csv.write(row.experiment + "," + row.quantity + "," + table_cell(row.paper) + "," +
                table_cell(row.ours) + "," + table_cell(row.exact));
    }
    progress.clear();
    print_rows(rows);
    const std::string name = "table1_" + experiment.name;
    write_compared(results.table(name + ".csv"), run);
    results.draw("table1", name, experiment.name);
  }
  results.print();
}

}  // namespace

void add_table1_command(CLI::App& program) {
  auto options = std::make_shared<Table1Options>();
  CLI::App* command = program.add_subcommand(
      "table1", "Table 1 of Kim and Park (2019): forces with ldm and with the offline reference");
  command->add_option("--probing", options->probing,
                      "Scene of the first experiment (probe_sulcus)");
  command->add_option("--cutting", options->cutting, "Scene of the second experiment (cut_sulcus)");
  command
      ->add_option("--every", options->every,
                   "Ticks from one that is compared with exact to the next (2 while probing, 10 "
                   "while cutting)")
      ->check(CLI::Range(1, 100000));
  command->add_option("-o", options->folder, "Folder for the results (out/lab/table1)");
  command->footer(
      "Writes into the folder:\n"
      "  table1.csv              experiment,quantity,paper,ours,exact\n"
      "  table1_EXPERIMENT.csv   tick,contacts,force_N,exact_force_N,truth_force_N,torque_mNm,\n"
      "                          exact_torque_mNm,truth_torque_mNm: of each compared tick\n"
      "  table1_EXPERIMENT.png   figs. 5 and 6 of the paper: force and torque over the ticks, "
      "ours\n"
      "                          in blue, the reference in red, and the difference\n"
      "Both scenes are run with ldm at NS 6, and beside it the contact of a tick is evaluated "
      "again\n"
      "with exact, on the same voxels at the same pose: only ldm cuts. probing and cutting have "
      "the\n"
      "paper's scaling, count, with depth at the voxels' centres, so that the normals alone "
      "differ;\n"
      "probing_smooth and cutting_smooth have the default, with depth at each method's own "
      "surface\n"
      "point. Differences are of magnitudes, as the paper's; _vector_ ones are of the vectors. "
      "Rows\n"
      "truth_ compare both with the analytic normals of the built-in molar, while it is uncut.\n"
      "Times are thread CPU time of a run of its own; a tick of exact is that tick with the time "
      "of\n"
      "its normals. offline_ is the paper's for its reference.");
  command->callback([options] { table1(*options); });
}

}  // namespace sulcus::lab
