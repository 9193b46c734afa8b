#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "app/commands/number_within.hpp"
#include "engine/scene/scene_file.hpp"
#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/recordings/recording_trials.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

namespace {

struct RecordingsOptions {
  std::string folder = "out/lab/recordings";
  std::string scene = SULCUS_SCENES "/cut_sulcus.toml";
  std::vector<std::string> trials{"kills", "cuts", "flips", "back", "reach"};
  double minutes = 30.0;
  TrialSetting setting;
};

void recordings(RecordingsOptions options) {
  (void)load_scene(options.scene);  // refuses what cannot be run
  Results results(options.folder);
  const TrialFolder files(results);
  TrialSetting& setting = options.setting;
  setting.folder = files.path();
  setting.program =
      (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "sulcus").string();
  const std::vector<std::pair<std::string, std::function<std::vector<TrialRow>()>>> all{
      {"kills", [&] { return trial_of_kills(setting); }},
      {"cuts", [&] { return trial_of_cuts(setting); }},
      {"flips", [&] { return trial_of_flips(setting); }},
      {"back", [&] { return trial_of_going_back(setting); }},
      {"reach", [&] { return trial_of_reach(setting, options.scene); }},
      {"soak", [&] { return trial_of_soak(setting, options.scene, options.minutes); }}};
  CsvFile csv(results.table("recordings.csv"), "trial,quantity,value,limit,pass");
  ProgressLine progress;
  for (const auto& [name, run] : all) {
    if (std::ranges::find(options.trials, name) == options.trials.end()) continue;
    progress.say(name);
    const std::vector<TrialRow> rows = run();
    progress.clear();
    for (const TrialRow& row : rows) {
      std::ostringstream line;
      line << row.trial << ',' << row.quantity << ',' << row.value << ',';
      if (row.most)
        line << *row.most << ',' << (row.pass() ? "yes" : "no");
      else
        line << ',';
      csv.write(line.str());
      std::printf("%-6s %-26s %10g%s\n", row.trial.c_str(), row.quantity.c_str(), row.value,
                  row.pass() ? "" : "  MISSED");
    }
    std::fflush(stdout);
  }
  results.print();
}

}  // namespace

void add_recordings_command(CLI::App& program) {
  auto options = std::make_shared<RecordingsOptions>();
  CLI::App* command = program.add_subcommand(
      "recordings", "What a recording survives, and how fast any time of it is reached");
  command->add_option("--case", options->trials, "kills,cuts,flips,back,reach (all these), soak")
      ->delimiter(',')
      ->check(CLI::IsMember({"kills", "cuts", "flips", "back", "reach", "soak"}));
  command->add_option("--kills", options->setting.kills, "Runs that are killed (200)")
      ->check(CLI::Range(1, 100000));
  command->add_option("--flips", options->setting.flips, "Bits turned round (1000)")
      ->check(CLI::Range(1, 10000000));
  command->add_option("--cuts", options->setting.cut_bytes, "Bytes cut off, one by one (65536)")
      ->check(CLI::Range(1, 10000000));
  command->add_option("--ticks", options->setting.ticks, "Of the cut gone back through (2000)")
      ->check(CLI::Range(10, 100000));
  command->add_option("--scene", options->scene, "Scene of reach and soak (cut_sulcus)");
  command->add_option("--minutes", options->minutes, "Of soak (30)")
      ->check(number_within(0.05, 1e4));
  command->add_option("-o", options->folder, "Folder for the results (out/lab/recordings)");
  command->footer(
      "Runs the program beside it as processes of their own.\n"
      "Writes into the folder:\n"
      "  recordings.csv   trial,quantity,value,limit,pass");
  command->callback([options] { recordings(*options); });
}

}  // namespace sulcus::lab
