#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/import/volumes/number_type.hpp"

namespace sulcus {

/// No stream unpacks to more than as many times its length [zlib, "Maximum Compression Factor"; of
/// bzip2 a block of 900,000 bytes, each 5 of which stand for 259].
inline constexpr std::uint64_t kMaxDeflateRatio = 1032, kMaxBzip2Ratio = 2'000'000;

/// The data of a file one after the other, unpacked on the way, so that nobody holds more of them
/// than was asked for.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Fills `out`; fewer only where the data end. @throws InputError: damaged data.
  virtual std::size_t read(std::span<std::byte> out) = 0;
  /// Of the packed data, how many have been taken.
  virtual std::uint64_t taken() const = 0;
};

/// The bytes of a file from `begin` on. @throws InputError: not to be opened.
std::unique_ptr<ByteSource> open_file(const std::string& path, std::uint64_t begin = 0);
/// Unpacks zlib and gzip streams, gzip also of several members. Checksums and lengths that the
/// streams state are compared, and nothing but zeros may follow them.
std::unique_ptr<ByteSource> inflated(const std::string& path, std::unique_ptr<ByteSource> packed);
/// The same of bzip2.
std::unique_ptr<ByteSource> bunzipped(const std::string& path, std::unique_ptr<ByteSource> packed);
/// Whether a file begins as a gzip stream does.
bool is_gzip(const std::string& path);

/// Leaves `count` bytes out. @throws InputError: there are fewer.
void skip_bytes(const std::string& path, ByteSource& source, std::uint64_t count);
/// Throws where more follows.
void check_end(const std::string& path, ByteSource& source, std::uint64_t announced);

/// Grey values as numbers of `type`. @throws InputError: fewer of them.
void read_numbers(const std::string& path, ByteSource& source, NumberType type, bool big_endian,
                  std::span<float> values);
/// The same of numbers in digits, with blanks or commas between them, to the end of the data.
void read_decimals(const std::string& path, ByteSource& source, std::span<float> values);
/// Bytes as two hexadecimal digits each, which blanks may part.
std::unique_ptr<ByteSource> from_hex(const std::string& path, std::unique_ptr<ByteSource> digits);

}  // namespace sulcus
