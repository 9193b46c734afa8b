#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "engine/recording/hdf5_handle.hpp"
#include "engine/recording/recording_header.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

// The layout of a recording, shared by the writer and the reader:
//
//   recording_layout.hpp     every attribute, data set and column
//   recording_workpiece.hpp  the solids and the burr
//   earlier_part.hpp         what came before the first tick of one that goes on from another
//
// Data sets of rows have one dimension, are extensible and have no filters. A row of /ticks that
// does not follow on the one before it has the fault kFaultRowsDropped; the edits of the ticks
// between are there. Keyframes (haptics/saved_state.hpp) are written every so many ticks, after
// each gap, and before the first row of a recording that goes on from another. /summary, which is
// empty until then, and /end are written when the recording is closed.
//
// Texts are of fixed length: HDF5 keeps those of variable length in a heap without checksums, and
// 1.10.8 writes beyond its buffer when a size in that heap is damaged.

inline constexpr char kFormatName[] = "sulcus-recording";

// Rows per chunk. A flush writes the last chunk whole, so it is about as long as 50 ms of rows.
inline constexpr hsize_t kTickChunk = 128;
inline constexpr hsize_t kCuttingChunk = 128;
inline constexpr hsize_t kPortChunk = 128;
inline constexpr hsize_t kPieceChunk = 128;
inline constexpr hsize_t kEditChunk = 1024;
inline constexpr hsize_t kStateHashChunk = 512;
inline constexpr hsize_t kKeyframeChunk = 16;        // of the index
inline constexpr hsize_t kKeyframeBytes = 1u << 14;  // of the states
inline constexpr hsize_t kSummaryBytes = 1u << 13;

#pragma pack(push, 1)
/// A row of /edits.
struct EditRow {
  std::uint64_t tick = 0;
  std::uint16_t body = 0;
  std::uint32_t voxel = 0;
  std::uint8_t cause = 0;
  std::uint32_t check = 0;  // low half of XXH3-64 of the bytes before it
};
#pragma pack(pop)
static_assert(sizeof(EditRow) == 19);

/// A row of /state_hashes.
struct StateHashRow {
  std::uint64_t tick = 0;
  std::uint64_t volume = 0;
  std::uint64_t state = 0;
  std::uint64_t check = 0;  // XXH3-64 of the bytes before it
};
static_assert(sizeof(StateHashRow) == 32);

/// A row of /keyframe_index.
struct KeyframeRow {
  std::uint64_t tick = 0;
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::uint64_t content = 0;  // XXH3-64 of the bytes
  std::uint64_t check = 0;    // XXH3-64 of the bytes before it
};
static_assert(sizeof(KeyframeRow) == 40);

/// The row of /end; all zero until the recording is closed. (No attribute or data set can be added
/// once other processes may read.)
struct EndRow {
  std::uint64_t ticks = 0;
  std::uint64_t edits = 0;
  std::uint64_t state_hashes = 0;
  std::uint64_t check = 0;  // XXH3-64 of the bytes before it
};
static_assert(sizeof(EndRow) == 32);

/// The row of /summary_check; all zero until the summary is written.
struct SummaryCheckRow {
  std::uint64_t bytes = 0;    // of /summary
  std::uint64_t content = 0;  // XXH3-64 of them
  std::uint64_t check = 0;    // XXH3-64 of the bytes before it
};
static_assert(sizeof(SummaryCheckRow) == 24);

/// XXH3-64 of what stands before the row's `check`.
std::uint64_t check_of(const StateHashRow& row);
std::uint64_t check_of(const KeyframeRow& row);
std::uint64_t check_of(const EndRow& row);
std::uint64_t check_of(const SummaryCheckRow& row);
/// The low half of it.
std::uint32_t check_of(const EditRow& row);

EditRow packed(const Edit& edit);
/// Whether its check fits and it is of a voxel of these bodies, the workpiece first.
bool is_intact(const EditRow& row, std::span<const VoxelGrid> grids);

/// The types of the rows, in memory and in the file alike: packed, little-endian, as the layout has
/// them.
Hdf5Handle tick_type();
Hdf5Handle cutting_type();
Hdf5Handle port_type();
Hdf5Handle piece_type();
Hdf5Handle piece_pose_type();
Hdf5Handle taken_answer_type();
Hdf5Handle edit_type();
Hdf5Handle state_hash_type();
Hdf5Handle keyframe_type();
Hdf5Handle end_type();
Hdf5Handle summary_check_type();

/// What the attribute `header_check` holds for a header of its version.
std::uint64_t header_check(const RecordingHeader& header);

}  // namespace sulcus
