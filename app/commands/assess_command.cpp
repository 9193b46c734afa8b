#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/common_options.hpp"
#include "app/inspect/solid_file.hpp"
#include "app/playback/recorded_run.hpp"
#include "app/report/assessment.hpp"
#include "app/report/comparison_page.hpp"
#include "app/report/moment_pictures.hpp"
#include "app/report/output_file.hpp"
#include "app/report/page/page_html.hpp"
#include "app/report/results.hpp"
#include "app/report/results_folder.hpp"
#include "app/report/run_key.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

namespace {

struct AssessOptions {
  std::vector<std::string> recordings;
  std::string assessment, before, after, plan, folder;
  std::optional<double> solid_above;
  bool no_render = false, force = false;
};

AssessmentSettings settings_of(const std::string& text, const std::string& file) {
  auto settings = assessment_of(text, file);
  if (!settings) {
    throw InputError(file, "[assessment]", "none", "one in the scene, or --assessment FILE.toml");
  }
  return *std::move(settings);
}

/// The file's, else the scene's that the recording carries.
AssessmentSettings settings_for(const AssessOptions& options, const RecordingReader& reader,
                                const std::string& recording) {
  if (options.assessment.empty())
    return settings_of(recorded_scene(reader, recording).text, recording);
  return settings_of(read_scene_text(options.assessment), options.assessment);
}

void say_assessment(const Assessment& assessment) {
  say("%s\n", assessment.subject.c_str());
  for (const std::string& line : assessment_lines(assessment)) say("%s\n", line.c_str());
}

/// Where an assessment is written, and the names of its files there.
class AssessmentFolder {
 public:
  /// `first`: what gives it its name without -o.
  AssessmentFolder(const AssessOptions& options, const std::string& first, std::string key)
      : folder_({.given = options.folder,
                 .otherwise = folder_of_recording(first, "-assessment"),
                 .force = options.force,
                 .key = std::move(key),
                 .kind = ResultsKind::kAssessment}) {}

  /// Of a name in it; of none its own.
  std::string path(const std::string& name) const {
    return name.empty() ? folder_.at() : folder_.at() + "/" + name;
  }
  void add(const std::string& name) { names_.push_back(name); }
  void write(const std::string& name, const std::string& text) {
    write_whole_file(path(name), text);
    add(name);
  }
  /// Puts all where it belongs, and says which files there are.
  void finish() {
    folder_.finish(true);
    for (const std::string& name : names_) say("%s/%s\n", folder_.path().c_str(), name.c_str());
  }

 private:
  ResultsFolder folder_;
  std::vector<std::string> names_;
};

std::string csv_text(const std::string& text) {
  std::string cell = "\"";
  for (const char c : text) cell.append(c == '"' ? 2 : 1, c);
  return cell + '"';
}

/// One row an attempt, a column for each measure that any of them has.
std::string table_of(const std::vector<Assessment>& attempts) {
  std::string table = "attempt,subject,mark";
  std::vector<std::string_view> names;
  for (const MeasureName& measure : measure_names()) {
    for (const Assessment& attempt : attempts) {
      if (value_of(attempt, measure.name)) {
        names.push_back(measure.name);
        break;
      }
    }
  }
  for (const std::string_view name : names) table.append(",").append(name);
  table += '\n';
  const auto cell = [](const std::optional<double>& value) {
    return value ? formatted(",%.9g", *value) : std::string(",");
  };
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    table += formatted("%zu,", i + 1) + csv_text(attempts[i].subject) + cell(attempts[i].mark);
    for (const std::string_view name : names) table += cell(value_of(attempts[i], name));
    table += '\n';
  }
  return table;
}

/// Side by side, where there is room for all of them and what draws it is installed.
void write_comparison(AssessmentFolder& folder, const std::vector<ComparedAttempt>& attempts) {
  if (attempts.size() > kMostCompared) {
    say_error("comparison.html was not written: it shows %zu attempts at most\n", kMostCompared);
    return;
  }
  try {
    three_js();
  } catch (const InputError& missing) {
    say_error("comparison.html was not written: %s\n", missing.what());
    return;
  }
  const Progress progress("drawing");
  write_comparison_page(attempts, folder.path("comparison.html"));
  folder.add("comparison.html");
}

void assess_pair(const AssessOptions& options) {
  if (options.before.empty() || options.after.empty()) {
    throw InputError("", "assess", "one of --before and --after", "both, or a recording");
  }
  if (!options.recordings.empty()) {
    throw InputError("", "assess", "a recording beside --before and --after", "one or the other");
  }
  if (options.assessment.empty()) {
    throw InputError("", "assess", "no --assessment", "FILE.toml with [assessment]");
  }
  const AssessmentSettings settings =
      settings_of(read_scene_text(options.assessment), options.assessment);
  std::string key;
  const Assessment result = [&] {
    const Progress progress("assessing");
    const auto surface = [&](const std::string& file, const std::string& option) {
      return ScannedTooth::Surface{file, surface_of_file(file, options.solid_above, option)};
    };
    ScannedTooth tooth{surface(options.before, "--before"), surface(options.after, "--after"), {}};
    if (!options.plan.empty()) tooth.plan = surface(options.plan, "--plan");
    key = key_of_assessment(tooth, settings);
    return assess_scanned(tooth, settings);
  }();
  say_assessment(result);
  AssessmentFolder folder(options, options.after, std::move(key));
  folder.write("assessment.json", assessment_json(result));
  folder.finish();
}

void assess(AssessOptions options) {
  check_output_folder("-o", options.folder);
  if (options.solid_above && options.before.empty() && options.after.empty()) {
    throw InputError("", "--solid-above", "no --before and --after", "both, of volumes");
  }
  if (!options.before.empty() || !options.after.empty()) return assess_pair(options);
  if (!options.plan.empty()) {
    throw InputError("", "--plan", "no --before and --after",
                     "both; what a recording was to become is its scene's [goal]");
  }
  if (options.recordings.empty()) {
    throw InputError("", "assess", "nothing to assess", "RECORDING..., or --before and --after");
  }
  for (std::string& recording : options.recordings) recording = recording_file_of(recording);
  std::vector<Assessment> attempts;
  std::vector<ComparedAttempt> compared;
  std::vector<std::string> keys;
  for (const std::string& recording : options.recordings) {
    const Progress progress("assessing");
    const RecordingReader reader(recording);
    say_what_is_missing(reader);
    AssessmentSettings settings = settings_for(options, reader, recording);
    attempts.push_back(assess_recording(reader, recording, settings));
    keys.push_back(key_of_assessment(reader, settings));
    compared.push_back({recording, attempts.back(), std::move(settings)});
  }
  for (const Assessment& attempt : attempts) say_assessment(attempt);
  AssessmentFolder folder(options, options.recordings.front(), key_of_assessments(keys));
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    const std::string own = attempts.size() == 1 ? "" : std::to_string(i + 1);
    const std::string in_own = own.empty() ? own : own + "/";
    make_output_folder("-o", folder.path(own));
    if (!options.no_render) {
      const Progress progress("drawing");
      const std::string& recording = options.recordings[i];
      const RecordingReader reader(recording);
      for (const std::string& name :
           draw_moments(reader, recording, folder.path(own), attempts[i])) {
        folder.add(in_own + name);
      }
    }
    folder.write(in_own + "assessment.json", assessment_json(attempts[i]));
  }
  if (attempts.size() > 1) {
    folder.write("assessment.csv", table_of(attempts));
    write_comparison(folder, compared);
  }
  folder.finish();
}

}  // namespace

void add_assess_command(CLI::App& program) {
  auto options = std::make_shared<AssessOptions>();
  CLI::App* command = program.add_subcommand("assess", "Measure and mark a preparation");
  add_option(*command, "RECORDING", options->recordings, "FILE", "Recordings, .h5");
  add_option(*command, "--assessment", options->assessment, "FILE",
             "Limits: .toml with [assessment] (that of the scene)");
  add_option(*command, "--before", options->before, "FILE",
             "Without a recording: the tooth as it was, a mesh in mm (.stl, .obj, .ply) or\n"
             "a volume, as a scene takes them");
  add_option(*command, "--after", options->after, "FILE", "And as it is, in the same space");
  add_option(*command, "--plan", options->plan, "FILE",
             "And as it should have become, in the same space");
  add_option(*command, "--solid-above", options->solid_above, "VALUE",
             "Of volumes of grey values: from which on they are tooth");
  add_option(*command, "-o", options->folder, "DIR",
             "Folder for assessment.json, with a picture and a film of the moment of each\n"
             "limit that is not met (out/NAME-assessment); of several in 1/, 2/, ..., with\n"
             "a table of all, assessment.csv, and a page that shows them side by side,\n"
             "comparison.html");
  command->add_flag("--force", options->force, "Replace another assessment in the folder of -o");
  command->add_flag("--no-render", options->no_render,
                    "Draw no pictures and films of what is not met");
  command->callback([options] { assess(*options); });
}

}  // namespace sulcus
