#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/stream/stream_client.hpp"
#include "engine/recording/tick_record.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

// What a run sends, as messages of OpenIGTLink, version 1 of its header, packed by its library.
//
// - Time: the stamp of a header is the run's time of the tick, in 2^-32 s from the first tick on,
//   so that stamp times rate_hz, rounded, is the number of the tick. All messages of one tick have
//   the same.
// - Space: the scene's, in mm, with nothing turned or mirrored.

/// What of a tick is sent.
struct StreamSample {
  const TickRecord& tick;
  const CuttingRecord* cutting = nullptr;   // with [cutting]
  std::span<const double> removed_m3 = {};  // with [cutting]: in all, then by tissue
  bool hand = false;                        // with [device] or [coupling]
};

enum class StreamState : std::uint8_t { kRunning, kPaused, kFault, kOver };

/// Packs messages, again and again in the memory of the last ones. Of one thread.
class StreamMessages {
 public:
  explicit StreamMessages(StreamSettings names);
  ~StreamMessages();
  StreamMessages(const StreamMessages&) = delete;
  StreamMessages& operator=(const StreamMessages&) = delete;

  /// All messages of a tick after one another: its number, then poses, forces and the rest, but for
  /// those without a name.
  StreamBytes sample(const StreamSample& sample);
  /// STATUS; its sub-code is the tick. `text`: more of it, for people. Null without a name.
  StreamBytes state(StreamState state, std::uint64_t tick, double time_s, const std::string& text);

 private:
  struct Packed;  // of the library
  void add_sensor(const std::string& name, std::span<const double> values, std::uint64_t unit_code);
  void add_pose(const std::string& name, const double (&position_m)[3],
                const double (&orientation)[4]);

  StreamSettings names_;
  std::unique_ptr<Packed> packed_;
};

/// The name of a state in STATUS.
std::string_view name_of(StreamState state);

}  // namespace sulcus
