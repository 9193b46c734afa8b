#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/commands/commands.hpp"
#include "app/commands/common_options.hpp"
#include "app/commands/help_text.hpp"
#include "app/commands/manual.hpp"
#include "app/commands/shipped_files.hpp"
#include "app/report/output_file.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {

namespace {

struct HelpOptions {
  std::string topic, folder;
};

void write_page(const std::filesystem::path& file, const std::string& text) {
  make_output_folder("--write", file.parent_path().string());
  write_whole_file(file.string(), text);
}

void write_manual(const CLI::App& program, const std::filesystem::path& folder) {
  const std::filesystem::path pages = folder / "man";
  write_page(pages / "man1/sulcus.1", program_page(program));
  for (const CLI::App* command : program.get_subcommands({})) {
    const std::string name = "sulcus-" + command->get_name() + ".1";
    write_page(pages / "man1" / name, command_page(*command));
  }
  write_page(pages / "man5/sulcus-scene.5", scene_page());
  write_page(pages / "man5/sulcus-recording.5", recording_page());
  write_page(folder / "bash-completion/completions/sulcus", bash_completion(program));
}

void help(const CLI::App& program, const HelpOptions& options) {
  if (!options.folder.empty()) return write_manual(program, options.folder);
  std::string text;
  if (options.topic.empty()) {
    // Not program.help(): that is of the command being run, this one.
    text = program.get_formatter()->make_help(&program, "sulcus", CLI::AppFormatMode::Normal);
  } else if (options.topic == "scene") {
    text = scene_help();
  } else if (options.topic == "scenes") {
    text = shipped_scene_help();
  } else if (options.topic == "recording") {
    text = recording_help();
  } else if (options.topic == "burrs") {
    text = burr_help();
  } else {
    text = program.get_subcommand(options.topic)->help("sulcus");
  }
  std::fputs(text.c_str(), stdout);
}

}  // namespace

void add_help_command(CLI::App& program) {
  auto options = std::make_shared<HelpOptions>();
  std::vector<std::string> topics{"scene", "scenes", "recording", "burrs"};
  for (const CLI::App* command : program.get_subcommands({})) topics.push_back(command->get_name());
  topics.emplace_back("help");
  CLI::App* command = program.add_subcommand(
      "help",
      "Show help on a command, a scene's keys, shipped scenes, recordings, or burrs by number");
  add_option(*command, "TOPIC", options->topic, "TOPIC",
             "scene, scenes, recording, burrs, or a command (the program)")
      ->check(CLI::IsMember(topics));
  add_option(*command, "--write", options->folder, "DIR",
             "Write manual pages and the completion of bash below this folder, as they lie "
             "in /usr/share");
  command->callback([&program, options] { help(program, *options); });
}

}  // namespace sulcus
