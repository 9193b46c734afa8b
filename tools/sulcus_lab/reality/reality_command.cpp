#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/reality/reality.hpp"
#include "tools/sulcus_lab/reality/reality_bands.hpp"
#include "tools/sulcus_lab/reality/reality_curves.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

namespace {

struct RealityCommand {
  std::string folder = "out/lab/reality";
  std::vector<std::string> names;  // none: all
  bool quick = false, fit = false;
};

constexpr CuttingLaw kLaws[] = {CuttingLaw::kPaper, CuttingLaw::kSaturating};

double value_of(const RealityRow& row, CuttingLaw law) {
  return row.value[static_cast<std::size_t>(law)];
}

std::string reality_line(const RealityRow& row) {
  std::string line = text_cell(row.check) + ',' + text_cell(row.source) + ',' +
                     with_number("%.6g", row.low) + ',' + with_number("%.6g", row.high);
  for (const CuttingLaw law : kLaws) line += ',' + with_number("%.6g", value_of(row, law));
  return line;
}

void print_reality_row(const RealityRow& row) {
  std::printf("%-56s %7.4g %7.4g", row.check.c_str(), row.low, row.high);
  for (const CuttingLaw law : kLaws) {
    std::printf("  %8.4g %-3s", value_of(row, law), row.in(law) ? "in" : "OUT");
  }
  std::printf("  %s\n", row.source.c_str());
  std::fflush(stdout);
}

/// How many rows are in their bands, and how many of those no constant was fitted to.
void print_in(const std::vector<RealityRow>& rows) {
  for (const CuttingLaw law : kLaws) {
    const auto in = [law](const RealityRow& row) { return row.in(law); };
    const auto apart = [](const RealityRow& row) { return !row.fitted(); };
    const auto count = [&](const auto& of) {
      return static_cast<int>(std::ranges::count_if(rows, of));
    };
    std::printf("%s: %d of %d rows in their bands, %d of %d that nothing was fitted to\n",
                std::string(kCuttingLawNames[static_cast<std::size_t>(law)]).c_str(), count(in),
                static_cast<int>(rows.size()),
                count([&](const RealityRow& row) { return in(row) && apart(row); }), count(apart));
  }
}

void measure_reality(const RealityCommand& command) {
  if (command.fit) return print_fit();
  Results results(command.folder);
  CsvFile csv(results.table("reality.csv"), "check,source,low,high,paper,saturating");
  const ProgressLine progress;
  RealityOptions options;
  options.quick = command.quick;
  options.progress = [&](const std::string& what) { progress.say(what); };
  std::printf("%-56s %7s %7s  %12s  %12s  source\n", "check", "low", "high", "paper", "saturating");
  std::vector<RealityRow> all;
  for (const RealitySection& section : reality_sections()) {
    if (!command.names.empty() &&
        std::ranges::find(command.names, section.name) == command.names.end()) {
      continue;
    }
    const std::vector<RealityRow> rows = section.measure(options);
    progress.clear();
    for (const RealityRow& row : rows) {
      print_reality_row(row);
      csv.write(reality_line(row));
    }
    all.insert(all.end(), rows.begin(), rows.end());
  }
  print_in(all);
  CsvFile curves(results.table("reality_curves.csv"), "against,series,x,mm3_per_s,label");
  for (const RealityPoint& point : reality_curves(options)) {
    curves.write(point.against + ',' + text_cell(point.series) + ',' +
                 with_number("%.6g", point.x) + ',' + with_number("%.6g", point.mm3_per_s) + ',' +
                 text_cell(point.label));
  }
  progress.clear();
  results.draw("reality", "reality");
  results.print();
}

}  // namespace

void add_reality_command(CLI::App& program) {
  auto reality = std::make_shared<RealityCommand>();
  CLI::App* command = program.add_subcommand(
      "reality", "What others measured in mouths and on rigs, and what Sulcus gives");
  std::vector<std::string> names;
  for (const RealitySection& section : reality_sections()) names.emplace_back(section.name);
  command->add_option("--section", reality->names, "Sections, comma separated (all)")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  command->add_flag("--fit", reality->fit,
                    "Only fit the constants of the saturating law, and print what is minimised");
  command->add_flag("--quick", reality->quick,
                    "Voxels of 0.06 mm, the beginning of the preparation: less than a minute");
  command->add_option("-o", reality->folder, "Folder for the results (out/lab/reality)");
  command->footer(
      "Writes into the folder:\n"
      "  reality.csv         check,source,low,high,paper,saturating: a published band, and the\n"
      "                      figure under each law; (fitted): constants were fitted to the band\n"
      "  reality_curves.csv  rates of removal against load and speed, with published points\n"
      "  reality.png         the same, drawn\n"
      "What lies out of its band is printed, not hidden.");
  command->callback([reality] { measure_reality(*reality); });
}

}  // namespace sulcus::lab
