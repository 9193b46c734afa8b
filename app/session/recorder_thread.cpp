#include "app/session/recorder_thread.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "app/build_info.hpp"
#include "engine/core/hash.hpp"
#include "engine/core/realtime.hpp"
#include "haptics/saved_state.hpp"

namespace sulcus {

namespace {

/// From flush to flush: a kill costs what has come since the last one began.
constexpr std::chrono::milliseconds kFlushEvery{30};

// Taken at once, at most: what waits longer waits in the queues, and a disk or a processor that was
// busy costs no more memory than they have.
constexpr std::size_t kMostRows = 4096, kMostEdits = 1 << 16;

}  // namespace

RecordingWriter begin_recording(const Simulation& simulation, const SessionOptions& options,
                                const std::string& file, bool pedal) {
  const Scene& scene = simulation.scene();
  RecordingHeader header;
  header.scene_toml = scene.text;
  header.scene_sha256 = sha256_hex(scene.text);
  header.build = build_info();
  header.rate_hz = scene.haptics.rate_hz;
  header.workpiece_hash = simulation.workpiece().hash_with_tissues();
  header.parent = options.parent;
  RecordedSolids others{.bodies = {},
                        .goal = options.goal ? &*options.goal : nullptr,
                        .input = options.input ? &*options.input : nullptr,
                        .earlier = options.earlier.get()};
  for (const Body& body : simulation.state().others()) {
    others.bodies.push_back(&body.solid.model());
  }
  const bool from_file = scene.burr.shape == BurrShape::kFile;
  RecordingWriter writer(file, header, simulation.workpiece().model(),
                         from_file ? &simulation.burr().mesh_tool : nullptr,
                         {.cutting = scene.cutting.has_value(),
                          .port = scene.device.has_value() || scene.coupling.has_value(),
                          .pieces = scene.loose_pieces.has_value(),
                          .pedal = pedal},
                         others);
  if (const std::uint64_t next = simulation.state().tick; next > 0) {  // it goes on from there
    std::vector<std::byte> state;
    save_state(simulation.state(), state);
    writer.append_keyframe(next - 1, state);
  }
  return writer;
}

void RecorderThread::start() {
  thread_.start([this] { run(); },
                [this] {
                  writer_.reset();
                  ends_(thread_.why());
                });
}

void RecorderThread::close(std::string_view summary) {
  if (!writer_) return;
  if (!summary.empty()) writer_->append_summary(summary);
  writer_->close();
  writer_.reset();
}

void RecorderThread::run() {
  leave_realtime_core();
  const auto drain = [this] {
    while (write_some()) {
    }
  };
  drain_until_ended(feed_, kFlushEvery, drain);
  if (!feed_.pieces) return;
  // The news of the last ticks come when their thread has ended too.
  while (!feed_.pieces->ended()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  drain();
}

/// Whether there may be more.
bool RecorderThread::write_some() {
  std::vector<TickRecord> rows;
  std::vector<CuttingRecord> cuts;
  std::vector<PortRecord> port;
  std::vector<FillEndRow> fill_ends;
  std::vector<Edit> edits;
  for (TickReport report; rows.size() < kMostRows && feed_.reports.try_dequeue(report);) {
    rows.push_back(report.record);
    if (writer_->has_fills()) {
      fill_ends.push_back(sealed(FillEndRow{report.record.tick, report.fills_end, 0}));
    }
    if (writer_->has_cutting()) cuts.push_back(report.cutting);
    if (writer_->has_port()) port.push_back(report.port);
    if (writer_->has_pedal() && report.pedal != pedal_) {
      pedal_ = report.pedal;
      writer_->append_pedal({report.record.tick, pedal_, 0});
    }
  }
  for (Edit edit; edits.size() < kMostEdits && feed_.edits.try_dequeue(edit);) {
    edits.push_back(edit);
  }
  writer_->append_edits(edits);
  if (feed_.pieces) write_pieces();
  if (!fill_ends.empty()) writer_->append_fill_ends(fill_ends);
  if (!cuts.empty()) writer_->append_cutting(cuts);
  if (!port.empty()) writer_->append_port(port);
  writer_->append_ticks(rows);
  if (!rows.empty()) last_tick_ = rows.back().tick;
  write_states();
  writer_->flush();
  return rows.size() == kMostRows || edits.size() == kMostEdits;
}

/// A hash or a state of a tick whose row has not come yet waits for the next round.
void RecorderThread::write_states() {
  const auto has_come = [this](std::uint64_t tick) { return last_tick_ && tick <= *last_tick_; };
  while (const StateHash* hash = feed_.hashes.peek()) {
    if (!has_come(hash->tick)) break;
    writer_->append_state_hash(*hash);
    feed_.hashes.pop();
  }
  while (const Keyframe* next = feed_.keyframes.peek()) {
    if (!has_come(next->tick)) break;
    Keyframe keyframe;
    feed_.keyframes.try_dequeue(keyframe);
    writer_->append_keyframe(keyframe.tick, keyframe.state);
    keyframe.state.clear();
    feed_.spare_keyframes.enqueue(std::move(keyframe));
  }
}

void RecorderThread::write_pieces() {
  for (TakenAnswer taken; feed_.taken.try_dequeue(taken);) {
    TakenAnswerRow row{taken.asked, taken.taken, 0};
    seal(row);
    writer_->append_taken_answer(row);
  }
  for (PieceNews news; feed_.pieces->news.try_dequeue(news);) {
    if (news.voxels) {
      PieceRow row{news.piece, news.tick, news.first_loose_edit, news.voxels->size(), 0};
      seal(row);
      writer_->append_piece(row);
      continue;
    }
    PiecePoseRow row;
    row.tick = news.tick;
    row.piece = news.piece;
    std::copy_n(news.world_now_from_start.position.data(), 3, row.position_m);
    const Eigen::Quaterniond& q = news.world_now_from_start.orientation;
    row.orientation[0] = q.w();
    std::copy_n(q.vec().data(), 3, row.orientation + 1);
    seal(row);
    writer_->append_piece_pose(row);
  }
}

}  // namespace sulcus
