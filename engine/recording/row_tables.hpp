#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "engine/recording/hdf5_fixed.hpp"
#include "engine/recording/hdf5_storage.hpp"
#include "engine/recording/recording_format.hpp"

namespace sulcus {

// The data sets of rows: those that grow (GrowingTable, StoredTable), and those of a single row
// that has its place from the start. All throw Hdf5Error.

/// A data set that grows by rows, and the rows that wait for it.
template <class Row>
class GrowingTable {
 public:
  explicit GrowingTable(const Hdf5Handle& file, const RowTable& table = kRowTable<Row>)
      : name_(table.name), type_(row_type<Row>()) {
    const hsize_t none = 0, unlimited = H5S_UNLIMITED;
    const auto space = hdf5_checked(H5Screate_simple(1, &none, &unlimited), H5Sclose, name_);
    const auto properties = hdf5_checked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name_);
    hdf5_check(H5Pset_chunk(properties, 1, &table.chunk_rows), name_);
    dataset_ =
        hdf5_checked(H5Dcreate2(file, name_, type_, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                     H5Dclose, name_);
  }

  hsize_t written() const { return written_; }
  std::size_t waiting() const { return waiting_.size(); }
  const Row& waiting_row(std::size_t i) const { return waiting_[i]; }
  void add(const Row& row) { waiting_.push_back(row); }
  void add(std::span<const Row> rows) { waiting_.insert(waiting_.end(), rows.begin(), rows.end()); }

  /// Writes the first `count` waiting rows and hands them to the system.
  void flush(std::size_t count) {
    if (count == 0) return;
    const hsize_t rows = count, end = written_ + count;
    hdf5_check(H5Dset_extent(dataset_, &end), name_);
    const auto memory = hdf5_checked(H5Screate_simple(1, &rows, nullptr), H5Sclose, name_);
    const auto space = hdf5_checked(H5Dget_space(dataset_), H5Sclose, name_);
    hdf5_check(H5Sselect_hyperslab(space, H5S_SELECT_SET, &written_, nullptr, &rows, nullptr),
               name_);
    hdf5_check(H5Dwrite(dataset_, type_, memory, space, H5P_DEFAULT, waiting_.data()), name_);
    hdf5_check(H5Dflush(dataset_), name_);
    written_ = end;
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
  }
  void flush() { flush(waiting_.size()); }
  /// See Hdf5Handle::release.
  void release() { dataset_.release(); }

 private:
  const char* name_;
  Hdf5Handle type_;
  Hdf5Handle dataset_;
  hsize_t written_ = 0;
  std::vector<Row> waiting_;
};

/// Such a data set of a file that is read, checked before memory is taken for it.
template <class Row>
class StoredTable {
 public:
  StoredTable(const Hdf5Handle& file, std::uint64_t file_bytes,
              const RowTable& table = kRowTable<Row>)
      : name_(table.name), type_(row_type<Row>()) {
    dataset_ = open_data_set(file, name_, type_, std::span(&announced_, 1));
    const Hdf5Storage stored =
        storage_of(dataset_, name_, std::span(&announced_, 1), sizeof(Row), file_bytes);
    chunk_rows_ = stored.chunk_rows;
    rows_ = stored.rows;
  }

  /// Rows that the file says it has; and how many of them it has room for.
  hsize_t announced() const { return announced_; }
  hsize_t rows() const { return rows_; }
  /// What to read at a time: some whole chunks.
  hsize_t block_rows() const { return chunk_rows_ * std::max<hsize_t>(1, 4096 / chunk_rows_); }
  hsize_t chunk_rows() const { return chunk_rows_; }

  /// `count` rows from `first`, unchecked.
  std::vector<Row> read(hsize_t first, hsize_t count) const {
    std::vector<Row> rows(count);
    if (count == 0) return rows;
    const auto memory = hdf5_checked(H5Screate_simple(1, &count, nullptr), H5Sclose, name_);
    const auto space = hdf5_checked(H5Dget_space(dataset_), H5Sclose, name_);
    hdf5_check(H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, nullptr, &count, nullptr), name_);
    hdf5_check(H5Dread(dataset_, type_, memory, space, H5P_DEFAULT, rows.data()), name_);
    return rows;
  }

 private:
  const char* name_;
  Hdf5Handle type_;
  Hdf5Handle dataset_;
  hsize_t announced_ = 0;
  hsize_t rows_ = 0;
  hsize_t chunk_rows_ = 0;
};

/// The rows of a table one by one, read by blocks.
template <class Row>
class RowCursor {
 public:
  explicit RowCursor(const StoredTable<Row>& table) : table_(table) {}

  /// The next row, or null where there is none or its chunk cannot be read.
  const Row* next() {
    if (at_ == block_.size()) {
      first_ += block_.size();
      at_ = 0;
      read_block();
    }
    return at_ < block_.size() ? &block_[at_++] : nullptr;
  }

 private:
  void read_block() {
    const hsize_t left = table_.rows() - first_;
    for (hsize_t count : {table_.block_rows(), table_.chunk_rows()}) {
      try {
        block_ = table_.read(first_, std::min(count, left));
        return;
      } catch (const Hdf5Error&) {
        block_.clear();  // one chunk of the block cannot be read: those before it may
      }
    }
  }

  const StoredTable<Row>& table_;
  std::vector<Row> block_;
  hsize_t first_ = 0;
  std::size_t at_ = 0;
};

/// A data set of one row, all zero, that has its place in the file from the start: writing it later
/// changes nothing else.
template <class Row>
Hdf5Handle create_row(const Hdf5Handle& file) {
  const char* name = kRowTable<Row>.name;
  const Hdf5Handle type = row_type<Row>();
  const auto space = hdf5_checked(H5Screate(H5S_SCALAR), H5Sclose, name);
  const auto properties = hdf5_checked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
  hdf5_check(H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY), name);
  auto row = hdf5_checked(H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                          H5Dclose, name);
  const Row open{};
  hdf5_check(H5Dwrite(row, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &open), name);
  return row;
}

/// Writes the row, sealed, to its data set.
template <class Row>
void write_row(const Hdf5Handle& place, const Row& row) {
  const Row out = sealed(row);
  hdf5_check(H5Dwrite(place, row_type<Row>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &out),
             kRowTable<Row>.name);
}

template <class Row>
Row read_row(const Hdf5Handle& file) {
  const char* name = kRowTable<Row>.name;
  const Hdf5Handle type = row_type<Row>();
  const auto dataset = open_data_set(file, name, type, {});
  Row row;
  hdf5_check(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &row), name);
  return row;
}

}  // namespace sulcus
