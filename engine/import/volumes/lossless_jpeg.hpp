#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sulcus {

/// Unpacks one grey image of lossless JPEG, Huffman coded [ITU-T T.81, annex H], which the common
/// library does not read. Row by row; as many as `width` times `height`. Empty: damaged, another
/// process of JPEG, or another size.
std::vector<std::uint16_t> read_lossless_jpeg(std::span<const std::byte> jpeg, unsigned width,
                                              unsigned height);

}  // namespace sulcus
