#include "app/session/haptic_loop.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "engine/core/realtime.hpp"
#include "engine/core/stop.hpp"
#include "haptics/saved_state.hpp"

namespace sulcus {

namespace {

constexpr std::uint64_t kHashEvery = 100;  // ticks between state hashes
// A state is recorded every so many ticks, and sooner where they take long: a seek has to run again
// what came after it. Large ones are further apart, so that all together take no more room than the
// rows. Where they stand is no part of the result.
constexpr std::uint64_t kKeyframeEvery = 200;
constexpr double kKeyframeEvery_us = 50e3;  // of computing

float microseconds(std::uint64_t ns) { return static_cast<float>(1e-3 * static_cast<double>(ns)); }

bool is_zero_force(const TickRecord& record) {
  const auto is_zero = [](double x) { return x == 0.0; };
  return std::ranges::all_of(record.force_N, is_zero) &&
         std::ranges::all_of(record.torque_Nm, is_zero);
}

LooseSchedule loose_schedule(const SessionOptions& options, std::uint64_t first) {
  return options.played_back ? LooseSchedule(*options.played_back, first) : LooseSchedule(first);
}

}  // namespace

void RecordProducer::push(std::span<const TakenAnswer> taken) {
  if (!is_open()) return;
  for (const TakenAnswer& answer : taken) feed_->taken.enqueue(answer);
}

/// Edits are never dropped. Where the disk does not keep up, rows are, at real pace; the next one
/// that finds room says so, and its state is recorded, from which a replay can go on.
void RecordProducer::push(TickReport& report, std::span<const Edit> edits) {
  if (!is_open()) return;
  for (const Edit& edit : edits) feed_->edits.enqueue(edit);
  if (in_gap_) {
    report.record.faults |= kFaultRowsDropped;
    seal(report.record);
  }
  if (!feed_->reports.try_enqueue(report)) {
    if (pace_ == Pace::kReal) {
      ++dropped_rows_;
      in_gap_ = true;
      last_dropped_ = report;
      return;
    }
    wait_for_room(report);
  }
  const std::uint64_t next = report.record.tick + 1;
  if (in_gap_) end_gap();
  if (next % kHashEvery == 0) push_hash();
  since_keyframe_us_ += static_cast<double>(report.record.step_us);
  const bool due = next % kKeyframeEvery == 0 || since_keyframe_us_ >= kKeyframeEvery_us;
  // Where the disk has yet to take those before it, the next one waits: else each pause of it
  // would cost memory for good.
  if (due && next >= keyframe_next_ && feed_->spare_keyframes.peek() != nullptr) push_keyframe();
}

void RecordProducer::end() {
  if (!is_open()) return;
  if (in_gap_) {  // time does not matter any more
    wait_for_room(last_dropped_);
    --dropped_rows_;
    end_gap();
  }
  push_hash();  // the end's, wherever it came
}

void RecordProducer::wait_for_room(const TickReport& report) {
  while (is_open() && !feed_->reports.try_enqueue(report)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// After the first row that was not dropped.
void RecordProducer::end_gap() {
  in_gap_ = false;
  push_hash();
  push_keyframe();
}

void RecordProducer::push_hash() {
  const std::uint64_t next = simulation_.state().tick;
  if (!is_open() || next == hash_at_) return;
  hash_at_ = next;
  feed_->hashes.enqueue({next - 1, simulation_.workpiece().hash(), simulation_.state().hash()});
}

void RecordProducer::push_keyframe() {
  const std::uint64_t next = simulation_.state().tick;
  if (next == keyframe_at_) return;
  keyframe_at_ = next;
  since_keyframe_us_ = 0.0;
  Keyframe keyframe;
  feed_->spare_keyframes.try_dequeue(keyframe);
  keyframe.tick = next - 1;
  save_state(simulation_.state(), keyframe.state);
  keyframe_next_ = next + keyframe.state.size() / sizeof(TickRecord);
  feed_->keyframes.enqueue(std::move(keyframe));
}

HapticLoop::HapticLoop(Simulation& simulation, Device& device, const SessionOptions& options,
                       Feeds& feeds, PiecesThread* pieces, Progress* progress)
    : simulation_(simulation),
      device_(device),
      options_(options),
      all_feeds_(feeds),
      feeds_(feeds.without_record()),
      record_(simulation, options.pace, feeds.record ? &*feeds.record : nullptr),
      pieces_(pieces),
      loose_(loose_schedule(options, simulation.state().tick)),
      pacer_(simulation.scene().haptics.rate_hz),
      progress_(progress) {}

void HapticLoop::run() noexcept {
  failure_.guard([this] { run_ticks(); });
  // First of all: what follows may wait for the disk.
  do {
    if (options_.pace == Pace::kReal) pacer_.wait([] {});
  } while (device_.fade());
  device_.release();
  failure_.guard([this] {
    if (done_ > 0) record_.end();
  });
  for (Feed* feed : feeds_) feed->ended = true;
  if (all_feeds_.record) all_feeds_.record->ended = true;
}

/// Also where one has failed without whom there is no result.
bool HapticLoop::is_stopped() const {
  return stop_ || stop_requested() || all_feeds_.reports.closed ||
         (all_feeds_.pieces && all_feeds_.pieces->closed);
}

void HapticLoop::run_ticks() {
  const bool real = options_.pace == Pace::kReal;
  if (real) {
    refused_ = request_realtime();
    (void)lock_memory();  // this thread's stack as well; what is refused was said before
  }
  // One at least: a recording of no tick is none.
  for (; done_ < options_.ticks && (done_ == 0 || !is_stopped()); ++done_) {
    wait_out_pause();
    const float late_us = real ? pacer_.wait([&] { simulation_.warm_caches(); }) : 0.0f;
    TickReport report = step(loose_voxels(), late_us);
    publish(report);
    if (report.record.faults & kFaultNotFinite) break;
    if (device_.is_gone() && is_zero_force(report.record)) break;
    if (progress_) progress_->at(done_ + 1, options_.ticks);
  }
}

void HapticLoop::wait_out_pause() {
  if (!options_.paused || !*options_.paused) return;
  while (*options_.paused && !is_stopped()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  pacer_.restart();
}

/// The voxels of loose pieces that leave in the next tick.
std::span<const std::uint32_t> HapticLoop::loose_voxels() {
  if (!pieces_) return {};
  const bool wait = options_.pace == Pace::kFast || options_.played_back;
  const auto voxels = loose_.before_tick(simulation_.state().tick, [&](LooseAnswer& answer) {
    return pieces_->next_answer(answer, wait);
  });
  record_.push(loose_.taken());
  return voxels;
}

/// One tick, and its rows but for what the edits before it add.
TickReport HapticLoop::step(std::span<const std::uint32_t> loose, float late_us) {
  simulation_.reset_clocks();
  const std::uint64_t began = steady_ns(), begin = thread_cpu_ns();
  TickReport report;
  report.record = simulation_.step(device_, loose);
  const std::uint64_t cpu_ns = thread_cpu_ns() - begin, passed_ns = steady_ns() - began;
  report.record.step_us = microseconds(cpu_ns);
  report.record.late_us = late_us;
  report.cutting = simulation_.cutting();
  report.port = simulation_.port();
  report.pedal = simulation_.state().pedal;
  // Stages are timed by the cheaper clock, which goes on while another process has the core.
  const float own_share =
      cpu_ns < passed_ns
          ? static_cast<float>(static_cast<double>(cpu_ns) / static_cast<double>(passed_ns))
          : 1.0f;
  for (int s = 0; s < kStageCount; ++s) {
    report.stage_us[s] = own_share * microseconds(simulation_.stage_ns(Stage(s)));
  }
  report.loose_left = loose_.left();
  return report;
}

void HapticLoop::publish(TickReport& report) {
  const auto edits = simulation_.edits();
  const auto gone = static_cast<std::uint64_t>(std::ranges::count_if(edits, &Edit::is_gone));
  report.record.edits_end = edits_ += gone;
  report.fills_end = fills_ += edits.size() - gone;
  seal(report.record);
  seal(report.cutting);
  seal(report.port);
  for (Feed* feed : feeds_) {
    if (feed->closed) continue;
    for (const Edit& edit : edits) feed->edits.enqueue(edit);
    feed->reports.enqueue(report);
  }
  record_.push(report, edits);
}

}  // namespace sulcus
