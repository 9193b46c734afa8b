#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "app/build_info.hpp"
#include "engine/core/whole_file.hpp"
#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/laws/laws.hpp"
#include "tools/sulcus_lab/laws/laws_page.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

namespace {

struct LawsCommand {
  std::string folder = "out/lab/laws";
  std::vector<std::string> names;  // none: all
  std::string surface = std::string(kSurfaceNames[0]);
  LawOptions options;
};

void write_law_row(CsvFile& csv, const LawRow& row) {
  csv.write(row.law + ',' + text_cell(row.shape) + ',' + row.scaling + ',' +
            text_cell(row.setting) + ',' + row.quantity + ',' + with_number("%.6g", row.value) +
            ',' +
            (row.limit ? with_number("%.6g", *row.limit) + (row.pass() ? ",yes" : ",no") : ","));
}

/// A line for each law: under each scaling, how many of its limits are met.
void print_law(const Law& law, const std::vector<LawRow>& rows,
               const std::vector<std::string>& scalings) {
  std::printf("%-21s", std::string(law.name).c_str());
  for (const std::string& scaling : scalings) {
    int held = 0, failed = 0;
    for (const LawRow& row : rows) {
      if (row.scaling != scaling || !row.limit) continue;
      ++(row.pass() ? held : failed);
    }
    if (held + failed > 0) std::printf("  %s %d/%d", scaling.c_str(), held, held + failed);
  }
  std::printf("\n");
  std::fflush(stdout);
}

void measure_laws(const LawsCommand& command) {
  Results results(command.folder);
  CsvFile csv(results.table("laws.csv"), "law,shape,scaling,setting,quantity,value,limit,pass");
  const ProgressLine progress;
  std::vector<LawRow> all;
  for (const Law& law : laws()) {
    if (!command.names.empty() &&
        std::ranges::find(command.names, law.name) == command.names.end()) {
      continue;
    }
    progress.say(std::string(law.name));
    const std::vector<LawRow> rows = measure_law(law.name, command.options);
    progress.clear();
    print_law(law, rows, command.options.scalings);
    for (const LawRow& row : rows) write_law_row(csv, row);
    all.insert(all.end(), rows.begin(), rows.end());
  }
  const bool has_ways =
      std::ranges::any_of(all, [](const LawRow& row) { return row.law == "closed_way"; });
  const bool drawn = has_ways && results.draw("laws", "laws");
  write_whole_file(results.table("laws.html"),
                   laws_page(all, drawn ? "laws.png" : "",
                             "Measured by sulcus-lab laws, " + command.surface +
                                 " surfaces, build " + std::string(build_info()) + "."));
  results.print();
  const auto missed = std::ranges::count_if(all, [](const LawRow& row) { return !row.pass(); });
  if (missed > 0) std::printf("%d limits are missed.\n", static_cast<int>(missed));
}

}  // namespace

void add_laws_command(CLI::App& program) {
  auto laws_command = std::make_shared<LawsCommand>();
  CLI::App* command = program.add_subcommand(
      "laws", "The laws of the force: no history, no favoured axis, no energy from nowhere");
  std::vector<std::string> names;
  for (const Law& law : laws()) names.emplace_back(law.name);
  command->add_option("--law", laws_command->names, "Laws, comma separated (all)")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  command->add_option("--shape", laws_command->options.shapes, "Shapes, comma separated (all)")
      ->delimiter(',');
  command
      ->add_option("--scaling", laws_command->options.scalings, "Scalings, comma separated (all)")
      ->delimiter(',')
      ->check(CLI::IsMember(
          std::vector<std::string>(std::begin(kLawScalings), std::end(kLawScalings))));
  command->add_option("--surface", laws_command->surface, "binary, or fractions")
      ->capture_default_str()
      ->check(CLI::IsMember(std::vector<std::string>(kSurfaceNames.begin(), kSurfaceNames.end())));
  command->add_flag("--quick,--brief", laws_command->options.quick,
                    "Fewer shapes and settings: less than a minute");
  command->add_option("-o", laws_command->folder, "Folder for the results (out/lab/laws)");
  command->footer(
      "Writes into the folder:\n"
      "  laws.html   each law, what is wanted, what was measured\n"
      "  laws.csv    law,shape,scaling,setting,quantity,value,limit,pass\n"
      "  laws.png    energy given out by closed ways\n"
      "A row without a limit is only reported. The scaling `potential` is held to more than the\n"
      "others, which have none.");
  command->callback([laws_command] {
    const auto at = std::ranges::find(kSurfaceNames, laws_command->surface);
    laws_command->options.surface = static_cast<SurfaceKind>(at - kSurfaceNames.begin());
    measure_laws(*laws_command);
  });
}

}  // namespace sulcus::lab
