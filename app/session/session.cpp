#include "app/session/session.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <thread>

#include <spdlog/spdlog.h>

#include "app/build_info.hpp"
#include "app/session/feed.hpp"
#include "app/session/pieces_thread.hpp"
#include "app/session/recorder_thread.hpp"
#include "app/session/render_thread.hpp"
#include "app/session/report_thread.hpp"
#include "app/terminal/progress.hpp"
#include "engine/core/hash.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/stop.hpp"
#include "engine/core/units.hpp"
#include "haptics/saved_state.hpp"

namespace sulcus {

namespace {

constexpr std::uint64_t kHashEvery = 100;  // ticks between state hashes
// A state is recorded every so many ticks, and sooner where they take long: a seek has to run again
// what came after it. Large ones are further apart, so that all together take no more room than the
// rows. Where they stand is no part of the result.
constexpr std::uint64_t kKeyframeEvery = 200;
constexpr double kKeyframeEvery_us = 50e3;  // of computing

/// Wakes at absolute times, one period apart. A wake that is late by whole periods moves the
/// schedule: nothing is run twice as fast and no tick is left out.
class Pacer {
 public:
  Pacer(double rate_hz) : period_ns_(static_cast<std::uint64_t>(std::llround(1e9 / rate_hz))) {}

  /// Sleeps until the next tick is due; returns the microseconds that it is late. A core that has
  /// slept has cold caches: it wakes a little earlier, and `rehearse` goes where the tick will go.
  template <class Rehearse>
  float wait(const Rehearse& rehearse) {
    if (next_ns_ == 0) next_ns_ = steady_ns();
    const std::uint64_t lead_ns = period_ns_ / 3;
    if (steady_ns() + lead_ns < next_ns_) {
      sleep_until_ns(next_ns_ - lead_ns);
      if (steady_ns() + lead_ns / 2 < next_ns_) rehearse();
    }
    sleep_until_ns(next_ns_);
    const std::uint64_t late_ns = steady_ns() - next_ns_;
    const std::uint64_t missed = late_ns / period_ns_;
    missed_ += missed;
    next_ns_ += (missed + 1) * period_ns_;
    return static_cast<float>(1e-3 * static_cast<double>(late_ns));
  }
  /// After a pause the next tick is due at once.
  void begin_again() { next_ns_ = 0; }
  std::uint64_t missed() const { return missed_; }

 private:
  std::uint64_t period_ns_, next_ns_ = 0, missed_ = 0;
};

bool is_zero_force(const TickRecord& record) {
  const auto is_zero = [](double x) { return x == 0.0; };
  return std::ranges::all_of(record.force_N, is_zero) &&
         std::ranges::all_of(record.torque_Nm, is_zero);
}

/// The loop around the tick: what only a thread with a clock knows.
class HapticLoop {
 public:
  /// `record` is null where the scene has no [record]. `needed`: feeds of those without whom there
  /// is no result; where one of them has failed, the run ends.
  HapticLoop(Simulation& simulation, Device& device, const SessionOptions& options,
             std::vector<Feed*> feeds, std::vector<const Feed*> needed, RecordFeed* record,
             PiecesThread* pieces, Progress* progress)
      : simulation_(simulation),
        device_(device),
        options_(options),
        feeds_(std::move(feeds)),
        needed_(std::move(needed)),
        record_(record),
        pieces_(pieces),
        loose_(options.played_back ? LooseSchedule(*options.played_back, simulation.state().tick)
                                   : LooseSchedule(simulation.state().tick)),
        pacer_(simulation.scene().haptics.rate_hz),
        progress_(progress) {}

  /// Whatever ends the ticks, the device loses its force, and all that was told is told whole. What
  /// was thrown is in `failure`.
  void run() noexcept {
    guarded([this] { run_ticks(); });
    // First of all: what follows may wait for the disk.
    do {
      if (options_.pace == Pace::kReal) pacer_.wait([] {});
    } while (device_.fade());
    device_.release();
    guarded([this] { end_record(); });
    for (Feed* feed : feeds_) feed->ended = true;
    if (record_) record_->ended = true;
  }

  /// Ends the run after the tick in hand. Of any thread.
  void stop() { stop_ = true; }

  // After `run`.
  std::uint64_t missed() const { return pacer_.missed(); }
  std::uint64_t dropped_rows() const { return dropped_rows_; }
  const std::vector<std::string>& refused() const { return refused_; }
  /// The first that was thrown; null: nothing.
  std::exception_ptr failure() const { return failure_; }

 private:
  bool stopped() const {
    return stop_requested() || stop_ ||
           std::ranges::any_of(needed_, [](const Feed* feed) { return feed->gone.load(); });
  }

  template <class Part>
  void guarded(const Part& part) noexcept {
    try {
      part();
    } catch (...) {
      if (!failure_) failure_ = std::current_exception();
    }
  }

  void run_ticks() {
    if (options_.pace == Pace::kReal) {
      refused_ = request_realtime();
      (void)lock_memory();  // this thread's stack as well; what is refused was said before
    }
    // One at least: a recording of no tick is none.
    for (; done_ < options_.ticks && (done_ == 0 || !stopped()); ++done_) {
      wait_out_pause();
      const float late_us =
          options_.pace == Pace::kReal ? pacer_.wait([&] { simulation_.rehearse(); }) : 0.0f;
      const auto loose = loose_now();
      simulation_.reset_clocks();
      const std::uint64_t begin = thread_cpu_ns();
      TickReport report{simulation_.step(device_, loose),
                        simulation_.cutting(),
                        simulation_.port(),
                        {},
                        loose_.left()};
      report.record.step_us =
          static_cast<float>(1e-3 * static_cast<double>(thread_cpu_ns() - begin));
      report.record.late_us = late_us;
      for (int s = 0; s < kStageCount; ++s) {
        report.stage_us[s] =
            static_cast<float>(1e-3 * static_cast<double>(simulation_.stage_ns(Stage(s))));
      }
      publish(report);
      if (report.record.faults & kFaultNotFinite) break;
      if (device_.is_gone() && is_zero_force(report.record)) break;
      if (progress_) progress_->at(done_ + 1, options_.ticks);
    }
  }

  void end_record() {
    if (records() && gap_) {  // time does not matter any more
      wait_for_room(dropped_);
      --dropped_rows_;
      mark_gap_end();
    }
    if (done_ > 0) hash_state();  // the end's, wherever it came
  }

  void wait_out_pause() {
    if (!options_.paused || !*options_.paused) return;
    while (*options_.paused && !stopped()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    pacer_.begin_again();
  }

  bool records() const { return record_ && !record_->gone; }

  /// The voxels of loose pieces that leave in the next tick.
  std::span<const std::uint32_t> loose_now() {
    if (!pieces_) return {};
    const bool wait = options_.pace == Pace::kFast || options_.played_back;
    const auto voxels = loose_.before_tick(simulation_.state().tick, [&](LooseAnswer& answer) {
      return pieces_->next_answer(answer, wait);
    });
    if (records()) {
      for (const TakenAnswer& taken : loose_.taken()) record_->taken.enqueue(taken);
    }
    return voxels;
  }

  void publish(TickReport& report) {
    const auto edits = simulation_.edits();
    edits_ += edits.size();
    report.record.edits_end = edits_;
    seal(report.record);
    seal(report.cutting);
    seal(report.port);
    for (Feed* feed : feeds_) {
      if (feed->gone) continue;
      for (const Edit& edit : edits) feed->edits.enqueue(edit);
      feed->reports.enqueue(report);
    }
    if (records()) record(report, edits);
  }

  /// Edits are never left out. Where the disk does not keep up, rows are, at real pace; the next
  /// one that finds room says so, and its state is recorded, from which a replay can go on.
  void record(TickReport& report, std::span<const Edit> edits) {
    for (const Edit& edit : edits) record_->edits.enqueue(edit);
    if (gap_) {
      report.record.faults |= kFaultRowsDropped;
      seal(report.record);
    }
    if (!record_->reports.try_enqueue(report)) {
      if (options_.pace == Pace::kReal) {
        ++dropped_rows_;
        gap_ = true;
        dropped_ = report;
        return;
      }
      wait_for_room(report);
    }
    const std::uint64_t next = report.record.tick + 1;
    if (gap_) mark_gap_end();
    if (next % kHashEvery == 0) hash_state();
    since_kept_us_ += static_cast<double>(report.record.step_us);
    const bool due = next % kKeyframeEvery == 0 || since_kept_us_ >= kKeyframeEvery_us;
    // Where the disk has yet to take those before it, the next one waits: else each pause of it
    // would cost memory for good.
    if (due && next >= keep_next_ && record_->spare_keyframes.peek() != nullptr) keep_state();
  }

  void wait_for_room(const TickReport& report) {
    while (records() && !record_->reports.try_enqueue(report)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  /// After the first row that was not dropped.
  void mark_gap_end() {
    gap_ = false;
    hash_state();
    keep_state();
  }

  void hash_state() {
    const std::uint64_t next = simulation_.state().tick;
    if (!records() || next == hashed_) return;
    hashed_ = next;
    record_->hashes.enqueue({next - 1, simulation_.workpiece().hash(), simulation_.state().hash()});
  }

  void keep_state() {
    const std::uint64_t next = simulation_.state().tick;
    if (next == kept_) return;
    kept_ = next;
    since_kept_us_ = 0.0;
    Keyframe keyframe;
    record_->spare_keyframes.try_dequeue(keyframe);
    keyframe.tick = next - 1;
    save_state(simulation_.state(), keyframe.state);
    keep_next_ = next + keyframe.state.size() / sizeof(TickRecord);
    record_->keyframes.enqueue(std::move(keyframe));
  }

  Simulation& simulation_;
  Device& device_;
  const SessionOptions& options_;
  std::vector<Feed*> feeds_;  // but the recorder's
  std::vector<const Feed*> needed_;
  RecordFeed* record_;    // null without [record]
  PiecesThread* pieces_;  // null without [loose_pieces]
  LooseSchedule loose_;
  Pacer pacer_;
  std::uint64_t done_ = 0, edits_ = 0, hashed_ = 0, kept_ = 0, keep_next_ = 0, dropped_rows_ = 0;
  double since_kept_us_ = 0.0;  // computed since a state was recorded
  bool gap_ = false;            // the row before was dropped
  TickReport dropped_;          // it
  std::vector<std::string> refused_;
  std::exception_ptr failure_;
  std::atomic<bool> stop_{false};
  Progress* progress_;  // null at real pace
};

std::optional<RecordingWriter> open_recording(const Simulation& simulation,
                                              const SessionOptions& options,
                                              const std::string& path) {
  const Scene& scene = simulation.scene();
  if (!scene.record) return {};
  RecordingHeader header;
  header.scene_toml = scene.text;
  header.scene_sha256 = sha256_hex(scene.text);
  header.build = build_info();
  header.rate_hz = scene.haptics.rate_hz;
  header.workpiece_hash = simulation.workpiece().hash_with_tissues();
  header.parent = options.parent;
  const bool from_file = scene.burr.shape == BurrShape::kFile;
  RecordedSolids others{{},
                        options.goal ? &*options.goal : nullptr,
                        options.input ? &*options.input : nullptr,
                        options.earlier.get()};
  for (const Neighbour& neighbour : simulation.state().neighbours) {
    others.bodies.push_back(&neighbour.solid.model());
  }
  RecordingWriter writer(path, header, simulation.workpiece().model(),
                         from_file ? &simulation.burr().mesh_tool : nullptr,
                         {.cutting = scene.cutting.has_value(),
                          .port = scene.device.has_value() || scene.coupling.has_value(),
                          .pieces = scene.loose_pieces.has_value()},
                         others);
  if (const std::uint64_t next = simulation.state().tick; next > 0) {  // it goes on from there
    std::vector<std::byte> state;
    save_state(simulation.state(), state);
    writer.append_keyframe(next - 1, state);
  }
  return writer;
}

/// Copies of the bodies besides the workpiece.
std::vector<VoxelModel> copy_bodies(const Simulation& simulation) {
  std::vector<VoxelModel> bodies;
  for (const Neighbour& neighbour : simulation.state().neighbours) {
    bodies.push_back(neighbour.solid.model());
  }
  return bodies;
}

}  // namespace

SessionResult run_session(Simulation& simulation, Device& device, const SessionOptions& options) {
  const Scene& scene = simulation.scene();
  const bool renders = scene.render && options.render;
  SessionResult result;
  std::filesystem::create_directories(options.folder);

  // Everything is made before the first tick, so that nothing is taken beside it.
  const std::string recording = options.folder + "/recording.h5";
  const std::uint64_t outcome_begin = steady_ns();
  std::vector<RunMarks> marks;
  if (scene.cutting) {
    marks = begin_marks(scene, simulation.workpiece().model(),
                        options.goal ? &*options.goal : nullptr, options.earlier.get());
  }
  double outcome_s = 1e-9 * static_cast<double>(steady_ns() - outcome_begin);
  const std::uint64_t record_begin = steady_ns();
  Feed report_feed(scene.haptics.rate_hz);
  ReportThread reports(report_feed, std::move(marks));
  std::vector<Feed*> feeds{&report_feed};
  std::optional<PieceFeed> record_pieces, render_pieces, watch_pieces;
  std::optional<RecordFeed> record_feed;
  std::optional<RecorderThread> recorder;
  std::optional<RecordingWriter> writer = open_recording(simulation, options, recording);
  if (writer) {
    record_feed.emplace(scene.haptics.rate_hz, scene.record->queue_s);
    // Room that is not used takes no memory; a state that needs more takes it once.
    constexpr int kKeyframesOnTheWay = 4;
    for (int spare = 0; spare < kKeyframesOnTheWay; ++spare) {
      Keyframe keyframe;
      keyframe.state.reserve(std::size_t{1} << 20);
      record_feed->spare_keyframes.enqueue(std::move(keyframe));
    }
    if (scene.loose_pieces) record_pieces.emplace();
    result.files.push_back(recording);
    result.parts.push_back(
        {"record", 1e-9 * static_cast<double>(steady_ns() - record_begin),
         static_cast<std::size_t>(scene.record->queue_s * scene.haptics.rate_hz) *
             sizeof(TickReport)});
  }
  std::optional<Feed> render_feed;
  std::optional<RenderThread> renderer;
  if (renders) {
    render_feed.emplace(scene.haptics.rate_hz);
    feeds.push_back(&*render_feed);
    if (scene.loose_pieces) render_pieces.emplace();
    renderer.emplace(*render_feed, render_pieces ? &*render_pieces : nullptr, scene,
                     simulation.workpiece().model(), copy_bodies(simulation), simulation.burr(),
                     options.earlier.get(), options.folder, options.pace == Pace::kReal);
  }

  std::optional<Feed> watch_feed;
  if (options.watch) {
    watch_feed.emplace(scene.haptics.rate_hz);
    feeds.push_back(&*watch_feed);
    if (scene.loose_pieces) watch_pieces.emplace();
  }
  std::optional<Feed> pieces_feed;
  std::optional<PiecesThread> pieces;
  if (scene.loose_pieces) {
    const std::uint64_t pieces_begin = steady_ns();
    pieces_feed.emplace(scene.haptics.rate_hz);
    feeds.push_back(&*pieces_feed);
    std::vector<PieceFeed*> consumers;
    for (auto* consumer : {&record_pieces, &render_pieces, &watch_pieces}) {
      if (*consumer) consumers.push_back(&**consumer);
    }
    pieces.emplace(*pieces_feed, std::move(consumers), scene, simulation.workpiece().model(),
                   copy_bodies(simulation));
    result.parts.push_back(
        {"loose_pieces", 1e-9 * static_cast<double>(steady_ns() - pieces_begin), 0});
  }
  // At real pace nothing is written beside the ticks.
  std::optional<Progress> progress;
  if (options.pace == Pace::kFast) progress.emplace("running");
  std::vector<const Feed*> needed{&report_feed};
  if (pieces_feed) needed.push_back(&*pieces_feed);
  HapticLoop loop(simulation, device, options, feeds, std::move(needed),
                  record_feed ? &*record_feed : nullptr, pieces ? &*pieces : nullptr,
                  progress ? &*progress : nullptr);
  if (options.pace == Pace::kReal) {
    if (std::string refused = lock_memory(); !refused.empty()) {
      result.refused.push_back(std::move(refused));
    }
  }
  if (options.begins) options.begins();
  // Last, so that the recording has its name right before the first tick.
  if (writer) {
    recorder.emplace(*record_feed, record_pieces ? &*record_pieces : nullptr, std::move(*writer));
  }
  result.load_seconds = process_age_s();
  const std::uint64_t begin = steady_ns();
  std::thread haptic([&] { loop.run(); });
  std::exception_ptr failure;
  if (options.watch) {
    try {
      options.watch(*watch_feed, watch_pieces ? &*watch_pieces : nullptr);
    } catch (...) {
      failure = std::current_exception();
    }
    watch_feed->gone = true;
    loop.stop();
  }
  haptic.join();
  if (loop.failure()) failure = loop.failure();
  result.wall_seconds = 1e-9 * static_cast<double>(steady_ns() - begin);
  progress.emplace("finishing");
  result.missed_ticks = loop.missed();
  result.dropped_rows = loop.dropped_rows();
  result.refused.insert(result.refused.end(), loop.refused().begin(), loop.refused().end());

  // All are waited for, so that one's failure does not cost what the other still writes.
  const auto wait = [&](auto& part) {
    try {
      part.finish();
    } catch (...) {
      failure = std::current_exception();
    }
  };
  if (pieces) {
    wait(*pieces);
    result.pieces = pieces->pieces();
    PartUse& use = *std::find_if(result.parts.begin(), result.parts.end(),
                                 [](const PartUse& part) { return part.name == "loose_pieces"; });
    use.seconds += pieces->seconds();
    use.bytes = pieces->memory_bytes();
  }
  if (recorder) wait(*recorder);
  wait(reports);
  if (renderer) {
    wait(*renderer);
    result.frames = renderer->frames();
    result.parts.push_back({"render", renderer->seconds(), renderer->memory_bytes()});
    if (result.frames > 0) result.files.push_back(options.folder + "/frames");
  }
  result.statistics = reports.statistics();
  if (!reports.marks().empty()) {
    const std::uint64_t end_begin = steady_ns();
    const VoxelModel& end = simulation.workpiece().model();
    result.outcome = end_marks(reports.marks().front(), end);
    if (options.earlier) result.part = end_marks(reports.marks().back(), end);
    outcome_s += reports.marks_seconds() + 1e-9 * static_cast<double>(steady_ns() - end_begin);
    std::size_t bytes = 0;
    for (const RunMarks& each : reports.marks()) bytes += each.preparation.memory_bytes();
    result.parts.push_back({"outcome", outcome_s, bytes});
  }
  result.interrupted = stop_requested();  // which costs pictures also where it came after the ticks
  if (options.summarise) result.summary = options.summarise(result);
  if (recorder) {
    try {
      recorder->close(result.summary);
    } catch (...) {
      failure = std::current_exception();
    }
  }
  result.failure = failure;
  return result;
}

}  // namespace sulcus
