#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "app/commands/common_options.hpp"
#include "app/playback/continued_run.hpp"
#include "app/playback/recorded_state.hpp"
#include "app/playback/verify_recording.hpp"
#include "app/report/log_file.hpp"
#include "app/report/output_file.hpp"
#include "app/report/results.hpp"
#include "app/report/run_key.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/hash.hpp"
#include "engine/core/stop.hpp"

namespace sulcus {

namespace {

struct ReplayOptions {
  std::string recording, folder, pace = "fast";
  bool verify = false, force = false;
  std::optional<double> from_s;
  std::vector<std::string> overrides;
  int threads = 0;  // 0: all cores
};

void verify(RecordedRun& run, std::size_t first_row) {
  const Verified verified = verify_recording(run, first_row);
  const std::string levels =
      run.reader.has_fills() ? ", " + std::to_string(verified.fills) + " lowered levels" : "";
  say("%s: %zu ticks, %zu removed voxels%s and %zu state hashes agree bit for bit; "
      "volume %s\n",
      run.path.c_str(), verified.rows, verified.edits, levels.c_str(), verified.state_hashes,
      hex(run.simulation->workpiece().hash()).c_str());
  if (verified.skipped > 0) {
    say("%s: %zu ticks after rows that were not recorded could not be compared\n", run.path.c_str(),
        verified.skipped);
  }
  if (run.reader.damage().empty() && verified.damaged_states == 0) return;
  const std::string why =
      run.reader.damage().empty() ? "a state in /keyframes is damaged" : run.reader.damage();
  throw std::runtime_error(run.path + ": verified " + std::to_string(verified.rows) + " of " +
                           std::to_string(run.reader.tick_rows()) + " ticks: " + why);
}

/// Refuses a row after which no tick was recorded.
void check_goes_on(const RecordedRun& run, std::size_t row) {
  const std::vector<TickRecord>& rows = run.rows;
  if (row + 1 == rows.size()) {
    throw InputError(run.path, "--from", "the end of the recording",
                     "a time before " + std::to_string(rows.back().time_s) + " s");
  }
  if (rows[row + 1].tick != rows[row].tick + 1) {
    throw InputError(run.path, "--from", "a time before ticks that were not recorded",
                     "one from " + std::to_string(rows[row + 1].time_s) + " s on, or earlier");
  }
}

/// Rows from `first` that follow on one another.
std::size_t rows_in_line(const RecordedRun& run, std::size_t first) {
  std::size_t end = first + 1;
  while (end < run.rows.size() && run.rows[end].tick == run.rows[end - 1].tick + 1) ++end;
  return end - first;
}

void replay(const ReplayOptions& options) {
  const ThreadLimit limit(options.threads);
  check_output_folder("-o", options.folder);
  std::optional<Progress> reading(std::in_place, "reading");
  RecordedRun run = open_recorded_run(options.recording);
  reading.reset();
  say_what_is_missing(run.reader);
  const std::size_t row =
      options.from_s ? asked_row(run.rows, *options.from_s, "--from", options.recording) : 0;
  if (options.verify) {
    verify(run, row);
    return;
  }
  if (!options.overrides.empty() && !options.from_s) {
    throw InputError("", "--set", "no time to go on from", "--from S");
  }

  SessionOptions session;
  ResultsPlace place{options.folder, folder_of_recording(options.recording, "_replay"),
                     options.force};
  std::error_code ignored;  // what is not there is not the recording
  if (std::filesystem::equivalent(place.given + "/recording.h5", options.recording, ignored)) {
    throw InputError(place.given, "-o", "the folder of the recording itself", "another one");
  }
  session.pace = options.pace == "real" ? Pace::kReal : Pace::kFast;
  session.goal = run.reader.goal();
  session.input = run.reader.input();
  std::size_t first = 0;
  if (options.from_s) {
    const Progress going_there("going to the time");
    check_goes_on(run, row);
    ContinuedRun continued = continue_run(run, row, options.overrides);
    run.simulation = std::move(continued.simulation);
    session.earlier = std::move(continued.earlier);
    session.parent = std::move(continued.parent);
    first = row + 1;
  } else {
    session.earlier = run.earlier;
    session.parent = run.reader.header().parent;
    session.played_back = run.taken_answers;
    place.key = key_of_recording(run.reader, RecordingUse::kReplay);
  }
  session.ticks = rows_in_line(run, first);
  ResultsFolder folder(place);
  open_log(folder.at());
  if (!run.earlier && !run.reader.header().parent.empty()) {
    spdlog::warn("{}: it does not hold what came before it: what is marked begins with it",
                 run.path);
  }
  PlaybackDevice device(std::span(run.poses).subspan(first), run.rows[first].tick, run.pedal);
  std::optional<EndsItself> ends_itself;  // before the first tick there is nothing to keep
  session.begins = [&] { ends_itself.emplace(); };
  run_into(folder, *run.simulation, device, session, {});
  if (first + session.ticks < run.rows.size()) {
    say_error("sulcus: ended at tick %llu, after which rows were not recorded\n",
              static_cast<unsigned long long>(run.rows[first + session.ticks - 1].tick));
  }
}

}  // namespace

void add_replay_command(CLI::App& program) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = program.add_subcommand("replay", "Run a recording again, tick by tick");
  add_recording_argument(*command, options->recording);
  const auto [folder, force] =
      add_folder_options(*command, options->folder, options->force, "out/<recording>_replay");
  CLI::Option* const verify = command->add_flag(
      "--verify", options->verify, "Only compare every tick's forces and the volume, bit for bit");
  add_option(*command, "--from", options->from_s, "S",
             "Go on from this time of the recording, s; what "
             "comes is a recording of its own");
  CLI::Option* const set =
      add_set_option(*command, options->overrides, "Change a key of the scene from there on");
  CLI::Option* const pace = add_pace_option(*command, options->pace);
  for (CLI::Option* const unused : {folder, force, set, pace}) verify->excludes(unused);
  add_threads_option(*command, options->threads);
  command->callback([options] { replay(*options); });
}

}  // namespace sulcus
