#include "app/session/session.hpp"

#include <exception>
#include <filesystem>
#include <future>
#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include <spdlog/spdlog.h>

#include "app/session/feed_thread.hpp"
#include "app/session/haptic_loop.hpp"
#include "app/session/pieces_thread.hpp"
#include "app/session/recorder_thread.hpp"
#include "app/session/render_thread.hpp"
#include "app/session/report_thread.hpp"
#include "app/session/stream_thread.hpp"
#include "app/terminal/progress.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/stop.hpp"

namespace sulcus {

namespace {

/// Into the log alone: the terminal has it from where the failure is caught, at the end.
void log_end_of_recording(const std::exception_ptr& why) noexcept {
  try {
    try {
      std::rethrow_exception(why);
    } catch (const std::exception& failure) {
      spdlog::info("the recording ends before the run: {}", failure.what());
    }
  } catch (...) {  // there may be no memory for a line; the end of the run says it
  }
}

/// Adds the time that it lives to the seconds of a part.
class PartTimer {
 public:
  explicit PartTimer(PartUse& part) : part_(part) {}
  ~PartTimer() { part_.seconds += seconds_since(begin_ns_); }
  PartTimer(const PartTimer&) = delete;
  PartTimer& operator=(const PartTimer&) = delete;

 private:
  PartUse& part_;
  std::uint64_t begin_ns_ = steady_ns();
};

/// All that consumes what the haptic thread pushes, each with its feed.
class Consumers {
 public:
  Consumers(const Simulation& simulation, const SessionOptions& options, bool pedal);

  Feeds& feeds() { return feeds_; }
  PiecesThread* pieces() { return pieces_ ? &*pieces_ : nullptr; }
  /// Right before the first tick: from here on the recording has its name.
  void start_recorder() {
    if (recorder_) recorder_->start();
  }
  /// After the haptic thread has ended. All are waited for, so that one's failure does not cost
  /// what the others still write.
  void finish(FirstFailure& failure, SessionResult& result);
  void close_recording(const std::string& summary, FirstFailure& failure) {
    if (recorder_) failure.guard([&] { recorder_->close(summary); });
  }

 private:
  std::future<RecordingWriter> begin_recording(bool pedal);
  std::vector<RunMarks> make_marks();
  std::optional<HeatLog> make_heat();
  void add_outcome(SessionResult& result);
  void add_heat(SessionResult& result);

  const Simulation& simulation_;
  const SessionOptions& options_;
  std::string recording_;
  PartUse outcome_part_{"outcome"}, record_part_{"record"}, pieces_part_{"loose_pieces"};
  PartUse heat_part_{"heat"};
  std::optional<ToothHeat> heat_;  // with [heat]; before the reports, which make it
  Feeds feeds_;
  std::future<RecordingWriter> begun_;  // beside what the others prepare
  ReportThread reports_;
  std::optional<RecorderThread> recorder_;
  std::optional<RenderThread> renderer_;
  std::optional<StreamThread> stream_;
  std::optional<PiecesThread> pieces_;  // the first to end: others wait for its news
};

/// `pedal`: whether there may be one to be recorded.
Consumers::Consumers(const Simulation& simulation, const SessionOptions& options, bool pedal)
    : simulation_(simulation),
      options_(options),
      recording_(options.folder + "/recording.h5"),
      feeds_(simulation.scene().haptics.rate_hz),
      begun_(begin_recording(pedal)),
      reports_(feeds_.reports, make_marks(), make_heat()) {
  const Scene& scene = simulation.scene();
  const double rate_hz = scene.haptics.rate_hz;
  const auto open = [&](auto& feed, auto... seconds) -> auto& {
    feed.emplace(rate_hz, seconds...);
    if (scene.loose_pieces) feed->pieces.emplace();
    return *feed;
  };
  if (scene.record) open(feeds_.record, scene.record->queue_s);
  if (scene.render && options.render) renderer_.emplace(open(feeds_.frames), simulation, options);
  if (options.watch) open(feeds_.watch);
  if (scene.stream && options.stream) {
    stream_.emplace(feeds_.stream.emplace(rate_hz), simulation, options);
  }
  if (scene.loose_pieces) {
    const PartTimer timer(pieces_part_);
    std::vector<PieceFeed*> followers = feeds_.of_pieces();
    pieces_.emplace(feeds_.pieces.emplace(rate_hz), std::move(followers), simulation);
  }
  if (scene.record) {
    recorder_.emplace(*feeds_.record, begun_.get(), [this](const std::exception_ptr& why) {
      if (options_.recording_ends) options_.recording_ends();
      if (options_.pace == Pace::kReal) log_end_of_recording(why);
    });
    record_part_.bytes =
        static_cast<std::size_t>(scene.record->queue_s * rate_hz) * sizeof(TickReport);
  }
}

/// None without [record].
std::future<RecordingWriter> Consumers::begin_recording(bool pedal) {
  if (!simulation_.scene().record) return {};
  return std::async(std::launch::async, [this, pedal] {
    const PartTimer timer(record_part_);
    return sulcus::begin_recording(simulation_, options_, recording_, pedal);
  });
}

/// None without [cutting].
std::vector<RunMarks> Consumers::make_marks() {
  if (!simulation_.scene().cutting) return {};
  const PartTimer timer(outcome_part_);
  return begin_marks(simulation_.scene(), simulation_.workpiece().model(),
                     options_.goal ? &*options_.goal : nullptr, options_.earlier.get());
}

/// None without [heat].
std::optional<HeatLog> Consumers::make_heat() {
  const Scene& scene = simulation_.scene();
  if (!scene.heat) return {};
  const PartTimer timer(heat_part_);
  heat_.emplace(scene, simulation_.workpiece().model());
  return HeatLog(scene.haptics.rate_hz, simulation_.state().tick);
}

void Consumers::finish(FirstFailure& failure, SessionResult& result) {
  if (pieces_) {
    failure.guard([&] { pieces_->finish(); });
    result.pieces = pieces_->pieces();
    pieces_part_.seconds += pieces_->seconds();
    pieces_part_.bytes = pieces_->memory_bytes();
  }
  if (recorder_) {
    failure.guard([&] { recorder_->finish(); });
    result.files.push_back(recording_);
    result.parts.push_back(record_part_);
  }
  if (pieces_) result.parts.push_back(pieces_part_);
  if (stream_) {
    failure.guard([&] { stream_->finish(); });
    result.stream = stream_->result();
    result.parts.push_back({"stream", stream_->seconds(), stream_->memory_bytes()});
  }
  failure.guard([&] { reports_.finish(); });
  result.statistics = reports_.statistics();
  if (renderer_) {
    failure.guard([&] { renderer_->finish(); });
    result.frames = renderer_->frames();
    result.parts.push_back({"render", renderer_->seconds(), renderer_->memory_bytes()});
    if (result.frames > 0) result.files.push_back(options_.folder + "/frames");
  }
  if (!reports_.marks().empty()) add_outcome(result);
  if (heat_) add_heat(result);
}

void Consumers::add_outcome(SessionResult& result) {
  {
    const PartTimer timer(outcome_part_);
    const VoxelModel& end = simulation_.workpiece().model();
    result.outcome = end_marks(reports_.marks().front(), end);
    if (options_.earlier) result.part = end_marks(reports_.marks().back(), end);
  }
  outcome_part_.seconds += reports_.marks_seconds();
  for (const RunMarks& each : reports_.marks()) {
    outcome_part_.bytes += each.preparation.memory_bytes();
  }
  result.parts.push_back(outcome_part_);
}

/// When all else has ended: no tick waits for it, nor is held up by it.
void Consumers::add_heat(SessionResult& result) {
  {
    const PartTimer timer(heat_part_);
    heat_->advance(*reports_.heat(), std::numeric_limits<double>::infinity());
    result.heat = heat_->result();
  }
  heat_part_.bytes = heat_->memory_bytes() + reports_.heat()->memory_bytes();
  result.parts.push_back(heat_part_);
}

}  // namespace

SessionResult run_session(Simulation& simulation, Device& device, const SessionOptions& options) {
  SessionResult result;
  std::filesystem::create_directories(options.folder);
  // Everything is made before the first tick, so that nothing is taken beside it.
  Consumers consumers(simulation, options, device.has_pedal());
  std::optional<Progress> progress;
  if (options.pace == Pace::kFast) progress.emplace("running");
  HapticLoop loop(simulation, device, options, consumers.feeds(), consumers.pieces(),
                  progress ? &*progress : nullptr);
  if (options.pace == Pace::kReal) {
    if (std::string refused = lock_memory(); !refused.empty()) {
      result.refused.push_back(std::move(refused));
    }
  }
  if (options.begins) options.begins();
  consumers.start_recorder();
  result.load_seconds = process_age_s();

  const std::uint64_t begin = steady_ns();
  std::thread haptic([&] { loop.run(); });
  FirstFailure failure, of_watch;
  if (options.watch) {
    Feed& feed = *consumers.feeds().watch;
    of_watch.guard([&] { options.watch(feed); });
    feed.closed = true;
    loop.stop();
  }
  haptic.join();
  result.wall_seconds = seconds_since(begin);
  failure.guard([&] { loop.rethrow(); });
  failure.guard([&] { of_watch.rethrow(); });
  result.missed_ticks = loop.missed();
  result.dropped_rows = loop.dropped_rows();
  result.refused.insert(result.refused.end(), loop.refused().begin(), loop.refused().end());

  progress.emplace("finishing");
  consumers.finish(failure, result);
  result.interrupted = stop_requested();  // which costs pictures also where it came after the ticks
  if (options.summarise) result.summary = options.summarise(result);
  consumers.close_recording(result.summary, failure);
  result.failure = failure.get();
  return result;
}

}  // namespace sulcus
