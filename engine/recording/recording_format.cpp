#include "engine/recording/recording_format.hpp"

#include <stdexcept>
#include <string>
#include <string_view>

#include "engine/core/hash.hpp"
#include "engine/recording/recording_layout.hpp"
#include "engine/recording/tick_record.hpp"

namespace sulcus {
namespace {

hid_t stored_type(StoredType type) {
  switch (type) {
    case StoredType::kU8:
      return H5T_STD_U8LE;
    case StoredType::kU16:
      return H5T_STD_U16LE;
    case StoredType::kU32:
      return H5T_STD_U32LE;
    case StoredType::kU64:
      return H5T_STD_U64LE;
    case StoredType::kF32:
      return H5T_IEEE_F32LE;
    case StoredType::kF64:
      return H5T_IEEE_F64LE;
    case StoredType::kText:
      break;
  }
  throw std::logic_error("rows hold no text");
}

/// The columns of a table of the layout, one after another: as `bytes` bytes lie in memory.
Hdf5Handle row_type(std::string_view path, std::size_t bytes) {
  const StoredPart* table = find_stored_part(path);
  Hdf5Handle row = hdf5_checked(H5Tcreate(H5T_COMPOUND, bytes), H5Tclose, "row type");
  std::size_t offset = 0;
  for (const StoredField& field : table->fields) {
    const std::string name(field.name);
    hid_t type = stored_type(field.type);
    Hdf5Handle array;
    if (field.count > 1) {
      const hsize_t length = field.count;
      array = hdf5_checked(H5Tarray_create2(type, 1, &length), H5Tclose, "row type");
      type = array;
    }
    hdf5_check(H5Tinsert(row, name.c_str(), offset, type), name.c_str());
    offset += field.count * bytes_of(field.type);
  }
  if (offset != bytes) throw std::logic_error(std::string(path) + ": not as its rows in memory");
  return row;
}

}  // namespace

std::uint64_t check_of(const StateHashRow& row) {
  return hash_bytes(&row, offsetof(StateHashRow, check));
}

std::uint64_t check_of(const KeyframeRow& row) {
  return hash_bytes(&row, offsetof(KeyframeRow, check));
}

std::uint64_t check_of(const EndRow& row) { return hash_bytes(&row, offsetof(EndRow, check)); }

std::uint64_t check_of(const SummaryCheckRow& row) {
  return hash_bytes(&row, offsetof(SummaryCheckRow, check));
}

std::uint32_t check_of(const EditRow& row) {
  return static_cast<std::uint32_t>(hash_bytes(&row, offsetof(EditRow, check)));
}

EditRow packed(const Edit& edit) {
  EditRow row{edit.tick, edit.body, edit.voxel, static_cast<std::uint8_t>(edit.cause), 0};
  row.check = check_of(row);
  return row;
}

bool is_intact(const EditRow& row, std::span<const VoxelGrid> grids) {
  return row.check == check_of(row) && row.cause <= static_cast<std::uint8_t>(EditCause::kUndo) &&
         row.body < grids.size() && row.voxel < grids[row.body].cell_count() &&
         (row.body == 0 || row.cause != static_cast<std::uint8_t>(EditCause::kLoose));
}

Hdf5Handle tick_type() { return row_type("/ticks", sizeof(TickRecord)); }
Hdf5Handle cutting_type() { return row_type("/cutting", sizeof(CuttingRecord)); }
Hdf5Handle port_type() { return row_type("/port", sizeof(PortRecord)); }
Hdf5Handle piece_type() { return row_type("/pieces", sizeof(PieceRow)); }
Hdf5Handle piece_pose_type() { return row_type("/piece_poses", sizeof(PiecePoseRow)); }
Hdf5Handle taken_answer_type() { return row_type("/taken_answers", sizeof(TakenAnswerRow)); }
Hdf5Handle edit_type() { return row_type("/edits", sizeof(EditRow)); }
Hdf5Handle state_hash_type() { return row_type("/state_hashes", sizeof(StateHashRow)); }
Hdf5Handle keyframe_type() { return row_type("/keyframe_index", sizeof(KeyframeRow)); }
Hdf5Handle end_type() { return row_type("/end", sizeof(EndRow)); }
Hdf5Handle summary_check_type() { return row_type("/summary_check", sizeof(SummaryCheckRow)); }

std::uint64_t header_check(const RecordingHeader& header) {
  std::uint64_t hash = hash_bytes(&header.version, sizeof header.version);
  const auto add = [&](const std::string& text) {
    const std::uint64_t length = text.size();
    hash = hash_bytes(&length, sizeof length, hash);
    hash = hash_bytes(text.data(), text.size(), hash);
  };
  for (const std::string* text : {&header.scene_toml, &header.scene_sha256, &header.build}) {
    add(*text);
  }
  if (header.version > 1) {
    add(header.parent);
    add(header.repaired);
  }
  hash = hash_bytes(&header.rate_hz, sizeof header.rate_hz, hash);
  return hash_bytes(&header.workpiece_hash, sizeof header.workpiece_hash, hash);
}

}  // namespace sulcus
