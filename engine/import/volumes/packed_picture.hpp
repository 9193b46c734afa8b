#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sulcus {

// Grey pictures as DICOM packs them, unpacked to one number of 32 bits a pixel, row by row. Each
// gives an empty vector where the bytes are damaged, or are of another size than `columns` times
// `rows`, which is looked at before memory is taken.

/// What one byte of run lengths makes at most: 128 of 2.
inline constexpr std::uint64_t kMostRleRatio = 64;

struct PictureSize {
  std::uint32_t columns = 0, rows = 0;
};
/// Of the picture that a stream of JPEG, JPEG-LS or JPEG 2000 begins, as that says; none: no such
/// stream.
std::optional<PictureSize> coded_size(std::span<const std::byte> packed);

/// DICOM's run lengths, a plane of bytes each [DICOM PS3.5, annex G].
std::vector<std::int32_t> unpack_rle(std::span<const std::byte> packed, std::uint32_t columns,
                                     std::uint32_t rows, unsigned bytes_each);
/// JPEG of 8 bits, baseline or extended.
std::vector<std::int32_t> unpack_jpeg(std::span<const std::byte> packed, std::uint32_t columns,
                                      std::uint32_t rows);
/// JPEG-LS, lossless or not.
std::vector<std::int32_t> unpack_jpeg_ls(std::span<const std::byte> packed, std::uint32_t columns,
                                         std::uint32_t rows);
/// A JPEG 2000 codestream.
std::vector<std::int32_t> unpack_jpeg_2000(std::span<const std::byte> packed, std::uint32_t columns,
                                           std::uint32_t rows);

/// Unpacks one grey image of lossless JPEG, Huffman coded [ITU-T T.81, annex H], which the common
/// library does not read. Row by row; as many as `width` times `height`. Empty: damaged, another
/// process of JPEG, or another size.
std::vector<std::uint16_t> read_lossless_jpeg(std::span<const std::byte> jpeg, unsigned width,
                                              unsigned height);

}  // namespace sulcus
