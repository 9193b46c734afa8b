#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "app/commands/common_options.hpp"
#include "app/report/output_file.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/recording/recording_writer.hpp"

namespace sulcus {

namespace {

constexpr std::size_t kRowsAtOnce = 4096;

/// What a recording lacks, states whose bytes are damaged among it; empty where nothing does.
std::string what_is_missing(const RecordingReader& reader) {
  const auto damaged =
      std::ranges::count_if(reader.keyframes(), [&](const auto& k) { return !reader.keyframe(k); });
  std::string missing = reader.missing();
  if (damaged == 0) return missing;
  return missing.append(missing.empty() ? "" : "; ") + std::to_string(damaged) + " of " +
         std::to_string(reader.keyframes().size()) + " states in /keyframes are damaged";
}

/// Whatever a recording still holds, written anew.
void copy_recording(const RecordingReader& reader, const std::string& missing,
                    const std::string& file) {
  RecordingHeader header = reader.header();
  if (!missing.empty()) header.repaired = missing;
  const VoxelModel start = reader.workpiece();
  const std::vector<VoxelModel> bodies = reader.bodies();
  const std::optional<VoxelModel> goal = reader.goal();
  const std::optional<TriangleMesh> burr = reader.burr_mesh();
  const std::optional<InputGeometry> input = reader.input();
  const std::optional<EarlierRun> earlier = reader.earlier();
  RecordedSolids others{
      {}, goal ? &*goal : nullptr, input ? &*input : nullptr, earlier ? &*earlier : nullptr};
  for (const VoxelModel& body : bodies) others.bodies.push_back(&body);
  const RecordingTables tables = reader.tables();
  RecordingWriter writer(file, header, start, burr ? &*burr : nullptr, tables, others);

  Progress progress("copying");
  std::size_t edits = 0, fills = 0;
  for (std::size_t first = 0; first < reader.tick_count(); first += kRowsAtOnce) {
    const std::vector<TickRecord> rows = reader.ticks(first, kRowsAtOnce);
    const auto end = static_cast<std::size_t>(rows.back().edits_end);
    writer.append_edits(reader.edits(edits, end - edits));
    edits = end;
    if (reader.has_fills()) {
      const std::vector<FillEndRow> ends = reader.fill_ends(first, kRowsAtOnce);
      const auto fill_end = static_cast<std::size_t>(ends.back().fills_end);
      writer.append_edits(reader.fills(fills, fill_end - fills));
      writer.append_fill_ends(ends);
      fills = fill_end;
    }
    if (tables.cutting) writer.append_cutting(reader.cutting(first, kRowsAtOnce));
    if (tables.port) writer.append_port(reader.port(first, kRowsAtOnce));
    writer.append_ticks(rows);
    writer.flush();
    progress.at(first, reader.tick_count());
  }
  if (tables.pieces) {
    for (const PieceRow& row : reader.pieces()) writer.append_piece(row);
    for (const PiecePoseRow& row : reader.piece_poses()) writer.append_piece_pose(row);
    for (const TakenAnswerRow& row : reader.taken_answers()) writer.append_taken_answer(row);
  }
  for (const PedalRow& row : reader.pedal()) writer.append_pedal(row);
  for (const StateHash& hash : reader.state_hashes()) writer.append_state_hash(hash);
  for (const KeyframeInfo& info : reader.keyframes()) {
    if (const auto state = reader.keyframe(info)) writer.append_keyframe(info.tick, *state);
  }
  if (reader.summary()) writer.append_summary(*reader.summary());
  writer.close();
}

void repair(const std::string& recording, const std::string& file) {
  namespace fs = std::filesystem;
  if (file.empty()) throw InputError("", "-o", "no name", "a new file, .h5");
  check_output("-o", file, {".h5", ".hdf5"});
  const RecordingReader reader(recording);
  std::error_code error;
  if (fs::equivalent(recording, file, error)) {
    throw InputError(file, "-o", "the recording itself", "another file");
  }
  if (fs::exists(file)) throw InputError(file, "-o", "a file that already exists", "a new name");
  const std::string missing = what_is_missing(reader);
  WholeFile copy(file);
  try {
    copy_recording(reader, missing, copy.beside());
  } catch (const InputError&) {  // of the recording that is read
    throw;
  } catch (const std::runtime_error& failed) {
    copy.fail_incomplete(failed.what());
  }
  copy.finish();
  if (missing.empty()) {
    say("%s: nothing was missing\n", recording.c_str());
  } else {
    say("%s: %s\n", recording.c_str(), missing.c_str());
  }
  say("%s: %zu ticks, %zu removed voxels\n", file.c_str(), reader.tick_count(),
      reader.edit_count());
}

}  // namespace

void add_repair_command(CLI::App& program) {
  auto recording = std::make_shared<std::string>(), file = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand(
      "repair", "Write a clean copy of a recording that was not closed or is damaged");
  add_recording_argument(*command, *recording);
  add_option(*command, "-o", *file, "FILE", "New file, .h5")->required();
  command->callback([recording, file] { repair(*recording, *file); });
}

}  // namespace sulcus
