#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/recording/hdf5_handle.hpp"

namespace sulcus {

// Groups, attributes, and data sets that are written once: what all fixed parts of a recording are
// made of. All throw Hdf5Error.

Hdf5Handle create_group(const Hdf5Handle& parent, const char* name);
/// Throws where there is none.
Hdf5Handle open_group(const Hdf5Handle& parent, const char* name);
/// Not valid where there is none.
Hdf5Handle open_group_if(const Hdf5Handle& parent, const char* name);

void write_text_attribute(hid_t object, const char* name, const std::string& text);
void write_attribute(hid_t object, const char* name, hid_t type, const void* value,
                     hsize_t count = 1);

/// Text of fixed length, at most `max_bytes`.
std::string read_text_attribute(hid_t object, const char* name, std::uint64_t max_bytes);
/// `count` numbers of the class of `memory_type`, converted to it.
void read_attribute(hid_t object, const char* name, hid_t memory_type, void* value,
                    hsize_t count = 1);

/// The attribute `check` of a group: XXH3-64 over what it holds.
void write_check(const Hdf5Handle& group, std::uint64_t check);
/// Throws where it is another; `name` is the group's, for the message.
void verify_check(const Hdf5Handle& group, const char* name, std::uint64_t check);

/// Writes `rows` rows of `columns` values of `type`, in compressed chunks.
void write_fixed_rows(const Hdf5Handle& group, const char* name, hid_t type, const void* values,
                      hsize_t rows, hsize_t columns = 1);

/// Opens a data set; throws unless it has that type and as many dimensions as `dims`, which become
/// its own. (One that has a single value counts as of none.)
Hdf5Handle open_data_set(const Hdf5Handle& group, const char* name, hid_t type,
                         std::span<hsize_t> dims);

/// What a data set of `write_fixed_rows` is to be.
struct FixedRows {
  const char* name;
  hid_t type;
  hsize_t columns;
  hsize_t max_rows;
};
/// Opens it; throws also where a file of `file_bytes` bytes cannot hold as many as it says.
Hdf5Handle open_fixed_rows(const Hdf5Handle& group, const FixedRows& expected,
                           std::uint64_t file_bytes, hsize_t& rows);

/// Its rows, checked before memory is taken for them.
template <class Row>
std::vector<Row> read_fixed_rows(const Hdf5Handle& group, const FixedRows& expected,
                                 std::uint64_t file_bytes) {
  hsize_t count = 0;
  const Hdf5Handle dataset = open_fixed_rows(group, expected, file_bytes, count);
  std::vector<Row> rows(count);
  if (count > 0) {
    hdf5_check(H5Dread(dataset, expected.type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()),
               expected.name);
  }
  return rows;
}

}  // namespace sulcus
