#include "engine/recording/recording_format.hpp"

#include <stdexcept>
#include <string>

#include "engine/recording/recording_layout.hpp"

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

}  // namespace

Hdf5Handle row_type(const RowTable& table, std::size_t bytes) {
  const StoredPart* part = find_stored_part(std::string("/") + table.name);
  Hdf5Handle row = hdf5_checked(H5Tcreate(H5T_COMPOUND, bytes), H5Tclose, "row type");
  std::size_t offset = 0;
  for (const StoredField& field : part->fields) {
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
  if (offset != bytes) throw std::logic_error(std::string(table.name) + ": not as in memory");
  return row;
}

EditRow packed(const Edit& edit) {
  return sealed(
      EditRow{edit.tick, edit.body, edit.voxel, static_cast<std::uint8_t>(edit.cause), 0});
}

FillRow packed_fill(const Edit& edit) {
  return sealed(FillRow{edit.tick, edit.body, edit.voxel, edit.level, 0});
}

Edit unpacked(const EditRow& row) {
  return {row.tick, row.voxel, row.body, static_cast<EditCause>(row.cause)};
}

Edit unpacked(const FillRow& row) {
  return {row.tick, row.voxel, row.body, EditCause::kCut, row.level};
}

bool is_intact(const EditRow& row, std::span<const VoxelGrid> grids) {
  return is_sealed(row) && row.cause <= static_cast<std::uint8_t>(EditCause::kUndo) &&
         row.body < grids.size() && row.voxel < grids[row.body].cell_count() &&
         (row.body == 0 || row.cause != static_cast<std::uint8_t>(EditCause::kLoose));
}

bool is_intact(const FillRow& row, std::span<const VoxelGrid> grids,
               const std::vector<bool>& filled) {
  return is_sealed(row) && row.level % kFullLevel != 0 && row.body < grids.size() &&
         filled[row.body] && row.voxel < grids[row.body].cell_count();
}

}  // namespace sulcus
