#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "app/session/feed_thread.hpp"
#include "app/session/session.hpp"
#include "app/session/simulation.hpp"
#include "app/stream/stream_messages.hpp"
#include "app/stream/stream_server.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Sends the run to who has connected, while it goes on: rate_hz samples a second of its time, its
/// state, and the tooth to who asks for it. Clients are never waited for but at the end, those
/// that still take what waits for them, for 5 s at most. The tooth is meshed on a thread of its
/// own, one at a time.
class StreamThread {
 public:
  /// The scene has [stream], and the options its port. Of the simulation it keeps the scene, which
  /// outlives it, as do the options.
  StreamThread(Feed& feed, const Simulation& simulation, const SessionOptions& options);

  /// As FeedThread: waits until the last sample is sent.
  void finish() { thread_.finish(); }
  // After `finish`.
  const StreamResult& result() const { return result_; }
  double seconds() const { return seconds_; }  // of processor time
  std::size_t memory_bytes() const { return memory_bytes_; }

 private:
  /// A tooth that is being made for those who asked for it.
  struct ToothInWork {
    std::string type, name;
    std::vector<std::uint64_t> clients;
    std::future<StreamBytes> bytes;
  };

  void run();
  /// False where more of them wait.
  bool take_ticks();
  void take_edit(const Edit& edit);
  bool is_due(std::uint64_t tick);
  void send_sample(const TickReport& report);
  void tell_state();
  void take_requests();
  bool may_ask_for_tooth(const StreamServer::Asked& asked) const;
  void make_teeth();

  Feed& feed_;
  const Scene& scene_;
  const SessionOptions& options_;
  StreamServer server_;
  StreamMessages messages_;
  double voxel_m3_;
  std::optional<VoxelModel> model_;  // as of the last tick taken; where anything is asked of it
  std::vector<double> removed_m3_;   // in all, then by tissue
  std::vector<std::uint64_t> removed_levels_;  // by tissue
  TickRecord last_;                            // taken
  std::uint64_t edits_ = 0;                    // taken
  std::uint64_t samples_due_ = ~std::uint64_t{0};
  std::uint64_t faults_ = 0, faults_told_ = 0;  // since the last sample; with the last one
  StreamState state_ = StreamState::kRunning;   // told last, with `text_`
  std::string text_;
  StreamBytes greeting_;
  std::deque<StreamServer::Asked> wanted_;  // teeth
  std::optional<ToothInWork> in_work_;
  StreamResult result_;
  double seconds_ = 0.0;
  std::size_t memory_bytes_ = 0;
  FeedThread thread_;
};

}  // namespace sulcus
