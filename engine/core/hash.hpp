#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <xxhash.h>

namespace sulcus {

/// XXH3-64 of `bytes` bytes.
inline std::uint64_t hash_bytes(const void* data, std::size_t bytes, std::uint64_t seed = 0) {
  return XXH3_64bits_withSeed(data, bytes, seed);
}

/// A number's hash [splitmix64, Steele et al. 2014]: for tables whose hash is kept up entry by
/// entry in a tick, where it costs a few operations.
constexpr std::uint64_t mix64(std::uint64_t v) {
  v += 0x9e3779b97f4a7c15u;
  v = (v ^ v >> 30) * 0xbf58476d1ce4e5b9u;
  v = (v ^ v >> 27) * 0x94d049bb133111ebu;
  return v ^ v >> 31;
}

/// 16 lower-case hexadecimal digits, as hashes stand in summaries.
std::string hex(std::uint64_t hash);

/// SHA-256 of a text, 64 hexadecimal digits: what `scene_sha256` holds.
std::string sha256_hex(const std::string& text);

}  // namespace sulcus
