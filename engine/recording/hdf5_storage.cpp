#include "engine/recording/hdf5_storage.hpp"

#include <algorithm>
#include <array>

namespace sulcus {
namespace {

constexpr hsize_t kMostChunkBytes = 1 << 20;
// Deflate makes at most 1032 bytes of one [RFC 1951: 258 bytes from 2 bits], so small chunks bound
// what a hostile one can inflate to before HDF5 sees that it is too long. h5py makes chunks of this
// size for data of several GiB.
constexpr hsize_t kMostPackedChunkBytes = 256 * 1024;
constexpr std::uint64_t kDeflateRatio = 1032;

/// Deflate never adds more than this to what it cannot compress [zlib, compressBound], and a
/// checksum.
constexpr hsize_t deflate_bound(hsize_t bytes) { return bytes + bytes / 1000 + 64; }

/// Whether they are packed; by gzip alone.
bool is_packed(const Hdf5Handle& properties, const std::string& name) {
  const int filters = H5Pget_nfilters(properties);
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    std::array<char, 32> called{};
    const auto filter = H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &values,
                                       nullptr, called.size(), called.data(), &config);
    if (filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_SHUFFLE ||
        filter == H5Z_FILTER_FLETCHER32) {
      continue;
    }
    called.back() = '\0';
    throw UnreadLayout(name + ": packed by " +
                       (called[0] != '\0' ? called.data() : "filter " + std::to_string(filter)));
  }
  return filters > 0;
}

/// Rows up to the first chunk that is not there, which a run that broke off leaves.
hsize_t packed_rows(const Hdf5Handle& dataset, const std::string& name,
                    std::span<const hsize_t> dims, std::span<const hsize_t> chunk,
                    hsize_t chunk_bytes) {
  std::array<hsize_t, 2> offset{0, 0};
  for (; offset[0] < dims[0]; offset[0] += chunk[0]) {
    for (offset[1] = 0; offset[1] < dims[1]; offset[1] += chunk[1]) {
      hsize_t bytes = 0;
      if (H5Dget_chunk_storage_size(dataset, offset.data(), &bytes) < 0 || bytes == 0) {
        return offset[0];
      }
      if (bytes > deflate_bound(chunk_bytes)) {
        throw Hdf5Error(name + ": a chunk of a size that cannot be");
      }
    }
  }
  return dims[0];
}

}  // namespace

Hdf5Storage storage_of(const Hdf5Handle& dataset, const std::string& name,
                       std::span<const hsize_t> dims, std::size_t value_bytes,
                       std::uint64_t file_bytes) {
  const auto rank = static_cast<int>(dims.size());
  const std::array<hsize_t, 2> size{dims[0], rank > 1 ? dims[1] : 1};
  const hsize_t row_bytes = size[1] * value_bytes;
  const auto properties = hdf5_checked(H5Dget_create_plist(dataset), H5Pclose, name.c_str());
  const H5D_layout_t layout = H5Pget_layout(properties);
  if (layout == H5D_COMPACT ||
      (layout == H5D_CONTIGUOUS && H5Pget_external_count(properties) == 0)) {
    const hsize_t bytes = std::min<hsize_t>(H5Dget_storage_size(dataset), file_bytes);
    return {1, std::min(size[0], bytes / row_bytes)};
  }
  std::array<hsize_t, 2> chunk{0, 1};
  if (layout != H5D_CHUNKED || H5Pget_chunk(properties, rank, chunk.data()) != rank) {
    throw UnreadLayout(name + ": another layout");
  }
  const bool packed = is_packed(properties, name);
  const hsize_t most = packed ? kMostPackedChunkBytes : kMostChunkBytes;
  if (chunk[0] == 0 || chunk[1] == 0 || chunk[0] > most / value_bytes ||
      chunk[1] > most / value_bytes / chunk[0]) {
    throw UnreadLayout(name + ": another layout, chunks of more than " +
                       std::to_string(most / 1024) + " KiB");
  }
  if (!packed) return {chunk[0], std::min<hsize_t>(size[0], file_bytes / row_bytes)};
  const std::array<hsize_t, 2> held{
      std::min<hsize_t>(size[0], file_bytes * kDeflateRatio / row_bytes), size[1]};
  return {chunk[0], packed_rows(dataset, name, held, chunk, chunk[0] * chunk[1] * value_bytes)};
}

}  // namespace sulcus
