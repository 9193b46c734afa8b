#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>

#include "app/build_info.hpp"
#include "app/commands.hpp"
#include "app/recorded_run.hpp"
#include "app/results.hpp"
#include "engine/core/hash.hpp"
#include "engine/core/realtime.hpp"

namespace sulcus {

namespace {

struct ReplayOptions {
  std::string recording, folder;
  bool verify = false;
};

/// Name of the first quantity in which two rows of the same tick differ; null: equal bit for bit.
/// Times and the position in the file are no results.
const char* difference(const TickRecord& a, const TickRecord& b) {
  const auto differs = [](const auto& x, const auto& y) {
    return std::memcmp(&x, &y, sizeof(x)) != 0;
  };
  if (a.tick != b.tick) return "tick";
  if (differs(a.time_s, b.time_s)) return "time_s";
  if (differs(a.tool_position_m, b.tool_position_m)) return "tool_position_m";
  if (differs(a.tool_orientation, b.tool_orientation)) return "tool_orientation";
  if (a.contacts != b.contacts) return "contacts";
  if (a.tested != b.tested) return "tested";
  if (a.leaves != b.leaves) return "leaves";
  if (differs(a.contact_force_N, b.contact_force_N)) return "contact_force_N";
  if (differs(a.contact_torque_Nm, b.contact_torque_Nm)) return "contact_torque_Nm";
  if (differs(a.force_N, b.force_N)) return "force_N";
  if (differs(a.torque_Nm, b.torque_Nm)) return "torque_Nm";
  if (a.removed != b.removed) return "removed";
  if ((a.faults ^ b.faults) & ~std::uint64_t{kFaultRowsDropped}) return "faults";
  return nullptr;
}

bool same_edit(const Edit& a, const Edit& b) {
  return a.tick == b.tick && a.voxel == b.voxel && a.body == b.body && a.cause == b.cause;
}

/// Runs every tick again and compares; the exception says where they part.
void verify(const RecordedRun& run) {
  Simulation& simulation = *run.simulation;
  PlaybackDevice device(run.poses);
  const auto fail = [&](std::uint64_t tick, const std::string& quantity) {
    const std::string recorded = run.reader.header().build;
    throw std::runtime_error(
        run.path + ": tick " + std::to_string(tick) + " differs in " + quantity +
        (recorded == build_info() ? "" : " (recorded by another build, " + recorded + ")"));
  };
  const std::vector<TickRecord> rows = run.reader.ticks();
  const std::vector<Edit> edits = run.reader.edits();
  const std::vector<StateHash>& hashes = run.reader.state_hashes();
  if (simulation.workpiece().hash_with_tissues() != run.reader.header().workpiece_hash) {
    throw std::runtime_error(run.path + ": the workpiece at the start differs from what was run");
  }
  std::optional<LooseFinder> finder;
  if (simulation.scene().loose_pieces) finder.emplace(simulation.workpiece().model());
  LooseSchedule loose(run.taken_answers);
  std::deque<LooseAnswer> answers;
  const auto next_answer = [&](LooseAnswer& answer) {
    if (answers.empty()) return false;
    answer = std::move(answers.front());
    answers.pop_front();
    return true;
  };
  std::size_t edit = 0, hash = 0;
  for (const TickRecord& row : rows) {
    const auto leaving =
        finder ? loose.before_tick(row.tick, next_answer) : std::span<const std::uint32_t>{};
    const TickRecord again = simulation.step(device, leaving);
    if (finder) {
      auto found = finder->add_tick(row.tick, simulation.edits());
      if (found) answers.push_back(std::move(*found));
    }
    if (const char* quantity = difference(row, again)) fail(row.tick, quantity);
    for (const Edit& e : simulation.edits()) {
      if (edit >= edits.size() || !same_edit(e, edits[edit])) fail(row.tick, "the voxels removed");
      ++edit;
    }
    if (edit != row.edits_end) fail(row.tick, "the voxels removed");
    if (hash < hashes.size() && hashes[hash].tick == row.tick) {
      if (hashes[hash].volume != simulation.workpiece().hash()) fail(row.tick, "the volume");
      if (hashes[hash].state != simulation.state().hash()) fail(row.tick, "the state");
      ++hash;
    }
  }
  std::printf(
      "%s: %zu ticks, %zu removed voxels and %zu state hashes agree bit for bit; "
      "volume %s\n",
      run.path.c_str(), rows.size(), edits.size(), hash,
      hex(simulation.workpiece().hash()).c_str());
}

void replay(const ReplayOptions& options) {
  RecordedRun run = open_recorded_run(options.recording);
  if (!run.reader.missing().empty()) {
    std::fprintf(stderr, "sulcus: %s\n", run.reader.missing().c_str());
  }
  if (options.verify) {
    verify(run);
    return;
  }
  SessionOptions session;
  session.folder =
      options.folder.empty()
          ? "out/" + std::filesystem::path(options.recording).stem().string() + "_replay"
          : options.folder;
  session.ticks = run.poses.size();
  session.played_back = run.taken_answers;
  session.goal = run.reader.goal();
  open_log(session.folder);
  PlaybackDevice device(run.poses);
  const SessionResult result = run_session(*run.simulation, device, session);
  write_results(*run.simulation, result, session, {});
}

}  // namespace

void add_replay_command(CLI::App& program) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = program.add_subcommand("replay", "Run a recording again, tick by tick");
  command->add_option("RECORDING", options->recording, "Recording, .h5")->required();
  command->add_option("-o", options->folder, "Folder for the results (out/<recording>_replay)");
  command->add_flag("--verify", options->verify,
                    "Only compare every tick's forces and the volume, bit for bit");
  command->callback([options] { replay(*options); });
}

}  // namespace sulcus
