#include "app/session/stream_thread.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <stdexcept>
#include <utility>

#include "app/stream/tooth_messages.hpp"
#include "engine/core/fault.hpp"
#include "engine/core/realtime.hpp"
#include "engine/volume/edits.hpp"

namespace sulcus {

namespace {

using std::chrono::milliseconds;

/// Of samples that a client may be behind: older ones are of no use to who looks on.
constexpr double kLongestWait_s = 2.0;
constexpr std::size_t kFewestWaiting = 64;

std::size_t most_waiting(const StreamSettings& settings) {
  return std::max(kFewestWaiting, static_cast<std::size_t>(kLongestWait_s * settings.rate_hz));
}

/// For who still takes what waits for it when the run is over: a tooth may be large.
constexpr milliseconds kLongestEnd{5000};

/// Ticks after which clients are served, also where a run at fast pace has more of them than there
/// is time for.
constexpr int kMostAtOnce = 500;

/// Between two looks at the feed: a quarter of the time between samples, within 1 to 10 ms.
milliseconds look_every(double rate_hz) {
  return milliseconds(std::clamp(std::lround(250.0 / rate_hz), 1L, 10L));
}

std::string text_of(StreamState state, std::uint64_t faults) {
  if (state != StreamState::kFault) return std::string(name_of(state));
  std::string text;
  for (const FaultInfo& fault : kFaults) {
    if (!(faults & fault.bit)) continue;
    if (!text.empty()) text += ", ";
    text += fault.name;
  }
  return text;
}

/// Null: there was no memory for it, or it is too large for a message.
StreamBytes make_tooth(const VoxelModel& model, const std::string& type, const std::string& name,
                       MessageTime time) {
  leave_realtime_core();
  try {
    return type == "IMAGE" ? tooth_image(model, name, time) : tooth_polydata(model, name, time);
  } catch (const std::bad_alloc&) {
    return nullptr;
  } catch (const std::length_error&) {
    return nullptr;
  }
}

}  // namespace

StreamThread::StreamThread(Feed& feed, const Simulation& simulation, const SessionOptions& options)
    : feed_(feed),
      scene_(simulation.scene()),
      options_(options),
      server_(*options.stream, most_waiting(*scene_.stream)),
      messages_(*scene_.stream),
      voxel_m3_(simulation.workpiece().grid().voxel_volume_m3()),
      removed_m3_(1 + scene_.tissues.size()),
      removed_levels_(scene_.tissues.size()),
      thread_(feed) {
  const VoxelModel& start = simulation.workpiece().model();
  if (!scene_.stream->tooth.empty() || (scene_.cutting && !scene_.stream->removed.empty())) {
    model_ = start;
    memory_bytes_ =
        start.leaves.size() * sizeof(LeafBits) + (start.fills ? start.fills->memory_bytes() : 0);
  }
  last_.tick = simulation.state().tick;
  last_.time_s = static_cast<double>(last_.tick) / scene_.haptics.rate_hz;
  text_ = text_of(state_, 0);
  greeting_ = messages_.state(state_, last_.tick, last_.time_s, text_);
  // Who has waited has the first tick.
  server_.serve(milliseconds(0), greeting_);
  thread_.start([this] { run(); });
}

void StreamThread::run() {
  leave_realtime_core();
  const milliseconds pause = look_every(scene_.stream->rate_hz);
  for (bool over = false; !over;) {
    const bool ended = feed_.ended;  // before what was pushed before it is taken
    const bool all = take_ticks();
    over = ended && all;
    tell_state();
    take_requests();
    make_teeth();
    server_.serve(over || !all ? milliseconds(0) : pause, greeting_);
  }
  take_requests();
  while (in_work_ || !wanted_.empty()) {
    make_teeth();
    if (in_work_) in_work_->bytes.wait();
  }
  const StreamBytes over =
      messages_.state(StreamState::kOver, last_.tick, last_.time_s, text_of(StreamState::kOver, 0));
  if (over) server_.send_to_all(over, StreamKind::kNews);
  server_.finish(kLongestEnd);
  result_ = {server_.clients(), server_.samples(), server_.dropped()};
  seconds_ = 1e-9 * static_cast<double>(thread_cpu_ns());
}

bool StreamThread::take_ticks() {
  int taken = 0;
  for (TickReport report; taken < kMostAtOnce && feed_.reports.try_dequeue(report); ++taken) {
    for (Edit edit; edits_ < report.all_edits_end() && feed_.edits.try_dequeue(edit); ++edits_) {
      take_edit(edit);
    }
    last_ = report.record;
    faults_ |= last_.faults;
    if (!is_due(last_.tick)) continue;
    faults_told_ = std::exchange(faults_, 0);
    tell_state();
    if (server_.has_clients()) send_sample(report);
  }
  return taken < kMostAtOnce;
}

void StreamThread::take_edit(const Edit& edit) {
  constexpr std::uint16_t kWorkpiece = 0;
  if (!model_ || edit.body != kWorkpiece) return;
  const Cell c = model_->grid.cell_of_linear(edit.voxel);
  removed_levels_[model_->tissue(c)] += static_cast<std::uint64_t>(model_->level(c) - edit.level);
  apply_edit(edit, *model_);
}

/// The first tick, and each in which another rate_hz-th of a second begins.
bool StreamThread::is_due(std::uint64_t tick) {
  const auto due = static_cast<std::uint64_t>(static_cast<double>(tick) * scene_.stream->rate_hz /
                                              scene_.haptics.rate_hz);
  return std::exchange(samples_due_, due) != due;
}

void StreamThread::send_sample(const TickReport& report) {
  const auto volume_m3 = [voxel_m3 = voxel_m3_](std::uint64_t levels) {
    return static_cast<double>(levels) / kFullLevel * voxel_m3;
  };
  std::uint64_t all = 0;
  for (std::size_t tissue = 0; tissue < removed_levels_.size(); ++tissue) {
    all += removed_levels_[tissue];
    removed_m3_[1 + tissue] = volume_m3(removed_levels_[tissue]);
  }
  removed_m3_[0] = volume_m3(all);
  server_.send_to_all(messages_.sample({.tick = report.record,
                                        .cutting = scene_.cutting ? &report.cutting : nullptr,
                                        .removed_m3 = removed_m3_,
                                        .hand = scene_.device || scene_.coupling}),
                      StreamKind::kSample);
}

/// Where it is another than was told last.
void StreamThread::tell_state() {
  const bool paused = options_.paused && *options_.paused;
  StreamState state = StreamState::kRunning;
  if (faults_told_ != 0) state = StreamState::kFault;
  if (paused) state = StreamState::kPaused;
  std::string text = text_of(state, faults_told_);
  if (state == state_ && text == text_) return;
  state_ = state;
  text_ = std::move(text);
  greeting_ = messages_.state(state_, last_.tick, last_.time_s, text_);
  if (greeting_) server_.send_to_all(greeting_, StreamKind::kNews);
}

void StreamThread::take_requests() {
  for (StreamServer::Asked& asked : server_.take_requests()) {
    const std::string &type = asked.request.type, &device = asked.request.device;
    const auto answer = [&](const StreamBytes& bytes) {
      server_.send_to(asked.client, bytes, StreamKind::kNews);
    };
    const StreamSettings& names = *scene_.stream;
    const auto is_named = [&](const std::string& name) {
      return !name.empty() && (device.empty() || device == name);
    };
    if (type == "CAPABIL") {
      answer(capability(device));
    } else if (type == "STATUS" && is_named(names.state)) {
      answer(greeting_);
    } else if ((type == "POLYDATA" || type == "IMAGE") && is_named(names.tooth)) {
      if (may_ask_for_tooth(asked)) wanted_.push_back(std::move(asked));
    } else {
      answer(no_data(type, device));
    }
  }
}

/// Each type once at a time, until it is sent: who asks without end gets no end of memory.
bool StreamThread::may_ask_for_tooth(const StreamServer::Asked& asked) const {
  const bool waits = std::ranges::any_of(wanted_, [&](const StreamServer::Asked& other) {
    return other.client == asked.client && other.request.type == asked.request.type;
  });
  const bool is_made = in_work_ && in_work_->type == asked.request.type &&
                       std::ranges::count(in_work_->clients, asked.client) > 0;
  constexpr std::size_t kTypes = 2;
  return !waits && !is_made && server_.answers_waiting(asked.client) < kTypes;
}

/// Takes what is made to those who asked for it, and begins with the next.
void StreamThread::make_teeth() {
  if (in_work_ && in_work_->bytes.wait_for(milliseconds(0)) == std::future_status::ready) {
    StreamBytes bytes = in_work_->bytes.get();
    if (!bytes) bytes = no_data(in_work_->type, scene_.stream->tooth);
    for (const std::uint64_t client : in_work_->clients) {
      server_.send_to(client, bytes, StreamKind::kAnswer);
    }
    in_work_.reset();
  }
  if (in_work_ || wanted_.empty()) return;
  in_work_.emplace();
  in_work_->type = wanted_.front().request.type;
  std::erase_if(wanted_, [&](const StreamServer::Asked& asked) {
    if (asked.request.type != in_work_->type) return false;
    in_work_->clients.push_back(asked.client);
    return true;
  });
  in_work_->bytes = std::async(
      std::launch::async,
      [model = *model_, type = in_work_->type, name = scene_.stream->tooth,
       time = message_time(last_.time_s)] { return make_tooth(model, type, name, time); });
}

}  // namespace sulcus
