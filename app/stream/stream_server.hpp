#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "app/stream/stream_client.hpp"
#include "app/stream/stream_port.hpp"

namespace sulcus {

/// The clients of a run, several at once or one after the other. Nothing here waits for any of
/// them: what one does not take in time it does not get. Of the thread that streams; the port
/// outlives it.
class StreamServer {
 public:
  /// `most_samples`: that wait for one client.
  StreamServer(const StreamPort& port, std::size_t most_samples)
      : port_(port), most_samples_(most_samples) {}

  /// Sleeps until there is something to do, at most so long, and does it: lets clients in, who get
  /// `greeting` first, reads what they ask for, sends what waits for them.
  void serve(std::chrono::milliseconds longest, const StreamBytes& greeting);
  /// Those that have come since the last call, with the number of their client.
  struct Asked {
    std::uint64_t client;
    StreamRequest request;
  };
  std::vector<Asked> take_requests() { return std::exchange(requests_, {}); }

  bool has_clients() const { return !clients_.empty(); }
  void send_to_all(const StreamBytes& bytes, StreamKind kind);
  /// Nothing where that client has gone.
  void send_to(std::uint64_t client, const StreamBytes& bytes, StreamKind kind);
  /// Of kAnswer, for that client.
  std::size_t answers_waiting(std::uint64_t client) const;
  /// Sends what still waits, no longer than `longest` and to nobody who takes nothing for a
  /// quarter of a second, and lets all clients go.
  void finish(std::chrono::milliseconds longest);

  // So far.
  std::uint64_t clients() const { return came_; }
  std::uint64_t samples() const;
  std::uint64_t dropped() const;

 private:
  bool let_in(const StreamBytes& greeting);
  void let_go(std::size_t index);

  const StreamPort& port_;
  std::size_t most_samples_;
  std::vector<std::unique_ptr<StreamClient>> clients_;
  std::vector<Asked> requests_;
  std::uint64_t came_ = 0, samples_of_gone_ = 0, dropped_of_gone_ = 0;
};

}  // namespace sulcus
