#include <algorithm>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/fractions/fractions.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

namespace {

struct FractionsCommand {
  std::string folder = "out/lab/fractions";
  std::vector<std::string> names;  // none: all
  bool quick = false;
  CtFile ct;  // no path: none
};

std::string fraction_line(const FractionRow& row) {
  return row.quantity + ',' + text_cell(row.shape) + ',' + text_cell(row.setting) + ',' +
         number_cell("%.6g", row.binary()) + ',' + number_cell("%.6g", row.fractions()) + ',' +
         with_number("%.6g", row.wanted) + (row.pass() ? ",yes" : ",no");
}

/// Of the chart: a row that was timed, binary and fractions.
std::string fraction_times_line(const FractionRow& row) {
  return row.quantity + ',' + text_cell(row.shape) + ',' + text_cell(row.setting) + ',' +
         with_number("%.6g", row.ns[0]) + ',' + number_cell("%.6g", row.binary()) + ',' +
         with_number("%.6g", row.ns[1]) + ',' + number_cell("%.6g", row.fractions());
}

void print_fraction_row(const FractionRow& row) {
  std::printf("%-23s %-17s %-44s %9.4g %9.4g %9.4g  %s\n", row.quantity.c_str(), row.shape.c_str(),
              row.setting.c_str(), row.binary(), row.fractions(), row.wanted,
              row.pass() ? "yes" : "NO");
  std::fflush(stdout);
}

/// A bar of the chart of a CT's errors.
std::string ct_bin_line(const CtBin& bin) {
  return std::string(bin.quantity) + ',' + std::string(bin.truth) + ',' +
         with_number("%.6g,", bin.from) + with_number("%.6g,", bin.to) +
         with_number("%.6g,", bin.share_pct[0]) + with_number("%.6g", bin.share_pct[1]);
}

void draw_ct_bins(std::span<const CtBin> bins, Results& results) {
  CsvFile csv(results.table("fractions_ct.csv"), "quantity,truth,from,to,binary,fractions");
  for (const CtBin& bin : bins) csv.write(ct_bin_line(bin));
  results.draw("fractions_ct", "fractions_ct");
}

FractionOptions options_of(const FractionsCommand& command, const ProgressLine& progress,
                           Results& results) {
  FractionOptions options;
  options.quick = command.quick;
  if (!command.ct.path.empty()) options.ct = command.ct;
  options.progress = [&](const std::string& what) { progress.say(what); };
  options.take_bins = [&](std::span<const CtBin> bins) { draw_ct_bins(bins, results); };
  return options;
}

void measure_fractions(const FractionsCommand& command) {
  // Before anything is made or measured: what is wrong with the file is said at once.
  if (!command.ct.path.empty()) load_ct(command.ct, SurfaceKind::kBinary);
  Results results(command.folder);
  CsvFile csv(results.table("fractions.csv"),
              "quantity,shape,setting,binary,fractions,wanted,pass");
  CsvFile times(results.table("fractions_times.csv"),
                "quantity,shape,setting,binary_ns,binary,fractions_ns,fractions");
  const ProgressLine progress;
  const FractionOptions options = options_of(command, progress, results);
  std::printf("%-23s %-17s %-44s %9s %9s %9s  %s\n", "quantity", "", "", "binary", "fractions",
              "wanted", "pass");
  bool timed = false;
  int missed = 0;
  for (const FractionMeasurement& measurement : fraction_measurements()) {
    const bool asked = command.names.empty() ||
                       std::ranges::find(command.names, measurement.name) != command.names.end();
    if (!asked || (command.quick && !measurement.has_quick_half)) continue;
    if (measurement.needs_ct && !options.ct) {
      std::printf("%.*s: not measured without --ct FILE\n",
                  static_cast<int>(measurement.name.size()), measurement.name.data());
      continue;
    }
    const std::vector<FractionRow> rows = measurement.measure(options);
    progress.clear();
    for (const FractionRow& row : rows) {
      print_fraction_row(row);
      csv.write(fraction_line(row));
      if (!row.pass()) ++missed;
      if (!row.is_timed()) continue;
      times.write(fraction_times_line(row));
      timed = true;
    }
  }
  if (timed) results.draw("fractions", "fractions");
  results.print();
  if (missed > 0) std::printf("%d are not what is wanted.\n", missed);
}

}  // namespace

void add_fractions_command(CLI::App& program) {
  auto fractions = std::make_shared<FractionsCommand>();
  CLI::App* command = program.add_subcommand(
      "fractions", "Surfaces that carry their filled fraction, beside binary ones");
  std::vector<std::string> names;
  for (const FractionMeasurement& measurement : fraction_measurements()) {
    names.emplace_back(measurement.name);
  }
  command->add_option("--measure", fractions->names, "What to measure, comma separated (all)")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  command->add_flag("--quick", fractions->quick, "What takes seconds: less than a minute");
  CLI::Option* ct = command->add_option(
      "--ct", fractions->ct.path,
      "Volume of grey values in cubic voxels, on which ct is measured (none: it is not)");
  CLI::Option* above = command->add_option("--solid-above", fractions->ct.solid_above,
                                           "Grey value from which a voxel of it is solid");
  ct->needs(above);
  above->needs(ct);
  command->add_option("-o", fractions->folder, "Folder for the results (out/lab/fractions)");
  command->footer(
      "Writes into the folder:\n"
      "  fractions.csv        quantity,shape,setting,binary,fractions,wanted,pass\n"
      "  fractions_times.csv  the rows that were timed, with nanoseconds a normal, an evaluation "
      "or\n"
      "                       a tick\n"
      "  fractions.png        errors and grain against time, binary and fractions\n"
      "  fractions_ct.csv     quantity,truth,from,to,binary,fractions: share of the surface "
      "voxels, "
      "%\n"
      "  fractions_ct.png     how large errors on the CT are\n"
      "What is wanted is the largest size of the value with fractions that passes.\n"
      "On a CT: the true surface goes through the grey values, or through the smoothed ones, as\n"
      "the import smooths them; wanted is less than with binary voxels.");
  command->callback([fractions] { measure_fractions(*fractions); });
}

}  // namespace sulcus::lab
