#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/program/program_trials.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/statistics.hpp"

namespace sulcus::lab {

namespace {

namespace fs = std::filesystem;

struct ProgramOptions {
  std::string folder = "out/lab/program";
  std::string against;  // another build folder
  std::vector<std::string> trials;
  int repeats = 5;
};

/// What one build has measured, figure by figure.
struct MeasuredProgram {
  std::vector<std::string> names;
  std::vector<std::vector<float>> values;

  void add(const ProgramFigures& figures) {
    values.resize(figures.size());
    names.clear();
    for (std::size_t f = 0; f < figures.size(); ++f) {
      names.push_back(figures[f].first);
      values[f].push_back(static_cast<float>(figures[f].second));
    }
  }
};

/// A folder with the programs that are measured.
CLI::Validator build_folder() {
  return CLI::Validator(
      [](std::string& given) {
        for (const char* program : {"/sulcus", "/sulcus-lab"}) {
          if (fs::is_regular_file(given + program)) continue;
          return given + ": found no " + (program + 1) + ", expected a folder of a build";
        }
        return std::string();
      },
      "");
}

void program(const ProgramOptions& options) {
  Results results(options.folder);
  const TrialFolder here(results), there(results);
  std::vector<ProgramBuild> builds{{fs::read_symlink("/proc/self/exe").parent_path(), here.path()}};
  if (!options.against.empty()) builds.push_back({options.against, there.path()});
  CsvFile csv(results.table("program.csv"), "trial,figure,median,lowest,highest,against,ratio");
  std::printf("%-7s %-28s %9s %9s %9s %9s %7s\n", "trial", "figure", "median", "lowest", "highest",
              "against", "ratio");
  ProgressLine progress;
  for (const ProgramTrial& trial : program_trials()) {
    if (std::ranges::find(options.trials, trial.name) == options.trials.end()) continue;
    std::vector<MeasuredProgram> measured(builds.size());
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      progress.say(std::string(trial.name) + ' ' + std::to_string(repeat + 1));
      // In turn, so that what else the machine does is in both.
      for (std::size_t b = 0; b < builds.size(); ++b) measured[b].add(trial.run(builds[b]));
    }
    progress.clear();
    for (std::size_t f = 0; f < measured[0].names.size(); ++f) {
      const auto at = [&](std::size_t b, double part) {
        return b < measured.size() ? quantile(measured[b].values.at(f), part) : 0.0;
      };
      std::ostringstream line;
      line << trial.name << ',' << measured[0].names[f] << ',' << at(0, 0.5) << ',' << at(0, 0.0)
           << ',' << at(0, 1.0) << ',';
      std::printf("%-7s %-28s %9.4g %9.4g %9.4g", trial.name, measured[0].names[f].c_str(),
                  at(0, 0.5), at(0, 0.0), at(0, 1.0));
      if (builds.size() > 1) {
        line << at(1, 0.5) << ',' << at(0, 0.5) / at(1, 0.5);
        std::printf(" %9.4g %7.3f", at(1, 0.5), at(0, 0.5) / at(1, 0.5));
      } else {
        line << ',';
      }
      csv.write(line.str());
      std::printf("\n");
    }
    std::fflush(stdout);
  }
  results.print();
}

}  // namespace

void add_program_command(CLI::App& program_app) {
  auto options = std::make_shared<ProgramOptions>();
  std::vector<std::string> names;
  std::string footer = "Runs the programs beside it as processes of their own. Trials:\n";
  for (const ProgramTrial& trial : program_trials()) {
    names.emplace_back(trial.name);
    if (!trial.takes_minutes) options->trials.emplace_back(trial.name);
    std::string name = trial.name;
    name.resize(8, ' ');
    footer += "  " + name + trial.measures + (trial.takes_minutes ? "; minutes\n" : "\n");
  }
  CLI::App* command = program_app.add_subcommand(
      "program", "What the whole program takes: start, memory, pictures, large scenes, its build");
  command->add_option("--trial", options->trials, "Some of those below (all that take no minutes)")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  command
      ->add_option("--against", options->against,
                   "Folder of another build, measured in turn with this one")
      ->check(build_folder());
  command->add_option("--repeats", options->repeats, "Of each trial; the median is printed (5)")
      ->check(CLI::Range(1, 1000));
  command->add_option("-o", options->folder, "Folder for the results (out/lab/program)");
  command->footer(footer +
                  "Writes into the folder:\n"
                  "  program.csv   trial,figure,median,lowest,highest,against,ratio");
  command->callback([options] { program(*options); });
}

}  // namespace sulcus::lab
