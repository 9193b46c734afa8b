#pragma once

#include <functional>
#include <span>

#include "engine/core/whole_file.hpp"

namespace sulcus {

/// Fills a block with the next samples, -1 to 1. Returns how many there were; 0: there are no more.
using TakeSamples = std::function<std::size_t(std::span<float>)>;

/// Writes one channel of 16 bits as .wav beside a file's name, at a rate in samples a second.
/// Louder than 1 is 1. The same samples give the same bytes. @throws std::runtime_error, naming the
/// file, where it cannot all be written.
void write_wav(const WholeFile& file, int rate_hz, const TakeSamples& take);

}  // namespace sulcus
