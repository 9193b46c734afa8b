#include "engine/recording/recording_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/hash.hpp"
#include "engine/core/stop.hpp"
#include "engine/recording/recording_parts.hpp"
#include "engine/recording/row_tables.hpp"

namespace sulcus {
namespace {

// Beyond these a caller who does not flush is helped: memory stays bounded.
constexpr std::size_t kMetadataBytes = 1 << 19;  // of HDF5's, in memory
constexpr std::size_t kMaxWaitingTicks = 4096;
constexpr std::size_t kMaxWaitingEdits = 1 << 16;
constexpr std::size_t kMaxWaitingStateBytes = 1 << 24;

/// `path` must not name anything but a regular file: HDF5 would write into a device.
void check_path(const std::string& path) {
  namespace fs = std::filesystem;
  if (path.empty()) {
    throw InputError(path, "", "a path that cannot be written (empty)", "a file to record into");
  }
  std::error_code ignored;  // what cannot be looked at cannot be created either, and that says why
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) throw InputError(path, "", "a folder", "a file to record into");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw InputError(path, "", "no regular file", "a file to record into");
  }
}

/// Under another name, until others may read it: what bears the name of a recording is one, however
/// early its writer is killed, and an earlier one stays until then.
std::string part_name(const std::string& path) { return path + ".part"; }

void remove_part(const std::string& path) {
  std::error_code ignored;  // it is said what went wrong
  std::filesystem::remove(part_name(path), ignored);
  keep_when_stopped(part_name(path));
}

Hdf5Handle create_file(const std::string& path) {
  check_path(path);
  const auto access = hdf5_checked(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file");
  hdf5_check(H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST), "file");
  hdf5_check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "file");
  // Of its indices of chunks HDF5 would keep up to 32 MiB, and take them little by little as a run
  // gets longer; only their ends are written to.
  H5AC_cache_config_t cache{};
  cache.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  hdf5_check(H5Pget_mdc_config(access, &cache), "file");
  cache.initial_size = cache.min_size = cache.max_size = kMetadataBytes;
  hdf5_check(H5Pset_mdc_config(access, &cache), "file");
  remove_when_stopped(part_name(path));
  Hdf5Handle file(H5Fcreate(part_name(path).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  if (!file.valid()) {
    keep_when_stopped(part_name(path));
    const std::string why = hdf5_reason();
    for (const int full : {ENOSPC, EDQUOT}) {
      if (why == std::strerror(full))
        throw std::runtime_error(path + ": cannot be written: " + why);
    }
    throw InputError(path, "", "a path that cannot be written (" + why + ")",
                     "a file to record into");
  }
  return file;
}

}  // namespace

struct RecordingWriter::File {
  std::string path;
  Hdf5Handle file;
  std::optional<GrowingTable<EditRow>> edits;
  std::optional<GrowingTable<TickRecord>> ticks;
  std::optional<GrowingTable<FillRow>> fills;  // where a body carries fractions
  std::optional<GrowingTable<FillEndRow>> fill_ends;
  std::optional<GrowingTable<CuttingRecord>> cutting;  // with RecordingTables::cutting
  std::optional<GrowingTable<PortRecord>> port;        // with RecordingTables::port
  std::optional<GrowingTable<StateHashRow>> state_hashes;
  std::optional<GrowingTable<std::byte>> keyframes;
  std::optional<GrowingTable<KeyframeRow>> keyframe_index;
  // With RecordingTables::pieces.
  std::optional<GrowingTable<PieceRow>> pieces;
  std::optional<GrowingTable<PiecePoseRow>> piece_poses;
  std::optional<GrowingTable<TakenAnswerRow>> taken_answers;
  std::optional<GrowingTable<PedalRow>> pedal;  // with RecordingTables::pedal
  std::optional<GrowingTable<std::byte>> summary;
  Hdf5Handle summary_check, end;
  bool named = false;
  std::string failure;  // of the first call that failed

  void create(const RecordingHeader& any_version, const VoxelModel& start,
              const TriangleMesh* burr_mesh_tool, RecordingTables tables,
              const RecordedSolids& others) {
    RecordingHeader header = any_version;
    header.version = kRecordingVersion;
    write_header(file, header);
    write_model(file, "workpiece", start);
    write_bodies(file, others.bodies);
    if (others.goal) write_model(file, "goal", *others.goal);
    if (others.input) write_input(file, *others.input);
    if (others.earlier) write_earlier(file, *others.earlier);
    if (burr_mesh_tool) write_burr(file, *burr_mesh_tool);
    edits.emplace(file);
    ticks.emplace(file);
    const auto is_filled = [](const VoxelModel* body) { return body->fills.has_value(); };
    if (is_filled(&start) || std::ranges::any_of(others.bodies, is_filled)) {
      fills.emplace(file);
      fill_ends.emplace(file);
    }
    if (tables.cutting) cutting.emplace(file);
    if (tables.port) port.emplace(file);
    if (tables.pieces) {
      pieces.emplace(file);
      piece_poses.emplace(file);
      taken_answers.emplace(file);
    }
    if (tables.pedal) pedal.emplace(file);
    state_hashes.emplace(file);
    keyframes.emplace(file, kKeyframeBytes);
    keyframe_index.emplace(file);
    summary.emplace(file, kSummaryBytes);
    summary_check = create_row<SummaryCheckRow>(file);
    end = create_row<EndRow>(file);
    hdf5_check(H5Fstart_swmr_write(file), "start of recording");
  }

  void take_name() {
    std::error_code error;
    std::filesystem::rename(part_name(path), path, error);
    if (error) throw Hdf5Error("start of recording: " + error.message());
    keep_when_stopped(part_name(path));
    named = true;
  }

  void flush() {
    if (!named) take_name();
    edits->flush();
    if (fills) fills->flush();
    if (pieces) {
      // Answers before the ticks that took them. News of pieces come from another thread, sooner or
      // later than their ticks: readers go by the numbers in the rows.
      taken_answers->flush();
      pieces->flush();
      piece_poses->flush();
    }
    if (pedal) pedal->flush();
    std::size_t most = ticks->waiting();
    const auto wait_for_rows_of_ticks = [&](const auto& table) {
      most = std::min<std::size_t>(most, table.written() - ticks->written());
    };
    const auto flush_rows_of_ticks = [&](auto& table) {
      if (!table) return;
      table->flush();
      wait_for_rows_of_ticks(*table);
    };
    flush_rows_of_ticks(cutting);
    flush_rows_of_ticks(port);
    if (fill_ends) {
      flush_ready(*fill_ends, fill_ends->waiting(), &FillEndRow::fills_end, fills->written());
      wait_for_rows_of_ticks(*fill_ends);
    }
    flush_ready(*ticks, most, &TickRecord::edits_end, edits->written());
    state_hashes->flush();
    keyframes->flush();
    keyframe_index->flush();
  }

  /// Flushes the rows, at most `most`, whose edits are all written.
  template <class Row>
  static void flush_ready(GrowingTable<Row>& table, std::size_t most, std::uint64_t Row::*end,
                          std::uint64_t written) {
    std::size_t ready = 0;
    while (ready < most && table.waiting_row(ready).*end <= written) ++ready;
    table.flush(ready);
  }

  void close() {
    flush();
    if (ticks->waiting() > 0) {
      throw std::runtime_error(path + ": ticks: " + std::to_string(ticks->waiting()) +
                               " rows name edits that were never given");
    }
    write_row(end, EndRow{ticks->written(), edits->written(), state_hashes->written(), 0});
    // What can fail for want of room fails here, where the file can still be left as it is.
    hdf5_check(H5Fflush(file, H5F_SCOPE_GLOBAL), "close");
    for_each_table([](auto& table) { table.reset(); });
    summary_check.close();
    end.close();
    if (!file.close()) throw Hdf5Error("close: " + hdf5_reason());
  }

  /// After a failure HDF5 is not asked anything more about this file: it could not close it, and
  /// crashes at exit over what it then frees twice. The file stays as a killed process leaves it.
  void release() {
    for_each_table([](auto& table) {
      if (table) table->release();
    });
    summary_check.release();
    end.release();
    file.release();
  }

  template <class Visit>
  void for_each_table(const Visit& visit) {
    const auto visit_all = [&](auto&... tables) { (visit(tables), ...); };
    visit_all(edits, ticks, fills, fill_ends, cutting, port, pieces, piece_poses, taken_answers,
              pedal, state_hashes, keyframes, keyframe_index, summary);
  }

  /// Runs `step`; the first failure is kept and thrown again by every later call.
  template <class Step>
  void guarded(Step step) {
    if (!failure.empty()) throw std::runtime_error(failure);
    silence_hdf5();
    try {
      if (!file.valid()) throw Hdf5Error("the recording is closed");
      step();
    } catch (const Hdf5Error& error) {
      failure = path + ": " + error.what();
      release();
      throw std::runtime_error(failure);
    }
  }
};

RecordingWriter::RecordingWriter(const std::string& path, const RecordingHeader& header,
                                 const VoxelModel& start, const TriangleMesh* burr_mesh_tool,
                                 RecordingTables tables, const RecordedSolids& others)
    : file_(std::make_unique<File>()) {
  silence_hdf5();
  file_->path = path;
  file_->file = create_file(path);
  try {
    file_->guarded([&] { file_->create(header, start, burr_mesh_tool, tables, others); });
  } catch (const std::runtime_error&) {
    remove_part(path);
    throw;
  }
}

RecordingWriter::RecordingWriter(RecordingWriter&&) noexcept = default;

RecordingWriter::~RecordingWriter() {
  if (!file_ || !file_->file.valid()) return;
  if (!file_->named && file_->ticks->waiting() == 0) {  // the run never began
    remove_part(file_->path);
    return;
  }
  try {
    file_->guarded([this] { file_->flush(); });
  } catch (const std::exception&) {
    // Nobody is left to tell; the reader says where the recording ends.
  }
}

void RecordingWriter::append_edits(std::span<const Edit> edits) {
  file_->guarded([&] {
    for (const Edit& edit : edits) {
      if (edit.is_gone()) {
        file_->edits->add(packed(edit));
      } else if (file_->fills) {
        file_->fills->add(packed_fill(edit));
      } else {
        throw std::logic_error("/fills: not in this recording");
      }
    }
    if (file_->edits->waiting() > kMaxWaitingEdits) file_->edits->flush();
    if (has_fills() && file_->fills->waiting() > kMaxWaitingEdits) file_->fills->flush();
  });
}

void RecordingWriter::append_ticks(std::span<const TickRecord> ticks) {
  file_->guarded([&] {
    file_->ticks->add(ticks);
    if (file_->ticks->waiting() > kMaxWaitingTicks) file_->flush();
  });
}

bool RecordingWriter::has_fills() const { return file_->fills.has_value(); }

void RecordingWriter::append_fill_ends(std::span<const FillEndRow> rows) {
  file_->guarded([&] {
    if (!file_->fill_ends) throw std::logic_error("/fill_ends: not in this recording");
    file_->fill_ends->add(rows);
  });
}

bool RecordingWriter::has_cutting() const { return file_->cutting.has_value(); }

void RecordingWriter::append_cutting(std::span<const CuttingRecord> rows) {
  file_->guarded([&] {
    if (!file_->cutting) throw Hdf5Error("/cutting: not in this recording");
    file_->cutting->add(rows);
  });
}

bool RecordingWriter::has_port() const { return file_->port.has_value(); }

void RecordingWriter::append_port(std::span<const PortRecord> rows) {
  file_->guarded([&] {
    if (!file_->port) throw Hdf5Error("/port: not in this recording");
    file_->port->add(rows);
  });
}

void RecordingWriter::append_piece(const PieceRow& row) {
  file_->guarded([&] { file_->pieces.value().add(row); });
}

void RecordingWriter::append_piece_pose(const PiecePoseRow& row) {
  file_->guarded([&] { file_->piece_poses.value().add(row); });
}

void RecordingWriter::append_taken_answer(const TakenAnswerRow& row) {
  file_->guarded([&] { file_->taken_answers.value().add(row); });
}

bool RecordingWriter::has_pedal() const { return file_->pedal.has_value(); }

void RecordingWriter::append_pedal(const PedalRow& row) {
  file_->guarded([&] { file_->pedal.value().add(sealed(row)); });
}

void RecordingWriter::append_state_hash(const StateHash& hash) {
  file_->guarded([&] {
    file_->state_hashes->add(sealed(StateHashRow{hash.tick, hash.volume, hash.state, 0}));
  });
}

void RecordingWriter::append_keyframe(std::uint64_t tick, std::span<const std::byte> state) {
  file_->guarded([&] {
    KeyframeRow row;
    row.tick = tick;
    row.offset = file_->keyframes->written() + file_->keyframes->waiting();
    row.bytes = state.size();
    row.content = hash_bytes(state.data(), state.size());
    file_->keyframes->add(state);
    file_->keyframe_index->add(sealed(row));
    if (file_->keyframes->waiting() > kMaxWaitingStateBytes) file_->flush();
  });
}

void RecordingWriter::append_summary(std::string_view text) {
  file_->guarded([&] {
    if (file_->summary->written() > 0) throw std::logic_error("a second summary of one run");
    const std::span bytes = std::as_bytes(std::span(text));
    file_->summary->add(bytes);
    file_->summary->flush();
    write_row(file_->summary_check,
              SummaryCheckRow{bytes.size(), hash_bytes(bytes.data(), bytes.size()), 0});
  });
}

void RecordingWriter::flush() {
  file_->guarded([this] { file_->flush(); });
}

void RecordingWriter::close() {
  file_->guarded([this] { file_->close(); });
}

}  // namespace sulcus
