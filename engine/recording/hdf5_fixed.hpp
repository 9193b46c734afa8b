#pragma once

#include <cstdint>
#include <string>

#include "engine/recording/hdf5_handle.hpp"

namespace sulcus {

// Attributes, and data sets that are written once: what all fixed parts of a recording are made of.
// All throw Hdf5Error. A `place` is how messages name the object.

void write_text_attribute(hid_t object, const char* name, const std::string& text);
void write_attribute(hid_t object, const char* name, hid_t type, const void* value,
                     hsize_t count = 1);

/// Text of fixed length, at most `max_bytes`.
std::string read_text_attribute(hid_t object, const char* name, std::uint64_t max_bytes);
/// `count` numbers of the class of `memory_type`, converted to it.
void read_attribute(hid_t object, const char* name, hid_t memory_type, void* value,
                    hsize_t count = 1);

/// Writes `rows` rows of `columns` values of `type`, in compressed chunks.
void write_fixed_rows(const Hdf5Handle& group, const char* name, hid_t type, const void* values,
                      hsize_t rows, hsize_t columns = 1);

/// A data set of `write_fixed_rows`, checked before memory is taken for it.
class FixedRows {
 public:
  /// Throws unless its type is `type`, its shape rows x `columns` with at most `max_rows` rows, and
  /// a file of `file_bytes` bytes can hold that much.
  FixedRows(const Hdf5Handle& group, const char* name, hid_t type, hsize_t columns,
            hsize_t max_rows, std::uint64_t file_bytes);

  hsize_t rows() const { return rows_; }
  /// Fills rows() x columns values of the type.
  void read(void* values) const;

 private:
  std::string name_;
  Hdf5Handle type_;
  Hdf5Handle dataset_;
  hsize_t rows_ = 0;
};

}  // namespace sulcus
