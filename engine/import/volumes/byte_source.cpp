#include "engine/import/volumes/byte_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <fstream>
#include <limits>
#include <optional>
#include <utility>

#include <bzlib.h>
#include <zlib.h>

#include "engine/core/error.hpp"

namespace sulcus {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;

class FileSource : public ByteSource {
 public:
  FileSource(const std::string& path, std::uint64_t begin) : in_(path, std::ios::binary) {
    if (in_) in_.seekg(static_cast<std::streamoff>(begin));
    if (!in_) throw InputError(path, "", "no readable file", "a volume's data");
  }
  std::size_t read(std::span<std::byte> out) override {
    in_.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
    const auto got = static_cast<std::size_t>(in_.gcount());
    taken_ += got;
    return got;
  }
  std::uint64_t taken() const override { return taken_; }

 private:
  std::ifstream in_;
  std::uint64_t taken_ = 0;
};

/// What unpackers have alike: packed blocks, one stream behind the other, an end that is whole.
class UnpackingSource : public ByteSource {
 public:
  UnpackingSource(const std::string& path, std::unique_ptr<ByteSource> packed)
      : path_(path), packed_(std::move(packed)), block_(kBlock) {}

  std::size_t read(std::span<std::byte> out) override {
    std::size_t got = 0;
    while (got < out.size() && !ended_) {
      if (held_.empty() && !refill()) refuse("compressed data that break off");
      const Step step = unpack(held_, out.subspan(got));
      held_ = held_.subspan(step.taken);
      taken_ += step.taken;
      got += step.made;
      const bool stuck = step.taken == 0 && step.made == 0 && !step.stream_ended;
      if (step.damaged || stuck) refuse("compressed data that are damaged");
      if (step.stream_ended) end_stream();
    }
    return got;
  }
  std::uint64_t taken() const override { return taken_; }

 protected:
  struct Step {
    std::size_t taken = 0, made = 0;
    bool damaged = false, stream_ended = false;
  };
  virtual Step unpack(std::span<const std::byte> packed, std::span<std::byte> out) = 0;
  /// Whether another stream may begin with this byte.
  virtual bool may_begin(std::byte first) const = 0;
  virtual void begin_stream() = 0;

 private:
  [[noreturn]] void refuse(const char* found) const {
    throw InputError(path_, "data", found, "a whole stream with its checksum");
  }
  bool refill() {
    const std::size_t got = packed_->read(block_);
    held_ = std::span<const std::byte>(block_).first(got);
    return got > 0;
  }
  void end_stream() {
    if (!held_.empty() || refill()) {
      if (may_begin(held_.front())) return begin_stream();
      // What pads a file to a block.
      do {
        if (std::ranges::any_of(held_, [](std::byte b) { return b != std::byte{0}; })) {
          refuse("other bytes behind the compressed data");
        }
        taken_ += held_.size();
      } while (refill());
    }
    ended_ = true;
  }

  std::string path_;
  std::unique_ptr<ByteSource> packed_;
  std::vector<std::byte> block_;
  std::span<const std::byte> held_;
  std::uint64_t taken_ = 0;
  bool ended_ = false;
};

class InflatingSource : public UnpackingSource {
 public:
  using UnpackingSource::UnpackingSource;
  ~InflatingSource() override {
    if (begun_) inflateEnd(&stream_);
  }

 protected:
  Step unpack(std::span<const std::byte> packed, std::span<std::byte> out) override {
    // zlib or gzip, as the stream itself says.
    if (!begun_) begun_ = inflateInit2(&stream_, MAX_WBITS + 32) == Z_OK;
    if (!begun_) throw std::bad_alloc();
    gzip_ |= !looked_ && packed.front() == kGzip;
    looked_ = true;
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(packed.data()));
    stream_.avail_in = static_cast<uInt>(packed.size());
    const std::size_t room = std::min<std::size_t>(out.size(), std::size_t{1} << 30);
    stream_.next_out = reinterpret_cast<Bytef*>(out.data());
    stream_.avail_out = static_cast<uInt>(room);
    const int status = inflate(&stream_, Z_NO_FLUSH);
    const bool fine = status == Z_OK || status == Z_STREAM_END || status == Z_BUF_ERROR;
    return {packed.size() - stream_.avail_in, room - stream_.avail_out, !fine,
            status == Z_STREAM_END};
  }
  bool may_begin(std::byte first) const override { return gzip_ && first == kGzip; }
  void begin_stream() override { inflateReset(&stream_); }

 private:
  static constexpr std::byte kGzip{0x1f};

  z_stream stream_{};
  bool begun_ = false, looked_ = false, gzip_ = false;
};

class BunzippingSource : public UnpackingSource {
 public:
  using UnpackingSource::UnpackingSource;
  ~BunzippingSource() override {
    if (begun_) BZ2_bzDecompressEnd(&stream_);
  }

 protected:
  Step unpack(std::span<const std::byte> packed, std::span<std::byte> out) override {
    if (!begun_) begun_ = BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK;
    if (!begun_) throw std::bad_alloc();
    stream_.next_in = reinterpret_cast<char*>(const_cast<std::byte*>(packed.data()));
    stream_.avail_in = static_cast<unsigned>(packed.size());
    const std::size_t room = std::min<std::size_t>(out.size(), std::size_t{1} << 30);
    stream_.next_out = reinterpret_cast<char*>(out.data());
    stream_.avail_out = static_cast<unsigned>(room);
    const int status = BZ2_bzDecompress(&stream_);
    return {packed.size() - stream_.avail_in, room - stream_.avail_out,
            status != BZ_OK && status != BZ_STREAM_END, status == BZ_STREAM_END};
  }
  bool may_begin(std::byte first) const override { return first == std::byte{'B'}; }
  void begin_stream() override {
    BZ2_bzDecompressEnd(&stream_);
    stream_ = {};
    begun_ = false;
  }

 private:
  bz_stream stream_{};
  bool begun_ = false;
};

/// Characters of a source, one by one.
class Characters {
 public:
  explicit Characters(ByteSource& source) : source_(source), block_(kBlock) {}
  std::optional<char> next() {
    if (at_ == held_) {
      held_ = source_.read(block_);
      at_ = 0;
      if (held_ == 0) return std::nullopt;
    }
    return static_cast<char>(block_[at_++]);
  }

 private:
  ByteSource& source_;
  std::vector<std::byte> block_;
  std::size_t at_ = 0, held_ = 0;
};

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

class HexSource : public ByteSource {
 public:
  HexSource(const std::string& path, std::unique_ptr<ByteSource> digits)
      : path_(path), digits_(std::move(digits)), characters_(*digits_) {}
  std::size_t read(std::span<std::byte> out) override {
    for (std::size_t got = 0; got < out.size(); ++got) {
      const int high = digit(), low = high < 0 ? -1 : digit();
      if (high < 0) return got;
      if (low < 0) throw InputError(path_, "data", "half a byte", "two digits for each");
      out[got] = static_cast<std::byte>(high << 4 | low);
    }
    return out.size();
  }
  std::uint64_t taken() const override { return digits_->taken(); }

 private:
  /// -1: the end.
  int digit() {
    while (const auto c = characters_.next()) {
      if (is_space(*c)) continue;
      if (*c >= '0' && *c <= '9') return *c - '0';
      if (*c >= 'a' && *c <= 'f') return *c - 'a' + 10;
      if (*c >= 'A' && *c <= 'F') return *c - 'A' + 10;
      throw InputError(path_, "data", std::string("the character '") + *c + "'",
                       "hexadecimal digits");
    }
    return -1;
  }

  std::string path_;
  std::unique_ptr<ByteSource> digits_;
  Characters characters_;
};

}  // namespace

std::unique_ptr<ByteSource> open_file(const std::string& path, std::uint64_t begin) {
  return std::make_unique<FileSource>(path, begin);
}

std::unique_ptr<ByteSource> inflated(const std::string& path, std::unique_ptr<ByteSource> packed) {
  return std::make_unique<InflatingSource>(path, std::move(packed));
}

std::unique_ptr<ByteSource> bunzipped(const std::string& path, std::unique_ptr<ByteSource> packed) {
  return std::make_unique<BunzippingSource>(path, std::move(packed));
}

std::unique_ptr<ByteSource> from_hex(const std::string& path, std::unique_ptr<ByteSource> digits) {
  return std::make_unique<HexSource>(path, std::move(digits));
}

bool is_gzip(const std::string& path) {
  std::array<char, 2> magic{};
  std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
  return magic == std::array<char, 2>{'\x1f', '\x8b'};
}

void skip_bytes(const std::string& path, ByteSource& source, std::uint64_t count) {
  std::vector<std::byte> block(std::min<std::uint64_t>(count, kBlock));
  for (std::uint64_t left = count; left > 0;) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(left, block.size()));
    const std::size_t got = source.read(std::span(block).first(wanted));
    if (got < wanted) {
      throw InputError(path, "data", std::to_string(count - left + got) + " bytes",
                       "more than the " + std::to_string(count) + " that are left out");
    }
    left -= got;
  }
}

void check_end(const std::string& path, ByteSource& source, std::uint64_t announced) {
  std::byte more{};
  if (source.read({&more, 1}) == 0) return;
  throw InputError(path, "data", "more than " + std::to_string(announced) + " bytes",
                   "as many as the header says");
}

void read_numbers(const std::string& path, ByteSource& source, NumberType type, bool big_endian,
                  std::span<float> values) {
  std::vector<std::byte> block(std::min(kBlock, values.size() * type.bytes));
  for (std::size_t done = 0; done < values.size();) {
    const std::size_t count = std::min(block.size() / type.bytes, values.size() - done);
    const std::span<std::byte> wanted = std::span(block).first(count * type.bytes);
    if (const std::size_t got = source.read(wanted); got < wanted.size()) {
      throw InputError(path, "data", std::to_string(done * type.bytes + got) + " bytes",
                       std::to_string(values.size() * type.bytes) + " bytes after the header");
    }
    to_floats(wanted, type, big_endian, values.subspan(done, count));
    done += count;
  }
}

void read_decimals(const std::string& path, ByteSource& source, std::span<float> values) {
  Characters characters(source);
  std::size_t done = 0;
  std::string word;
  const auto take = [&] {
    if (word.empty()) return;
    double value = 0.0;
    const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error == std::errc::result_out_of_range) value = std::numeric_limits<double>::quiet_NaN();
    if (error == std::errc::invalid_argument || end != word.data() + word.size()) {
      throw InputError(path, "data", "\"" + word + "\"", "a number");
    }
    if (done == values.size()) {
      throw InputError(path, "data", "more than " + std::to_string(done) + " numbers",
                       "as many as the header says");
    }
    values[done++] = static_cast<float>(value);
    word.clear();
  };
  while (const auto c = characters.next()) {
    if (is_space(*c) || *c == ',') {
      take();
      continue;
    }
    constexpr std::size_t kLongest = 400;
    if (word.size() > kLongest) throw InputError(path, "data", "\"" + word + "\"", "a number");
    word += *c;
  }
  take();
  if (done < values.size()) {
    throw InputError(path, "data", std::to_string(done) + " numbers",
                     std::to_string(values.size()));
  }
}

}  // namespace sulcus
