#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/recording/hdf5_handle.hpp"
#include "engine/recording/tick_record.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

// The layout of a recording, shared by the writer and the reader:
//
//   recording_layout.hpp  every attribute, data set and column
//   recording_parts.hpp   what never changes: header, solids, burr, what came before
//
// Data sets of rows have one dimension, are extensible and have no filters. A row of /ticks that
// does not follow on the one before it has the fault kFaultRowsDropped; the edits of the ticks
// between are there. Keyframes (haptics/saved_state.hpp) are written every so many ticks, after
// each gap, and before the first row of a recording that goes on from another. /summary, which is
// empty until then, and /end are written when the recording is closed.
//
// Texts are of fixed length: HDF5 keeps those of variable length in a heap without checksums, and
// 1.10.8 writes beyond its buffer when a size in that heap is damaged.

#pragma pack(push, 1)
/// A row of /edits.
struct EditRow {
  std::uint64_t tick = 0;
  std::uint16_t body = 0;
  std::uint32_t voxel = 0;
  std::uint8_t cause = 0;
  std::uint32_t check = 0;  // low half of XXH3-64 of the bytes before it
};

/// A row of /fills.
struct FillRow {
  std::uint64_t tick = 0;
  std::uint16_t body = 0;
  std::uint32_t voxel = 0;
  std::uint8_t level = 0;   // 1 to 254
  std::uint32_t check = 0;  // low half of XXH3-64 of the bytes before it
};
#pragma pack(pop)
static_assert(sizeof(EditRow) == 19 && sizeof(FillRow) == 19);

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

/// Where the rows of a type are, and how many of them a chunk holds. A flush writes the last chunk
/// whole, so it is about as long as 50 ms of rows.
struct RowTable {
  const char* name = nullptr;
  hsize_t chunk_rows = 1;
};
template <class Row>
inline constexpr RowTable kRowTable;
template <>
inline constexpr RowTable kRowTable<TickRecord>{"ticks", 128};
template <>
inline constexpr RowTable kRowTable<CuttingRecord>{"cutting", 128};
template <>
inline constexpr RowTable kRowTable<PortRecord>{"port", 128};
template <>
inline constexpr RowTable kRowTable<PieceRow>{"pieces", 128};
template <>
inline constexpr RowTable kRowTable<PiecePoseRow>{"piece_poses", 128};
template <>
inline constexpr RowTable kRowTable<TakenAnswerRow>{"taken_answers", 128};
template <>
inline constexpr RowTable kRowTable<PedalRow>{"pedal", 128};
template <>
inline constexpr RowTable kRowTable<EditRow>{"edits", 1024};
template <>
inline constexpr RowTable kRowTable<FillRow>{"fills", 1024};
template <>
inline constexpr RowTable kRowTable<FillEndRow>{"fill_ends", 128};
template <>
inline constexpr RowTable kRowTable<StateHashRow>{"state_hashes", 512};
template <>
inline constexpr RowTable kRowTable<KeyframeRow>{"keyframe_index", 16};
template <>
inline constexpr RowTable kRowTable<EndRow>{"end"};
template <>
inline constexpr RowTable kRowTable<SummaryCheckRow>{"summary_check"};

/// Data sets of bytes: the states, and summary.json.
inline constexpr RowTable kKeyframeBytes{"keyframes", 1u << 14};
inline constexpr RowTable kSummaryBytes{"summary", 1u << 13};

/// Of an edit by which a voxel went, and of one that lowered its level.
EditRow packed(const Edit& edit);
FillRow packed_fill(const Edit& edit);
Edit unpacked(const EditRow& row);
Edit unpacked(const FillRow& row);
/// Whether its check fits and it is of a voxel of these bodies, the workpiece first.
bool is_intact(const EditRow& row, std::span<const VoxelGrid> grids);
/// The same, also of a level that there may be; `filled`: which bodies carry fractions.
bool is_intact(const FillRow& row, std::span<const VoxelGrid> grids,
               const std::vector<bool>& filled);

/// The type of the rows of a table, in memory and in the file alike: packed, little-endian, as the
/// layout has them. std::logic_error where that is not `bytes` long.
Hdf5Handle row_type(const RowTable& table, std::size_t bytes);
template <class Row>
Hdf5Handle row_type() {
  return row_type(kRowTable<Row>, sizeof(Row));
}
template <>
inline Hdf5Handle row_type<std::byte>() {
  return hdf5_checked(H5Tcopy(H5T_STD_U8LE), H5Tclose, "type");
}

}  // namespace sulcus
