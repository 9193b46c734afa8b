#pragma once

#include <cstdint>
#include <string>

namespace sulcus {

/// The layout that is written. Version 1 had no keyframes, no parent and no gaps; it is still read.
inline constexpr std::uint32_t kRecordingVersion = 2;

/// What a recording says about itself: its root attributes, beside `format`.
struct RecordingHeader {
  std::string scene_toml;    // attribute `scene`: the TOML as run
  std::string scene_sha256;  // 64 hexadecimal digits
  std::string build;         // which program wrote it
  double rate_hz = 0.0;      // ticks per second
  std::uint64_t workpiece_hash =
      0;                      // of the workpiece at the start, as the program that ran has it
  std::string parent = {};    // of one that goes on from another: from which, and where; else empty
  std::string repaired = {};  // of a repaired copy: what was missing in the original; else empty
  std::uint32_t version = kRecordingVersion;
};

/// Data sets that a recording has only where the scene names what is in them, or the device has it.
struct RecordingTables {
  bool cutting = false;  // /cutting
  bool port = false;     // /port
  bool pieces = false;   // /pieces, /piece_poses, /taken_answers
  bool pedal = false;    // /pedal
};

/// Hashes of the state right after a tick, from which a replay is verified.
struct StateHash {
  std::uint64_t tick = 0;
  std::uint64_t volume = 0;
  std::uint64_t state = 0;
};

/// The state right after a tick, without the bodies' voxels: those follow from the edits.
struct KeyframeInfo {
  std::uint64_t tick = 0;
  std::uint64_t offset = 0, bytes = 0;  // in /keyframes
  std::uint64_t content = 0;            // XXH3-64 of the bytes
};

/// Ticks whose rows were not recorded, since the disk did not keep up: `first` to before `end`.
struct RecordingGap {
  std::uint64_t first = 0, end = 0;
};

}  // namespace sulcus
