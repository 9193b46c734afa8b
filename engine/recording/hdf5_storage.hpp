#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/recording/hdf5_handle.hpp"

namespace sulcus {

/// How the rows of a data set lie in the file.
struct Hdf5Storage {
  hsize_t chunk_rows = 1;  // stored as one
  hsize_t rows = 0;        // that the file has room for, from the first on
};

/// Looks at how a data set of rows is stored, before memory is taken for them: in chunks, plain or
/// packed by gzip as h5repack makes them, or in one piece. No row is longer, and no chunk unpacks
/// to more, than a writer makes them. `dims`: of the data set, rows first. @throws
/// UnreadLayout where it is stored in another way, or in another file; Hdf5Error where a chunk is
/// longer than it can be.
Hdf5Storage storage_of(const Hdf5Handle& dataset, const std::string& name,
                       std::span<const hsize_t> dims, std::size_t value_bytes,
                       std::uint64_t file_bytes);

}  // namespace sulcus
