#include "engine/recording/recording_format.hpp"

#include "engine/core/hash.hpp"
#include "engine/recording/tick_record.hpp"

namespace sulcus {
namespace {

Hdf5Handle compound(std::size_t bytes) {
  return hdf5_checked(H5Tcreate(H5T_COMPOUND, bytes), H5Tclose, "row type");
}

void field(const Hdf5Handle& row, const char* name, std::size_t offset, hid_t type) {
  hdf5_check(H5Tinsert(row, name, offset, type), name);
}

void vector_field(const Hdf5Handle& row, const char* name, std::size_t offset, hsize_t length) {
  const auto array =
      hdf5_checked(H5Tarray_create2(H5T_IEEE_F64LE, 1, &length), H5Tclose, "row type");
  field(row, name, offset, array);
}

}  // namespace

std::uint64_t check_of(const StateHashRow& row) {
  return hash_bytes(&row, offsetof(StateHashRow, check));
}

std::uint64_t check_of(const KeyframeRow& row) {
  return hash_bytes(&row, offsetof(KeyframeRow, check));
}

std::uint64_t check_of(const EndRow& row) { return hash_bytes(&row, offsetof(EndRow, check)); }

std::uint32_t check_of(const EditRow& row) {
  return static_cast<std::uint32_t>(hash_bytes(&row, offsetof(EditRow, check)));
}

EditRow packed(const Edit& edit) {
  EditRow row{edit.tick, edit.body, edit.voxel, static_cast<std::uint8_t>(edit.cause), 0};
  row.check = check_of(row);
  return row;
}

Hdf5Handle tick_type() {
  Hdf5Handle row = compound(sizeof(TickRecord));
  field(row, "tick", offsetof(TickRecord, tick), H5T_STD_U64LE);
  field(row, "time_s", offsetof(TickRecord, time_s), H5T_IEEE_F64LE);
  vector_field(row, "device_position_m", offsetof(TickRecord, device_position_m), 3);
  vector_field(row, "device_orientation", offsetof(TickRecord, device_orientation), 4);
  vector_field(row, "tool_position_m", offsetof(TickRecord, tool_position_m), 3);
  vector_field(row, "tool_orientation", offsetof(TickRecord, tool_orientation), 4);
  vector_field(row, "force_N", offsetof(TickRecord, force_N), 3);
  vector_field(row, "torque_Nm", offsetof(TickRecord, torque_Nm), 3);
  vector_field(row, "contact_force_N", offsetof(TickRecord, contact_force_N), 3);
  vector_field(row, "contact_torque_Nm", offsetof(TickRecord, contact_torque_Nm), 3);
  field(row, "contacts", offsetof(TickRecord, contacts), H5T_STD_U32LE);
  field(row, "tested", offsetof(TickRecord, tested), H5T_STD_U32LE);
  field(row, "leaves", offsetof(TickRecord, leaves), H5T_STD_U32LE);
  field(row, "removed", offsetof(TickRecord, removed), H5T_STD_U32LE);
  field(row, "step_us", offsetof(TickRecord, step_us), H5T_IEEE_F32LE);
  field(row, "late_us", offsetof(TickRecord, late_us), H5T_IEEE_F32LE);
  field(row, "faults", offsetof(TickRecord, faults), H5T_STD_U64LE);
  field(row, "edits_end", offsetof(TickRecord, edits_end), H5T_STD_U64LE);
  field(row, "check", offsetof(TickRecord, check), H5T_STD_U64LE);
  return row;
}

Hdf5Handle cutting_type() {
  Hdf5Handle row = compound(sizeof(CuttingRecord));
  field(row, "tick", offsetof(CuttingRecord, tick), H5T_STD_U64LE);
  vector_field(row, "tangential_force_N", offsetof(CuttingRecord, tangential_force_N), 3);
  vector_field(row, "tangential_torque_Nm", offsetof(CuttingRecord, tangential_torque_Nm), 3);
  field(row, "spindle_rad_per_s", offsetof(CuttingRecord, spindle_rad_per_s), H5T_IEEE_F64LE);
  field(row, "work_J", offsetof(CuttingRecord, work_J), H5T_IEEE_F64LE);
  field(row, "check", offsetof(CuttingRecord, check), H5T_STD_U64LE);
  return row;
}

Hdf5Handle port_type() {
  Hdf5Handle row = compound(sizeof(PortRecord));
  field(row, "tick", offsetof(PortRecord, tick), H5T_STD_U64LE);
  vector_field(row, "asked_force_N", offsetof(PortRecord, asked_force_N), 3);
  vector_field(row, "asked_torque_Nm", offsetof(PortRecord, asked_torque_Nm), 3);
  field(row, "absorbed_J", offsetof(PortRecord, absorbed_J), H5T_IEEE_F64LE);
  field(row, "given_out_J", offsetof(PortRecord, given_out_J), H5T_IEEE_F64LE);
  field(row, "dissipated_J", offsetof(PortRecord, dissipated_J), H5T_IEEE_F64LE);
  field(row, "evaluations", offsetof(PortRecord, evaluations), H5T_STD_U64LE);
  field(row, "check", offsetof(PortRecord, check), H5T_STD_U64LE);
  return row;
}

Hdf5Handle piece_type() {
  Hdf5Handle row = compound(sizeof(PieceRow));
  field(row, "piece", offsetof(PieceRow, piece), H5T_STD_U64LE);
  field(row, "tick", offsetof(PieceRow, tick), H5T_STD_U64LE);
  field(row, "first_loose_edit", offsetof(PieceRow, first_loose_edit), H5T_STD_U64LE);
  field(row, "voxels", offsetof(PieceRow, voxels), H5T_STD_U64LE);
  field(row, "check", offsetof(PieceRow, check), H5T_STD_U64LE);
  return row;
}

Hdf5Handle piece_pose_type() {
  Hdf5Handle row = compound(sizeof(PiecePoseRow));
  field(row, "tick", offsetof(PiecePoseRow, tick), H5T_STD_U64LE);
  field(row, "piece", offsetof(PiecePoseRow, piece), H5T_STD_U64LE);
  vector_field(row, "position_m", offsetof(PiecePoseRow, position_m), 3);
  vector_field(row, "orientation", offsetof(PiecePoseRow, orientation), 4);
  field(row, "check", offsetof(PiecePoseRow, check), H5T_STD_U64LE);
  return row;
}

Hdf5Handle taken_answer_type() {
  Hdf5Handle row = compound(sizeof(TakenAnswerRow));
  field(row, "asked", offsetof(TakenAnswerRow, asked), H5T_STD_U64LE);
  field(row, "taken", offsetof(TakenAnswerRow, taken), H5T_STD_U64LE);
  field(row, "check", offsetof(TakenAnswerRow, check), H5T_STD_U64LE);
  return row;
}

Hdf5Handle edit_type() {
  Hdf5Handle row = compound(sizeof(EditRow));
  field(row, "tick", offsetof(EditRow, tick), H5T_STD_U64LE);
  field(row, "body", offsetof(EditRow, body), H5T_STD_U16LE);
  field(row, "voxel", offsetof(EditRow, voxel), H5T_STD_U32LE);
  field(row, "cause", offsetof(EditRow, cause), H5T_STD_U8LE);
  field(row, "check", offsetof(EditRow, check), H5T_STD_U32LE);
  return row;
}

Hdf5Handle state_hash_type() {
  Hdf5Handle row = compound(sizeof(StateHashRow));
  field(row, "tick", offsetof(StateHashRow, tick), H5T_STD_U64LE);
  field(row, "volume", offsetof(StateHashRow, volume), H5T_STD_U64LE);
  field(row, "state", offsetof(StateHashRow, state), H5T_STD_U64LE);
  field(row, "check", offsetof(StateHashRow, check), H5T_STD_U64LE);
  return row;
}

Hdf5Handle keyframe_type() {
  Hdf5Handle row = compound(sizeof(KeyframeRow));
  field(row, "tick", offsetof(KeyframeRow, tick), H5T_STD_U64LE);
  field(row, "offset", offsetof(KeyframeRow, offset), H5T_STD_U64LE);
  field(row, "bytes", offsetof(KeyframeRow, bytes), H5T_STD_U64LE);
  field(row, "content", offsetof(KeyframeRow, content), H5T_STD_U64LE);
  field(row, "check", offsetof(KeyframeRow, check), H5T_STD_U64LE);
  return row;
}

Hdf5Handle end_type() {
  Hdf5Handle row = compound(sizeof(EndRow));
  field(row, "ticks", offsetof(EndRow, ticks), H5T_STD_U64LE);
  field(row, "edits", offsetof(EndRow, edits), H5T_STD_U64LE);
  field(row, "state_hashes", offsetof(EndRow, state_hashes), H5T_STD_U64LE);
  field(row, "check", offsetof(EndRow, check), H5T_STD_U64LE);
  return row;
}

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
