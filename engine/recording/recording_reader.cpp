#include "engine/recording/recording_reader.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/hash.hpp"
#include "engine/recording/recording_parts.hpp"
#include "engine/recording/row_tables.hpp"

namespace sulcus {
namespace {

/// How often a block of metadata that a living writer is just changing is read again; the pauses
/// double from 1 ns, so that a damaged one costs about a millisecond with the system's own delays.
constexpr unsigned kReadAttempts = 16;

Hdf5Handle open_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw InputError(path, "", "no such file", "a recording");
  if (!fs::is_regular_file(status)) throw InputError(path, "", "no regular file", "a recording");
  const htri_t is_hdf5 = H5Fis_hdf5(path.c_str());
  if (is_hdf5 < 0) {
    throw InputError(path, "", "a file that cannot be opened (" + hdf5_reason() + ")",
                     "a recording");
  }
  if (is_hdf5 == 0) throw InputError(path, "", "no HDF5 file", "a recording");

  const auto access = hdf5_checked(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file");
  hdf5_check(H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST), "file");
  hdf5_check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "file");
  hdf5_check(H5Pset_metadata_read_attempts(access, kReadAttempts), "file");
  // HDF5 refuses a file that is shorter than it was meant to be; a disk that filled up or a copy
  // that broke off leaves such. What lies beyond its end then reads as zeros, which no check fits.
  // The property has no name in the public headers; h5clear sets it for the same reason.
  if (H5Pexist(access, "skip_eof_check") > 0) {
    const hbool_t skip = true;
    hdf5_check(H5Pset(access, "skip_eof_check", &skip), "file");
  }
  // The file of a killed writer opens in this mode only; one that was closed opens too.
  Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access), H5Fclose);
  if (file.valid()) return file;
  const std::string why = hdf5_reason();
  // A copy made by another program is of an older format of HDF5, which has no such mode.
  Hdf5Handle copy(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose);
  if (copy.valid()) return copy;
  throw InputError(path, "", "a damaged or unfinished HDF5 file (" + why + ")", "a recording");
}

std::string row_name(const char* table, std::uint64_t row) {
  return "row " + std::to_string(row) + " of /" + table;
}

}  // namespace

struct RecordingReader::File {
  std::string path;
  Hdf5Handle file;
  std::uint64_t bytes = 0;
  RecordingHeader header;
  std::vector<VoxelGrid> grids;  // of the bodies, the workpiece first
  std::vector<bool> filled;      // which of them carry fractions
  std::optional<StoredTable<TickRecord>> tick_table;
  std::optional<StoredTable<EditRow>> edit_table;
  std::optional<StoredTable<FillRow>> fill_table;  // where a body carries fractions
  std::optional<StoredTable<FillEndRow>> fill_end_table;
  std::optional<StoredTable<CuttingRecord>> cutting_table;  // where the recording cuts
  std::optional<StoredTable<PortRecord>> port_table;        // where it has a device or a coupling
  std::size_t ticks = 0;
  std::size_t edits = 0, fills = 0;
  std::uint64_t first_tick = 0, last_tick = 0;
  std::vector<StateHash> state_hashes;
  std::optional<StoredTable<std::byte>> keyframe_bytes;  // from version 2 on
  std::vector<KeyframeInfo> keyframes;
  std::vector<RecordingGap> gaps;
  bool has_pieces = false;
  std::vector<PieceRow> pieces;
  std::vector<PiecePoseRow> piece_poses;
  std::vector<TakenAnswerRow> taken_answers;
  bool has_pedal = false;
  std::vector<PedalRow> pedal;
  std::string damage;  // of what is there
  std::string missing;
  std::uint64_t announced_ticks = 0;  // that there are, or were when it was closed
  std::optional<std::string> summary;

  void open() {
    header = read_header(file, path, bytes);
    grids = read_grids(file);
    filled = read_which_are_filled(file);
    tick_table.emplace(file, bytes);
    edit_table.emplace(file, bytes);
    if (std::ranges::count(filled, true) > 0) {
      fill_table.emplace(file, bytes);
      fill_end_table.emplace(file, bytes);
    }
    if (H5Lexists(file, "cutting", H5P_DEFAULT) > 0) cutting_table.emplace(file, bytes);
    if (H5Lexists(file, "port", H5P_DEFAULT) > 0) port_table.emplace(file, bytes);
    const auto end = read_row<EndRow>(file);
    const std::string row_damage = scan_rows();
    std::string hash_damage = scan_state_hashes();
    if (header.version > 1) {
      keyframe_bytes.emplace(file, bytes, kKeyframeBytes);
      join(hash_damage, scan_keyframes());
    }
    has_pieces = H5Lexists(file, "pieces", H5P_DEFAULT) > 0;
    if (has_pieces) {
      join(hash_damage, scan_pieces(&PieceRow::tick, pieces));
      join(hash_damage, scan_pieces(&PiecePoseRow::tick, piece_poses));
      join(hash_damage, scan_pieces(&TakenAnswerRow::taken, taken_answers));
    }
    has_pedal = H5Lexists(file, "pedal", H5P_DEFAULT) > 0;
    if (has_pedal) join(hash_damage, scan_pedal());
    summary = read_summary();
    const bool closed = is_sealed(end);
    announced_ticks = closed ? end.ticks : tick_table->announced();
    damage = row_damage;
    join(damage, hash_damage);
    if (closed && damage.empty() && !is_whole(end)) damage = "rows are missing";
    missing = what_is_missing(end, row_damage, hash_damage);
  }

  bool is_whole(const EndRow& end) const {
    return end.ticks == ticks && end.edits == edits && end.state_hashes == state_hashes.size();
  }

  static void join(std::string& damages, const std::string& damage) {
    if (!damage.empty()) damages.append(damages.empty() ? "" : "; ").append(damage);
  }

  /// Rows of a table that has one for each tick.
  template <class Row>
  std::vector<Row> of_ticks(const StoredTable<Row>& table, std::size_t first,
                            std::size_t count) const {
    const std::size_t begin = std::min(first, ticks);
    auto rows = table.read(begin, std::min(count, ticks - begin));
    if (!std::ranges::all_of(rows, [](const Row& row) { return is_sealed(row); })) {
      throw Hdf5Error("a row changed since it was opened");
    }
    return rows;
  }

  /// Whether the next row is sound and of a tick.
  template <class Row>
  static bool follows(RowCursor<Row>& rows, std::uint64_t tick) {
    const Row* row = rows.next();
    return row && is_sealed(*row) && row->tick == tick;
  }

  template <class Row>
  static std::optional<RowCursor<Row>> cursor(const std::optional<StoredTable<Row>>& table) {
    return table ? std::optional<RowCursor<Row>>(*table) : std::nullopt;
  }

  /// The edits from number `at` to before `end`, which belong to the ticks from `first` to `last`,
  /// and rise. Says what is wrong with the first that does not.
  template <class Row, class Intact>
  static std::string scan_edits(RowCursor<Row>& rows, std::uint64_t first, std::uint64_t last,
                                std::uint64_t end, std::size_t& at, const Intact& intact) {
    for (; at < end; ++at) {
      const Row* edit = rows.next();
      if (!edit || !intact(*edit) || edit->tick < first || edit->tick > last) {
        return row_name(kRowTable<Row>.name, at) + " is damaged";
      }
      first = edit->tick;
    }
    return "";
  }

  /// Those that lowered a level, up to the end that the next row of /fill_ends names.
  std::string scan_fills(RowCursor<FillRow>& rows, RowCursor<FillEndRow>& ends, std::uint64_t first,
                         std::uint64_t last, std::size_t& at) const {
    const FillEndRow* end = ends.next();
    if (!end || !is_sealed(*end) || end->tick != last || end->fills_end < at) {
      return row_name("fill_ends", ticks) + " is damaged";
    }
    if (end->fills_end > fill_table->rows()) {
      return "fills of tick " + std::to_string(last) + " are missing";
    }
    return scan_edits(rows, first, last, end->fills_end, at,
                      [&](const FillRow& fill) { return is_intact(fill, grids, filled); });
  }

  /// Counts the ticks that can be trusted; says what is wrong with the one after them.
  std::string scan_rows() {
    RowCursor<TickRecord> tick_rows(*tick_table);
    RowCursor<EditRow> edit_rows(*edit_table);
    auto fill_rows = cursor(fill_table);
    auto fill_end_rows = cursor(fill_end_table);
    auto cutting_rows = cursor(cutting_table);
    auto port_rows = cursor(port_table);
    while (const TickRecord* row = tick_rows.next()) {
      if (!is_sealed(*row)) return row_name("ticks", ticks) + " is damaged";
      const bool gap = ticks > 0 && row->tick > last_tick + 1 && header.version > 1 &&
                       (row->faults & kFaultRowsDropped) != 0;
      if ((ticks > 0 && row->tick != last_tick + 1 && !gap) || row->edits_end < edits) {
        return row_name("ticks", ticks) + " does not follow on the one before it";
      }
      if (row->edits_end > edit_table->rows()) {
        return "edits of tick " + std::to_string(row->tick) + " are missing";
      }
      std::size_t end = edits, fill_end = fills;
      const std::uint64_t since = gap ? last_tick + 1 : row->tick;
      std::string damaged = scan_edits(edit_rows, since, row->tick, row->edits_end, end,
                                       [&](const EditRow& edit) { return is_intact(edit, grids); });
      if (damaged.empty() && fill_rows) {
        damaged = scan_fills(*fill_rows, *fill_end_rows, since, row->tick, fill_end);
      }
      if (!damaged.empty()) return damaged;
      if (cutting_rows && !follows(*cutting_rows, row->tick)) {
        return row_name("cutting", ticks) + " is damaged";
      }
      if (port_rows && !follows(*port_rows, row->tick)) {
        return row_name("port", ticks) + " is damaged";
      }
      edits = end;
      fills = fill_end;
      if (gap) gaps.push_back({last_tick + 1, row->tick});
      if (ticks == 0) first_tick = row->tick;
      last_tick = row->tick;
      ++ticks;
    }
    return ticks == tick_table->announced() ? "" : row_name("ticks", ticks) + " cannot be read";
  }

  /// Calls `take(row)` for the rows of a small table that belong to the ticks that can be trusted.
  /// `follows(row)`: whether one can stand behind those taken. Says what is wrong with the first
  /// that cannot, or cannot be read.
  template <class Row, class Follows, class Take>
  std::string scan_table(std::uint64_t Row::*tick, const Follows& follows, const Take& take) {
    const StoredTable<Row> table(file, bytes);
    const char* const name = kRowTable<Row>.name;
    RowCursor<Row> rows(table);
    std::uint64_t at = 0;
    for (; const Row* row = rows.next(); ++at) {
      if (!is_sealed(*row) || !follows(*row)) return row_name(name, at) + " is damaged";
      if (ticks == 0 || row->*tick > last_tick) return "";
      take(*row);
    }
    return at == table.announced() ? "" : row_name(name, at) + " cannot be read";
  }

  std::string scan_state_hashes() {
    return scan_table<StateHashRow>(
        &StateHashRow::tick,
        [&](const StateHashRow& row) {
          return state_hashes.empty() || row.tick > state_hashes.back().tick;
        },
        [&](const StateHashRow& row) {
          state_hashes.push_back({row.tick, row.volume, row.state});
        });
  }

  std::string scan_pedal() {
    return scan_table<PedalRow>(
        &PedalRow::tick,
        [&](const PedalRow& row) {
          return (pedal.empty() || row.tick > pedal.back().tick) && row.share >= 0.0 &&
                 row.share <= 1.0;
        },
        [&](const PedalRow& row) { pedal.push_back(row); });
  }

  /// Which states there are, as far as the rows go; whether their bytes are whole is seen when they
  /// are read.
  std::string scan_keyframes() {
    std::uint64_t end = 0;
    return scan_table<KeyframeRow>(
        &KeyframeRow::tick,
        [&](const KeyframeRow& row) {
          const bool rises =
              keyframes.empty() ? row.tick + 1 >= first_tick : row.tick > keyframes.back().tick;
          return rises && row.offset == end && row.bytes <= keyframe_bytes->rows();
        },
        [&](const KeyframeRow& row) {
          end += row.bytes;
          keyframes.push_back({row.tick, row.offset, row.bytes, row.content});
        });
  }

  /// Rows of a table of edits, `end` of which are of ticks that can be trusted.
  template <class Row, class Intact>
  std::vector<Edit> read_edits(const StoredTable<Row>& table, std::size_t end, std::size_t first,
                               std::size_t count, const Intact& intact) const {
    const std::size_t begin = std::min(first, end);
    const auto rows = table.read(begin, std::min(count, end - begin));
    std::vector<Edit> edits_read;
    edits_read.reserve(rows.size());
    for (const Row& row : rows) {
      if (!intact(row)) {
        throw Hdf5Error(std::string(kRowTable<Row>.name) + ": changed since it was opened");
      }
      edits_read.push_back(unpacked(row));
    }
    return edits_read;
  }

  template <class Row>
  std::string scan_pieces(std::uint64_t Row::*tick, std::vector<Row>& found) {
    return scan_table<Row>(
        tick, [&](const Row& row) { return found.empty() || row.*tick >= found.back().*tick; },
        [&](const Row& row) { found.push_back(row); });
  }

  std::optional<std::vector<std::byte>> keyframe(const KeyframeInfo& info) const {
    if (!keyframe_bytes || info.offset > keyframe_bytes->rows() ||
        info.bytes > keyframe_bytes->rows() - info.offset) {
      return {};
    }
    try {
      std::vector<std::byte> state = keyframe_bytes->read(info.offset, info.bytes);
      if (hash_bytes(state.data(), state.size()) == info.content) return state;
    } catch (const Hdf5Error&) {
      // As damaged as what reads but does not fit.
    }
    return {};
  }

  /// None where it was not written, is damaged, or before recordings had one.
  std::optional<std::string> read_summary() const {
    if (H5Lexists(file, "summary", H5P_DEFAULT) <= 0) return {};
    try {
      const auto check = read_row<SummaryCheckRow>(file);
      const StoredTable<std::byte> text(file, bytes, kSummaryBytes);
      if (check.bytes == 0 || !is_sealed(check) || check.bytes > text.rows()) return {};
      const std::vector<std::byte> read = text.read(0, check.bytes);
      if (hash_bytes(read.data(), read.size()) != check.content) return {};
      return std::string(reinterpret_cast<const char*>(read.data()), read.size());
    } catch (const Hdf5Error&) {
      return {};  // what the rows say stands without it
    }
  }

  std::string what_is_missing(const EndRow& end, const std::string& row_damage,
                              const std::string& hash_damage) const {
    const bool closed = is_sealed(end);
    if (closed && is_whole(end) && hash_damage.empty()) return "";
    std::string text = ticks == 0 ? "recording holds no tick"
                                  : "recording ends at tick " + std::to_string(last_tick);
    if (closed) text += " (" + std::to_string(ticks) + " of " + std::to_string(end.ticks) + ")";
    const char* separator = ": ";
    const std::string unclosed = closed ? "" : "it was not closed cleanly";
    for (const std::string& reason : {row_damage, hash_damage, unclosed}) {
      if (!reason.empty()) text.append(std::exchange(separator, "; ")).append(reason);
    }
    return text;
  }

  /// Runs `step`, and names the file where HDF5 fails.
  template <class Step>
  auto guarded(Step step) const {
    silence_hdf5();
    try {
      return step();
    } catch (const UnreadLayout& error) {
      throw InputError(path, "", std::string("a layout that is not read (") + error.what() + ")",
                       "a recording as it was written, or packed by gzip");
    } catch (const Hdf5Error& error) {
      throw InputError(path, "", std::string("a damaged recording (") + error.what() + ")",
                       "a whole one");
    }
  }
};

bool opens_without_swmr(const std::string& path) {
  silence_hdf5();
  return Hdf5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose).valid();
}

RecordingReader::RecordingReader(const std::string& path) : file_(std::make_unique<File>()) {
  file_->path = path;
  file_->guarded([&] {
    file_->file = open_file(path);
    std::error_code error;
    file_->bytes = std::filesystem::file_size(path, error);
    if (error) throw Hdf5Error("size: " + error.message());
    file_->open();
  });
}

RecordingReader::~RecordingReader() = default;
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;

const std::string& RecordingReader::path() const { return file_->path; }
const RecordingHeader& RecordingReader::header() const { return file_->header; }
const std::vector<VoxelGrid>& RecordingReader::grids() const { return file_->grids; }

bool RecordingReader::has_fills() const { return file_->fill_table.has_value(); }

std::vector<VoxelModel> RecordingReader::bodies() const {
  return file_->guarded([this] { return read_bodies(file_->file, file_->bytes); });
}

std::optional<VoxelModel> RecordingReader::goal() const {
  return file_->guarded([this] { return read_goal(file_->file, file_->bytes); });
}

std::optional<InputGeometry> RecordingReader::input() const {
  return file_->guarded([this] { return read_input(file_->file); });
}

std::optional<EarlierRun> RecordingReader::earlier() const {
  return file_->guarded([this] {
    return read_earlier(file_->file, read_model(file_->file, "workpiece", file_->bytes),
                        file_->grids, file_->filled, file_->bytes);
  });
}

VoxelModel RecordingReader::workpiece() const {
  return file_->guarded([this] { return read_model(file_->file, "workpiece", file_->bytes); });
}

std::optional<TriangleMesh> RecordingReader::burr_mesh() const {
  return file_->guarded([this] { return read_burr(file_->file, file_->bytes); });
}

RecordingTables RecordingReader::tables() const {
  return {file_->cutting_table.has_value(), file_->port_table.has_value(), file_->has_pieces,
          file_->has_pedal};
}

std::size_t RecordingReader::tick_count() const { return file_->ticks; }
std::size_t RecordingReader::edit_count() const { return file_->edits; }
std::size_t RecordingReader::fill_count() const { return file_->fills; }

std::vector<TickRecord> RecordingReader::ticks(std::size_t first, std::size_t count) const {
  return file_->guarded([&] { return file_->of_ticks(*file_->tick_table, first, count); });
}

std::vector<CuttingRecord> RecordingReader::cutting(std::size_t first, std::size_t count) const {
  if (!file_->cutting_table) return {};
  return file_->guarded([&] { return file_->of_ticks(*file_->cutting_table, first, count); });
}

std::vector<PortRecord> RecordingReader::port(std::size_t first, std::size_t count) const {
  if (!file_->port_table) return {};
  return file_->guarded([&] { return file_->of_ticks(*file_->port_table, first, count); });
}

std::vector<Edit> RecordingReader::edits(std::size_t first, std::size_t count) const {
  return file_->guarded([&] {
    return file_->read_edits(*file_->edit_table, file_->edits, first, count,
                             [&](const EditRow& row) { return is_intact(row, file_->grids); });
  });
}

std::vector<Edit> RecordingReader::fills(std::size_t first, std::size_t count) const {
  if (!file_->fill_table) return {};
  return file_->guarded([&] {
    return file_->read_edits(
        *file_->fill_table, file_->fills, first, count,
        [&](const FillRow& row) { return is_intact(row, file_->grids, file_->filled); });
  });
}

std::vector<FillEndRow> RecordingReader::fill_ends(std::size_t first, std::size_t count) const {
  if (!file_->fill_end_table) return {};
  return file_->guarded([&] { return file_->of_ticks(*file_->fill_end_table, first, count); });
}

const std::vector<StateHash>& RecordingReader::state_hashes() const { return file_->state_hashes; }
const std::vector<PieceRow>& RecordingReader::pieces() const { return file_->pieces; }
const std::vector<PiecePoseRow>& RecordingReader::piece_poses() const { return file_->piece_poses; }
const std::vector<PedalRow>& RecordingReader::pedal() const { return file_->pedal; }

const std::vector<TakenAnswerRow>& RecordingReader::taken_answers() const {
  return file_->taken_answers;
}
const std::vector<KeyframeInfo>& RecordingReader::keyframes() const { return file_->keyframes; }
const std::vector<RecordingGap>& RecordingReader::gaps() const { return file_->gaps; }

std::optional<std::vector<std::byte>> RecordingReader::keyframe(const KeyframeInfo& info) const {
  silence_hdf5();
  return file_->keyframe(info);
}

const std::string& RecordingReader::missing() const { return file_->missing; }
const std::string& RecordingReader::damage() const { return file_->damage; }
std::uint64_t RecordingReader::tick_rows() const { return file_->announced_ticks; }
const std::optional<std::string>& RecordingReader::summary() const { return file_->summary; }

}  // namespace sulcus
