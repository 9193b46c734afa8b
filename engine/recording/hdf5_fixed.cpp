#include "engine/recording/hdf5_fixed.hpp"

#include <algorithm>

#include "engine/recording/hdf5_storage.hpp"

namespace sulcus {
namespace {

// Small, as readers want packed ones (hdf5_storage.hpp).
constexpr hsize_t kChunkBytes = 64 * 1024;
constexpr unsigned kDeflateLevel = 4;

Hdf5Handle text_type(std::size_t bytes) {
  auto type = hdf5_checked(H5Tcopy(H5T_C_S1), H5Tclose, "text type");
  hdf5_check(H5Tset_size(type, std::max<std::size_t>(bytes, 1)), "text type");
  hdf5_check(H5Tset_strpad(type, H5T_STR_NULLPAD), "text type");
  hdf5_check(H5Tset_cset(type, H5T_CSET_UTF8), "text type");
  return type;
}

Hdf5Handle open_attribute(hid_t object, const char* name, hsize_t count) {
  if (H5Aexists(object, name) <= 0) throw Hdf5Error(std::string(name) + ": no such attribute");
  auto attribute = hdf5_checked(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, name);
  const auto space = hdf5_checked(H5Aget_space(attribute), H5Sclose, name);
  if (H5Sget_simple_extent_npoints(space) != static_cast<hssize_t>(count)) {
    throw Hdf5Error(std::string(name) + ": another number of values than " + std::to_string(count));
  }
  return attribute;
}

}  // namespace

Hdf5Handle create_group(const Hdf5Handle& parent, const char* name) {
  return hdf5_checked(H5Gcreate2(parent, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                      name);
}

Hdf5Handle open_group(const Hdf5Handle& parent, const char* name) {
  Hdf5Handle group = open_group_if(parent, name);
  if (!group.valid()) throw Hdf5Error(std::string(name) + ": no such group");
  return group;
}

Hdf5Handle open_group_if(const Hdf5Handle& parent, const char* name) {
  const htri_t exists = H5Lexists(parent, name, H5P_DEFAULT);
  hdf5_check(exists, name);
  if (exists == 0) return {};
  return hdf5_checked(H5Gopen2(parent, name, H5P_DEFAULT), H5Gclose, name);
}

void write_attribute(hid_t object, const char* name, hid_t type, const void* value, hsize_t count) {
  const auto space = hdf5_checked(
      count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose, name);
  const auto attribute =
      hdf5_checked(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
  hdf5_check(H5Awrite(attribute, type, value), name);
}

void write_text_attribute(hid_t object, const char* name, const std::string& text) {
  write_attribute(object, name, text_type(text.size()), text.c_str());
}

std::string read_text_attribute(hid_t object, const char* name, std::uint64_t max_bytes) {
  const auto attribute = open_attribute(object, name, 1);
  const auto type = hdf5_checked(H5Aget_type(attribute), H5Tclose, name);
  const std::size_t bytes = H5Tget_size(type);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || bytes > max_bytes) {
    throw Hdf5Error(std::string(name) + ": no text of fixed length");
  }
  std::string text(bytes, '\0');
  hdf5_check(H5Aread(attribute, type, text.data()), name);
  text.erase(std::min(text.find('\0'), text.size()));
  return text;
}

void read_attribute(hid_t object, const char* name, hid_t memory_type, void* value, hsize_t count) {
  const auto attribute = open_attribute(object, name, count);
  const auto type = hdf5_checked(H5Aget_type(attribute), H5Tclose, name);
  if (H5Tget_class(type) != H5Tget_class(memory_type)) {
    throw Hdf5Error(std::string(name) + ": another type of number");
  }
  hdf5_check(H5Aread(attribute, memory_type, value), name);
}

void write_check(const Hdf5Handle& group, std::uint64_t check) {
  write_attribute(group, "check", H5T_STD_U64LE, &check);
}

void verify_check(const Hdf5Handle& group, const char* name, std::uint64_t check) {
  std::uint64_t stored = 0;
  read_attribute(group, "check", H5T_NATIVE_UINT64, &stored);
  if (stored != check) {
    throw Hdf5Error(std::string(name) + ": its check does not fit, it is damaged");
  }
}

void write_fixed_rows(const Hdf5Handle& group, const char* name, hid_t type, const void* values,
                      hsize_t rows, hsize_t columns) {
  const hsize_t dims[2] = {rows, columns};
  const int rank = columns == 1 ? 1 : 2;
  const auto space = hdf5_checked(H5Screate_simple(rank, dims, nullptr), H5Sclose, name);
  const auto properties = hdf5_checked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
  if (rows > 0) {  // HDF5 has no chunks of no rows
    const hsize_t row_bytes = columns * H5Tget_size(type);
    const hsize_t chunk[2] = {std::clamp<hsize_t>(kChunkBytes / row_bytes, 1, rows), columns};
    hdf5_check(H5Pset_chunk(properties, rank, chunk), name);
    hdf5_check(H5Pset_shuffle(properties), name);
    hdf5_check(H5Pset_deflate(properties, kDeflateLevel), name);
  }
  const auto dataset = hdf5_checked(
      H5Dcreate2(group, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose, name);
  if (rows > 0) hdf5_check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), name);
}

Hdf5Handle open_data_set(const Hdf5Handle& group, const char* name, hid_t type,
                         std::span<hsize_t> dims) {
  const std::string place = name;
  if (H5Lexists(group, name, H5P_DEFAULT) <= 0) throw Hdf5Error(place + ": no such data set");
  Hdf5Handle dataset = hdf5_checked(H5Dopen2(group, name, H5P_DEFAULT), H5Dclose, name);
  const auto stored_type = hdf5_checked(H5Dget_type(dataset), H5Tclose, name);
  if (H5Tequal(stored_type, type) <= 0) throw Hdf5Error(place + ": rows of another type");
  const auto space = hdf5_checked(H5Dget_space(dataset), H5Sclose, name);
  const int rank = static_cast<int>(dims.size());
  const bool fits = rank == 0 ? H5Sget_simple_extent_npoints(space) == 1
                              : H5Sget_simple_extent_ndims(space) == rank &&
                                    H5Sget_simple_extent_dims(space, dims.data(), nullptr) == rank;
  if (!fits) throw Hdf5Error(place + ": another shape");
  return dataset;
}

Hdf5Handle open_fixed_rows(const Hdf5Handle& group, const FixedRows& expected,
                           std::uint64_t file_bytes, hsize_t& rows) {
  const std::string place = expected.name;
  hsize_t all[2] = {0, 1};
  const std::span dims(all, expected.columns == 1 ? 1 : 2);
  Hdf5Handle dataset = open_data_set(group, expected.name, expected.type, dims);
  if (all[1] != expected.columns) throw Hdf5Error(place + ": another shape");
  rows = all[0];
  if (rows > expected.max_rows) throw Hdf5Error(place + ": more rows than there can be");
  if (rows == 0) return dataset;
  const Hdf5Storage stored =
      storage_of(dataset, place, dims, H5Tget_size(expected.type), file_bytes);
  if (stored.rows < rows) throw Hdf5Error(place + ": more rows than the file has room for");
  return dataset;
}

}  // namespace sulcus
