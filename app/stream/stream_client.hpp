#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/stream/stream_port.hpp"

namespace sulcus {

/// One or more messages as they are sent; shared by all clients that they are for.
using StreamBytes = std::shared_ptr<const std::vector<std::byte>>;

/// What may be left out for a client that does not keep up.
enum class StreamKind : std::uint8_t {
  kSample,  // the oldest
  kNews,    // the oldest of many
  kAnswer,  // never: it was asked for, and each is asked for once at a time
};

/// What a client asks for: the message type after GET_, and the name of a device, which may be
/// empty. Both are whatever the client has sent.
struct StreamRequest {
  std::string type, device;
};

/// A client of a run: what waits to be sent to it, what it asks for. It is never waited for. Of the
/// thread that streams.
class StreamClient {
 public:
  /// Beyond `most_samples` that wait the oldest is dropped.
  StreamClient(Socket socket, std::uint64_t number, std::size_t most_samples);

  std::uint64_t number() const { return number_; }
  int descriptor() const { return socket_.descriptor(); }

  void push(StreamBytes bytes, StreamKind kind);
  bool has_to_send() const { return !queue_.empty(); }
  /// Sends as much as the system takes at once. False: the client has gone, or has taken nothing
  /// for `kLongestSilence_s`.
  [[nodiscard]] bool send();
  /// Reads what has come. A message's body is passed over as it comes: what a header says of its
  /// size costs no memory. False: the client has gone, or what it sends is no OpenIGTLink.
  [[nodiscard]] bool receive(std::vector<StreamRequest>& requests);

  /// Of kAnswer.
  std::size_t answers_waiting() const { return waiting_answers_; }
  std::uint64_t samples() const { return samples_; }
  /// With those that still wait: of a client that has gone.
  std::uint64_t unsent() const { return dropped_ + waiting_samples_; }
  /// Since the client has last taken anything, while there was something for it.
  double silence_s() const;

  static constexpr double kLongestSilence_s = 10.0;

 private:
  struct Entry {
    StreamBytes bytes;
    StreamKind kind;
  };
  void drop_oldest(StreamKind kind);
  bool take(std::span<const std::byte> bytes, std::vector<StreamRequest>& requests);
  bool take_header(std::vector<StreamRequest>& requests);

  static constexpr std::size_t kHeaderBytes = 58;

  Socket socket_;
  std::uint64_t number_;
  std::size_t most_samples_;
  std::deque<Entry> queue_;
  std::size_t sent_ = 0;  // bytes of the first
  std::size_t waiting_samples_ = 0, waiting_news_ = 0, waiting_answers_ = 0;
  std::uint64_t samples_ = 0, dropped_ = 0;
  std::uint64_t taken_ns_;  // when it has last taken something, or had nothing to take
  std::array<std::byte, kHeaderBytes> header_{};
  std::size_t header_filled_ = 0;
  std::uint64_t body_left_ = 0;  // to be passed over
};

}  // namespace sulcus
