#include <array>
#include <optional>

#include "engine/import/volumes/packed_picture.hpp"

namespace sulcus {
namespace {

/// Codes of up to 16 bits for the number of bits of a difference [T.81, annex C and F.2.2.3].
struct HuffmanTable {
  std::array<int, 17> least{}, most{}, first{};  // by length: codes, and the value of the first
  std::vector<std::uint8_t> values;

  static std::optional<HuffmanTable> of(std::span<const std::byte> counts,
                                        std::span<const std::byte> values) {
    HuffmanTable table;
    int code = 0, at = 0;
    for (std::size_t length = 1; length <= 16; ++length) {
      const int count = static_cast<int>(counts[length - 1]);
      table.least[length] = code;
      table.first[length] = at;
      code += count;
      at += count;
      table.most[length] = count > 0 ? code - 1 : -1;
      if (code > 1 << length) return std::nullopt;
      code <<= 1;
    }
    for (const std::byte value : values) {
      constexpr auto kMost = std::byte{16};
      if (value > kMost) return std::nullopt;
      table.values.push_back(static_cast<std::uint8_t>(value));
    }
    return table;
  }
};

/// Bits of entropy-coded data, up to the next marker.
class Bits {
 public:
  Bits(std::span<const std::byte> bytes, std::size_t at) : bytes_(bytes), at_(at) {}

  /// -1: none left.
  int bit() {
    if (left_ == 0) {
      if (at_ >= bytes_.size()) return -1;
      held_ = static_cast<unsigned>(bytes_[at_]);
      if (held_ == 0xff) {
        if (at_ + 1 >= bytes_.size() || bytes_[at_ + 1] != std::byte{0}) return -1;
        ++at_;
      }
      ++at_;
      left_ = 8;
    }
    return static_cast<int>(held_ >> --left_ & 1u);
  }
  /// To behind a marker; false: something else stands there.
  bool marker(unsigned code) {
    left_ = 0;
    while (at_ + 1 < bytes_.size() && bytes_[at_] == std::byte{0xff} &&
           bytes_[at_ + 1] == std::byte{0xff}) {
      ++at_;
    }
    if (at_ + 1 >= bytes_.size() || bytes_[at_] != std::byte{0xff} ||
        bytes_[at_ + 1] != static_cast<std::byte>(code)) {
      return false;
    }
    at_ += 2;
    return true;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_;
  unsigned held_ = 0, left_ = 0;
};

/// A difference; none: damaged.
std::optional<int> difference(Bits& bits, const HuffmanTable& table) {
  int code = 0;
  for (std::size_t length = 1; length <= 16; ++length) {
    const int bit = bits.bit();
    if (bit < 0) return std::nullopt;
    code = code << 1 | bit;
    if (code > table.most[length]) continue;
    const auto at = static_cast<std::size_t>(table.first[length] + code - table.least[length]);
    if (at >= table.values.size()) return std::nullopt;
    const int size = table.values[at];
    if (size == 0) return 0;
    if (size == 16) return 32768;
    int value = 0;
    for (int b = 0; b < size; ++b) {
      const int next = bits.bit();
      if (next < 0) return std::nullopt;
      value = value << 1 | next;
    }
    return value < 1 << (size - 1) ? value - (1 << size) + 1 : value;
  }
  return std::nullopt;
}

constexpr unsigned kRestart = 0xd0, kEnd = 0xd9;  // markers

struct Scan {
  int precision = 0;
  unsigned predictor = 0, point_transform = 0, restart_rows = 0;
  HuffmanTable table;
  std::size_t data_at = 0;
};

/// Up to where the data begin.
std::optional<Scan> read_markers(std::span<const std::byte> jpeg, unsigned width, unsigned height) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(jpeg[i]); };
  const auto word = [&](std::size_t i) { return byte(i) << 8u | byte(i + 1); };
  if (jpeg.size() < 4 || word(0) != 0xffd8) return std::nullopt;
  Scan scan;
  std::array<std::optional<HuffmanTable>, 4> tables;
  unsigned restart_interval = 0;
  for (std::size_t at = 2; at + 4 <= jpeg.size();) {
    if (byte(at) != 0xff) return std::nullopt;
    const unsigned marker = byte(at + 1);
    if (marker == 0xff) {
      ++at;
      continue;
    }
    const std::size_t length = word(at + 2), body = at + 4;
    if (length < 2 || length > jpeg.size() - at - 2) return std::nullopt;
    const std::size_t end = at + 2 + length;
    switch (marker) {
      case 0xc3:  // a lossless frame of one component
        if (length != 11 || word(body + 1) != height || word(body + 3) != width ||
            byte(body + 5) != 1) {
          return std::nullopt;
        }
        scan.precision = static_cast<int>(byte(body));
        if (scan.precision < 2 || scan.precision > 16) return std::nullopt;
        break;
      case 0xc4:
        for (std::size_t t = body; t < end;) {
          if (end - t < 17) return std::nullopt;
          const unsigned id = byte(t);
          std::size_t count = 0;
          for (std::size_t i = 1; i <= 16; ++i) count += byte(t + i);
          if (id > 3 || count > end - t - 17) return std::nullopt;
          tables[id] = HuffmanTable::of(jpeg.subspan(t + 1, 16), jpeg.subspan(t + 17, count));
          if (!tables[id]) return std::nullopt;
          t += 17 + count;
        }
        break;
      case 0xdd:
        if (length != 4) return std::nullopt;
        restart_interval = word(body);
        break;
      case 0xda: {
        if (length != 8 || byte(body) != 1 || scan.precision == 0) return std::nullopt;
        const unsigned table = byte(body + 2) >> 4u;
        scan.predictor = byte(body + 3);
        scan.point_transform = byte(body + 5) & 15u;
        if (table > 3 || !tables[table] || scan.predictor < 1 || scan.predictor > 7 ||
            static_cast<int>(scan.point_transform) >= scan.precision ||
            restart_interval % width != 0) {
          return std::nullopt;
        }
        scan.table = *tables[table];
        scan.restart_rows = restart_interval / width;
        scan.data_at = end;
        return scan;
      }
      default:
        // Other processes of JPEG have frames of another kind.
        if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc8 && marker != 0xcc) {
          return std::nullopt;
        }
        break;
    }
    at = end;
  }
  return std::nullopt;
}

/// From what is left of, above, and above left of a sample [T.81, table H.1].
int predicted(unsigned predictor, int left, int above, int corner) {
  switch (predictor) {
    case 1:
      return left;
    case 2:
      return above;
    case 3:
      return corner;
    case 4:
      return left + above - corner;
    case 5:
      return left + ((above - corner) >> 1);
    case 6:
      return above + ((left - corner) >> 1);
    default:
      return (left + above) >> 1;
  }
}

}  // namespace

std::vector<std::uint16_t> read_lossless_jpeg(std::span<const std::byte> jpeg, unsigned width,
                                              unsigned height) {
  if (width == 0 || height == 0) return {};
  const std::optional<Scan> scan = read_markers(jpeg, width, height);
  if (!scan) return {};
  Bits bits(jpeg, scan->data_at);
  const int start = 1 << (scan->precision - static_cast<int>(scan->point_transform) - 1);
  std::vector<std::uint16_t> samples(std::size_t{width} * height);
  unsigned rows_since_restart = 0, restarts = 0;
  for (unsigned y = 0; y < height; ++y) {
    if (scan->restart_rows > 0 && rows_since_restart == scan->restart_rows) {
      if (!bits.marker(kRestart + restarts++ % 8)) return {};
      rows_since_restart = 0;
    }
    std::uint16_t* row = &samples[std::size_t{y} * width];
    const std::uint16_t* above = rows_since_restart > 0 ? row - width : nullptr;
    for (unsigned x = 0; x < width; ++x) {
      const std::optional<int> change = difference(bits, scan->table);
      if (!change) return {};
      const int guess = x == 0   ? (above ? above[0] : start)
                        : !above ? row[x - 1]
                                 : predicted(scan->predictor, row[x - 1], above[x], above[x - 1]);
      row[x] = static_cast<std::uint16_t>(guess + *change);  // modulo 2^16
    }
    ++rows_since_restart;
  }
  if (!bits.marker(kEnd)) return {};  // what is damaged seldom ends just there
  for (std::uint16_t& sample : samples) {
    sample = static_cast<std::uint16_t>(sample << scan->point_transform);
  }
  return samples;
}

}  // namespace sulcus
