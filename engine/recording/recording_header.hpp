#pragma once

#include <cstdint>
#include <string>

namespace sulcus {

/// What a recording says about itself: its root attributes, beside `format` and `version`.
struct RecordingHeader {
  std::string scene_toml;    // attribute `scene`: the TOML as run
  std::string scene_sha256;  // 64 hexadecimal digits
  std::string build;         // which program wrote it
  double rate_hz = 0.0;      // ticks per second
  std::uint64_t workpiece_hash =
      0;  // of the workpiece at the start, as the program that ran has it
};

/// Hashes of the state right after a tick, from which a replay is verified.
struct StateHash {
  std::uint64_t tick = 0;
  std::uint64_t volume = 0;
  std::uint64_t state = 0;
};

}  // namespace sulcus
