#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/hash.hpp"
#include "engine/recording/recording_format.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/recording/recording_writer.hpp"
#include "engine/scene/scene_file.hpp"
#include "tools/fuzz/fuzz_targets.hpp"
#include "tools/fuzz/handed_file.hpp"

// The first byte tells what the others are:
//
//   f   the file itself
//   h   the scene that a sound recording carries
//   any other: changes of a sound recording, five bytes each: kind, table, at (u16), value
//         kind % 3 = 0   the byte `table * 2^16 + at` of the file ^= value
//                    1   the byte `at` of a table's rows ^= value, and the row is sealed again
//                    2   the file ends at byte `table * 2^16 + at`
//
// HDF5 puts checksums on its own structure, so that plain changes seldom come further than it;
// those of rows that are sealed again all come to our checks.

namespace sulcus::fuzz {
namespace {

using File = std::vector<std::uint8_t>;

constexpr std::uint64_t kTicks = 40;

const std::string kScene =
    "[workpiece]\nshape = 'box'\ncells = [16, 16, 16]\nbox.size_mm = [0.4, 0.4, 0.4]\n"
    "[[body]]\nshape = 'box'\ncells = [8, 8, 8]\n"
    "[trajectory]\npoints_mm = [[0, 0, 1]]\n[cutting]\n[loose_pieces]\n[record]\n";

VoxelModel solid(int cells, bool labelled) {
  VoxelModel model;
  model.grid.cells = {cells, cells, cells};
  model.grid.voxel_m = 34.8e-6;
  model.leaves.resize(model.grid.leaf_count());
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < i; ++j) model.set({i, j, (i + j) % cells}, true);
  }
  if (!labelled) return model;
  std::vector<LeafLevels> pages;  // of one leaf: the others are full
  pages.push_back({.leaf = 0});
  for_each_voxel(model.leaves[0], [&](int place) {
    pages[0].levels[static_cast<std::size_t>(place)] = static_cast<FillLevel>(1 + place % 255);
  });
  model.fills.emplace(model.grid.leaf_count(), std::move(pages));
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  LabelBlock labels{};
  for (std::size_t v = 0; v < labels.size(); ++v) labels[v] = v % 3 == 0 ? 1 : 0;
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); leaf += 2) {
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = tissues;
  return model;
}

/// The rows of one data set as they lie in the file.
struct StoredRows {
  std::size_t first = 0, row_bytes = 0, rows = 0, check_bytes = 8;
};

struct SoundRecording {
  File bytes;
  std::vector<StoredRows> tables;
};

RecordingHeader header_of(const std::string& scene) {
  RecordingHeader header;
  header.scene_toml = scene;
  header.scene_sha256 = std::string(64, 'a');
  header.build = "fuzzed build";
  header.rate_hz = 1000.0;
  header.workpiece_hash = 0x0123456789abcdefu;
  return header;
}

template <class Row>
StoredRows find_rows(const File& file, const std::vector<Row>& rows, std::size_t check_bytes = 8) {
  const auto* raw = reinterpret_cast<const std::uint8_t*>(rows.data());
  const auto at = std::search(file.begin(), file.end(), raw, raw + sizeof(Row) * rows.size());
  expect(at != file.end(), "rows that are not in the file");
  return {static_cast<std::size_t>(at - file.begin()), sizeof(Row), rows.size(), check_bytes};
}

/// Every data set that a recording may have, and a few rows in each.
SoundRecording write_sound() {
  const HandedFile place({}, "sound.h5");
  const VoxelModel start = solid(16, true), body = solid(8, false), goal = solid(16, false);
  const TriangleMesh burr{{{0, 0, 0}, {1e-3f, 0, 0}, {0, 1e-3f, 0}, {0, 0, 1e-3f}},
                          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  std::vector<TickRecord> ticks(kTicks);
  std::vector<EditRow> edits;
  std::vector<FillRow> fills;
  std::vector<FillEndRow> fill_ends(kTicks);
  std::vector<CuttingRecord> cutting(kTicks);
  std::vector<PortRecord> port(kTicks);
  EarlierRun earlier{"first.h5",
                     std::string(64, 'a'),
                     start,
                     {{0, 0, 0, EditCause::kCut, 100}, {0, 0, 0, EditCause::kCut}},
                     {}};
  earlier.start.set_level({0, 0, 0}, 200);
  RecordingWriter writer(place.path(), header_of(kScene), start, &burr,
                         {.cutting = true, .port = true, .pieces = true, .pedal = true},
                         {{&body}, &goal, nullptr, &earlier});
  for (std::uint64_t t = 1; t <= kTicks; ++t) {
    const std::uint64_t row = t - 1;
    const EditCause cause = t % 5 == 0 ? EditCause::kLoose : EditCause::kCut;
    const Edit edit{t, static_cast<std::uint32_t>(t), 0, cause};
    if (t % 2 == 1) {
      writer.append_edits({&edit, 1});
      edits.push_back(packed(edit));
    }
    if (t % 3 == 1) {
      const Edit lowered{t, static_cast<std::uint32_t>(t), 0, EditCause::kCut,
                         static_cast<FillLevel>(250 - t)};
      writer.append_edits({&lowered, 1});
      fills.push_back(packed_fill(lowered));
    }
    fill_ends[row] = sealed(FillEndRow{t, fills.size(), 0});
    ticks[row].tick = cutting[row].tick = port[row].tick = t;
    ticks[row].time_s = 1e-3 * static_cast<double>(t);
    ticks[row].edits_end = edits.size();
    seal(ticks[row]);
    seal(cutting[row]);
    seal(port[row]);
  }
  writer.append_ticks(ticks);
  writer.append_fill_ends(fill_ends);
  writer.append_cutting(cutting);
  writer.append_port(port);
  std::vector<PieceRow> pieces(1);
  std::vector<PiecePoseRow> poses(1);
  std::vector<TakenAnswerRow> answers(1);
  pieces[0] = {0, 15, 0, 2, 0};
  poses[0].tick = 20;
  answers[0] = {5, 7, 0};
  seal(pieces[0]);
  seal(poses[0]);
  seal(answers[0]);
  writer.append_piece(pieces[0]);
  writer.append_piece_pose(poses[0]);
  writer.append_taken_answer(answers[0]);
  std::vector<KeyframeRow> keyframes;
  for (const std::uint64_t t : {10u, 30u}) {
    const std::vector<std::byte> state(5 * t, std::byte{static_cast<unsigned char>(t)});
    writer.append_keyframe(t, state);
    const std::uint64_t offset = keyframes.empty() ? 0 : keyframes.back().bytes;
    keyframes.push_back({t, offset, state.size(), hash_bytes(state.data(), state.size()), 0});
    seal(keyframes.back());
  }
  std::vector<StateHashRow> hashes;
  for (const std::uint64_t t : {10u, 20u}) {
    writer.append_state_hash({t, t * 7919, t * 104729});
    hashes.push_back({t, t * 7919, t * 104729, 0});
    seal(hashes.back());
  }
  const std::string summary = "{\"scene\": \"fuzzed\"}";
  writer.append_summary(summary);
  std::vector<SummaryCheckRow> told{
      {summary.size(), hash_bytes(summary.data(), summary.size()), 0}};
  seal(told[0]);
  writer.close();
  std::vector<EndRow> end{{kTicks, edits.size(), hashes.size(), 0}};
  seal(end[0]);

  std::ifstream in(place.path(), std::ios::binary);
  SoundRecording sound;
  sound.bytes.assign(std::istreambuf_iterator<char>(in), {});
  sound.tables = {find_rows(sound.bytes, ticks),    find_rows(sound.bytes, edits, 4),
                  find_rows(sound.bytes, cutting),  find_rows(sound.bytes, port),
                  find_rows(sound.bytes, pieces),   find_rows(sound.bytes, poses),
                  find_rows(sound.bytes, answers),  find_rows(sound.bytes, hashes),
                  find_rows(sound.bytes, end),      find_rows(sound.bytes, keyframes),
                  find_rows(sound.bytes, told),     find_rows(sound.bytes, fills, 4),
                  find_rows(sound.bytes, fill_ends)};
  return sound;
}

const SoundRecording& sound_recording() {
  static const SoundRecording sound = write_sound();
  return sound;
}

void change_row(File& file, const StoredRows& table, std::size_t at, std::uint8_t value) {
  at %= table.row_bytes * table.rows;
  const std::size_t row = table.first + at / table.row_bytes * table.row_bytes;
  if (row + table.row_bytes > file.size()) return;  // the file was cut off
  file[table.first + at] ^= value;
  const std::size_t sealed = table.row_bytes - table.check_bytes;
  const std::uint64_t check = hash_bytes(file.data() + row, sealed);  // its low half comes first
  std::memcpy(file.data() + row + sealed, &check, table.check_bytes);
}

File changed(Bytes changes) {
  const SoundRecording& sound = sound_recording();
  File file = sound.bytes;
  for (; changes.size() >= 5; changes = changes.subspan(5)) {
    const std::size_t at = changes[2] + std::size_t{256} * changes[3];
    const std::size_t far = at + std::size_t{65536} * changes[1];
    switch (changes[0] % 3) {
      case 0:
        if (!file.empty()) file[far % file.size()] ^= changes[4];
        break;
      case 1:
        change_row(file, sound.tables[changes[1] % sound.tables.size()], at, changes[4]);
        break;
      default:
        file.resize(std::min(far, file.size()));
    }
  }
  return file;
}

void read_all(const std::string& path) {
  const RecordingReader reader(path);
  const std::vector<TickRecord> ticks = reader.ticks();
  const std::vector<Edit> edits = reader.edits();
  expect(ticks.size() == reader.tick_count() && edits.size() == reader.edit_count(),
         "other rows than were counted");
  for (std::size_t row = 0; row < ticks.size(); ++row) {
    expect(row == 0 || ticks[row].tick > ticks[row - 1].tick, "ticks that do not rise");
    expect(ticks[row].edits_end <= edits.size(), "edits of a tick that are not there");
  }
  for (const Edit& edit : edits) {
    expect(edit.body < reader.grids().size() && edit.voxel < reader.grids()[edit.body].cell_count(),
           "an edit outside of its body");
  }
  const std::vector<Edit> fills = reader.fills();
  const std::vector<FillEndRow> fill_ends = reader.fill_ends();
  expect(fill_ends.size() == (reader.has_fills() ? ticks.size() : 0), "ticks without fills");
  expect(fills.size() == reader.fill_count() &&
             (fill_ends.empty() ? fills.empty() : fill_ends.back().fills_end == fills.size()),
         "other fills than were counted");
  for (const Edit& fill : fills) {
    expect(fill.body < reader.grids().size() &&
               fill.voxel < reader.grids()[fill.body].cell_count() && fill.level > 0 &&
               fill.level < kFullLevel,
           "a level that there is not");
  }
  for (const KeyframeInfo& keyframe : reader.keyframes()) {
    const auto state = reader.keyframe(keyframe);
    expect(!state || state->size() == keyframe.bytes, "a state of another length");
  }
  for (const RecordingGap& gap : reader.gaps()) expect(gap.first < gap.end, "a gap of no tick");
  (void)reader.cutting();
  (void)reader.port();
  reads([&] { (void)reader.workpiece(); });
  reads([&] { (void)reader.bodies(); });
  reads([&] { (void)reader.goal(); });
  reads([&] { (void)reader.input(); });
  reads([&] { (void)reader.earlier(); });
  reads([&] { (void)reader.burr_mesh(); });
  reads([&] { (void)parse_scene(reader.header().scene_toml, path); });
}

}  // namespace

void fuzz_recording(Bytes bytes) {
  if (bytes.empty()) return;
  const Bytes rest = bytes.subspan(1);
  if (bytes[0] == 'h') {
    const HandedFile file({}, "headed.h5");
    const VoxelModel start = solid(8, false);
    RecordingWriter(file.path(), header_of(std::string(rest.begin(), rest.end())), start, nullptr)
        .close();
    reads([&] { read_all(file.path()); });
    return;
  }
  const File contents = bytes[0] == 'f' ? File(rest.begin(), rest.end()) : changed(rest);
  const HandedFile file(contents, "fuzzed.h5");
  reads([&] { read_all(file.path()); });
}

}  // namespace sulcus::fuzz
