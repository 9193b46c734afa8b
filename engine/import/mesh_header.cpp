#include "engine/import/mesh_header.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"

namespace sulcus {
namespace {

// Corners of a face: cutting one up into triangles takes the square of it.
constexpr std::uint64_t kMaxCorners = 1000;
// Objects, groups and materials of an OBJ file, each of which becomes a mesh.
constexpr std::uint64_t kMaxParts = 65536;

void refuse_beyond(const std::string& path, const std::string& place, std::uint64_t triangles,
                   const InputLimits& limits) {
  if (triangles <= limits.triangles()) return;
  throw InputError(path, place, std::to_string(triangles) + " triangles",
                   "at most " + std::to_string(limits.triangles()) + " (--limit-gib)");
}

/// As a text a mesh takes about four times its length once it is read.
void check_bytes(const std::string& path, const InputLimits& limits) {
  const std::uint64_t bytes = std::filesystem::file_size(path), most = limits.memory_bytes / 4;
  if (bytes <= most) return;
  throw InputError(path, "", std::to_string(bytes) + " bytes",
                   "at most " + std::to_string(most) + " (--limit-gib)");
}

/// The library ends the program over a face of none.
void check_corners(const std::string& path, const std::string& place, std::uint64_t corners) {
  if (corners >= 3 && corners <= kMaxCorners) return;
  throw InputError(path, place, "a face of " + std::to_string(corners) + " corners",
                   "3 to " + std::to_string(kMaxCorners));
}

/// The library takes some control characters for the end of a line, others for that of a number;
/// what was checked here would be another mesh there.
void check_text(const std::string& path, std::string_view text) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    const auto c = static_cast<unsigned char>(text[at]);
    if (c >= ' ' || c == '\n' || c == '\t' || (c == '\r' && text.substr(at).starts_with("\r\n"))) {
      continue;
    }
    const auto line = 1 + std::ranges::count(text.substr(0, at), '\n');
    throw InputError(path, "line " + std::to_string(line),
                     "the control character " + std::to_string(c), "text");
  }
}

std::string read_all(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path, "", "no readable file", "a mesh");
  std::string bytes(std::filesystem::file_size(path), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

enum class Encoding { kText, kLittleEndian, kBigEndian };
enum class Number { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct Property {
  std::optional<Number> count;  // of a list
  Number value = Number::kFloat;
  bool vertex_index = false;
};

struct Element {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<Property> properties;
};

struct PlyHeader {
  Encoding encoding = Encoding::kText;
  std::vector<Element> elements;
  std::size_t bytes = 0;
  std::uint64_t vertices = 0;
};

std::size_t bytes_of(Number type) {
  constexpr std::array<std::size_t, 8> kBytes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

bool is_whole(Number type) { return type != Number::kFloat && type != Number::kDouble; }

Number number_type(const std::string& path, const std::string& name) {
  static const std::map<std::string, Number> kTypes = {
      {"char", Number::kInt8},     {"int8", Number::kInt8},     {"uchar", Number::kUint8},
      {"uint8", Number::kUint8},   {"short", Number::kInt16},   {"int16", Number::kInt16},
      {"ushort", Number::kUint16}, {"uint16", Number::kUint16}, {"int", Number::kInt32},
      {"int32", Number::kInt32},   {"uint", Number::kUint32},   {"uint32", Number::kUint32},
      {"float", Number::kFloat},   {"float32", Number::kFloat}, {"double", Number::kDouble},
      {"float64", Number::kDouble}};
  const auto found = kTypes.find(name);
  if (found == kTypes.end())
    throw InputError(path, "header", "type \"" + name + "\"", "a PLY type");
  return found->second;
}

PlyHeader read_ply_header(const std::string& path, std::string_view bytes) {
  PlyHeader header;
  bool first = true;
  while (header.bytes < bytes.size()) {
    const std::size_t end = bytes.find('\n', header.bytes);
    if (end == std::string_view::npos) break;
    std::istringstream line(std::string(bytes.substr(header.bytes, end - header.bytes)));
    header.bytes = end + 1;
    std::string word;
    line >> word;
    if (first && word != "ply") throw InputError(path, "line 1", "no \"ply\"", "a PLY file");
    first = false;
    if (word == "format") {
      std::string encoding;
      line >> encoding;
      if (encoding == "binary_little_endian") {
        header.encoding = Encoding::kLittleEndian;
      } else if (encoding == "binary_big_endian") {
        header.encoding = Encoding::kBigEndian;
      } else if (encoding != "ascii") {
        throw InputError(path, "format", "\"" + encoding + "\"", "ascii or binary");
      }
    } else if (word == "element") {
      Element element;
      if (!(line >> element.name >> element.rows)) {
        throw InputError(path, "header", "an element without a count", "element NAME COUNT");
      }
      if (element.name == "vertex") header.vertices = element.rows;
      for (const Element& other : header.elements) {
        if (other.name != element.name) continue;
        throw InputError(path, "header", "element " + element.name + " twice", "it once");
      }
      header.elements.push_back(element);
    } else if (word == "property") {
      if (header.elements.empty()) {
        throw InputError(path, "header", "a property of no element", "an element before it");
      }
      Property property;
      std::string type, name;
      line >> type;
      if (type == "list") {
        std::string count;
        line >> count >> type;
        property.count = number_type(path, count);
        if (!is_whole(*property.count)) {
          throw InputError(path, "header", "lists of " + count + " lengths", "whole numbers");
        }
      }
      property.value = number_type(path, type);
      line >> name;
      property.vertex_index = header.elements.back().name == "face" && property.count &&
                              (name == "vertex_indices" || name == "vertex_index");
      if (property.vertex_index && !is_whole(property.value)) {
        throw InputError(path, "header", "indices of type " + type, "whole numbers");
      }
      header.elements.back().properties.push_back(property);
    } else if (word == "end_header") {
      check_text(path, bytes.substr(0, header.bytes));
      if (header.encoding == Encoding::kText) check_text(path, bytes);
      return header;
    }
    if (first) break;
  }
  throw InputError(path, "header", "no end_header", "a PLY file");
}

/// Goes through the numbers after the header, one after another.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header)
      : bytes_(bytes), at_(header.bytes), encoding_(header.encoding) {}

  /// The next number, in a text one of the same line; nothing where there is none of its type.
  std::optional<double> next(Number type) {
    return encoding_ == Encoding::kText ? next_word(type) : next_binary(type);
  }
  /// Passes over `count` numbers of one type.
  bool skip(Number type, std::uint64_t count) {
    if (encoding_ == Encoding::kText) {
      for (; count > 0; --count) {
        if (!next_word(type)) return false;
      }
      return true;
    }
    const std::size_t each = bytes_of(type);
    if (count > (bytes_.size() - at_) / each) return false;
    at_ += each * count;
    return true;
  }
  /// In a text, passes over the end of a line, which the library takes for that of a row.
  bool end_row() {
    if (encoding_ != Encoding::kText) return true;
    skip_blanks();
    begin_ = at_;
    if (at_ == bytes_.size()) return true;
    return bytes_[at_++] == '\n';
  }
  /// What is there instead of what was asked for last.
  std::string found() const {
    if (encoding_ != Encoding::kText || begin_ >= bytes_.size()) return "the end of the file";
    if (bytes_[begin_] == '\n') return "the end of the line";
    const std::string_view rest = bytes_.substr(begin_);
    return "'" + std::string(rest.substr(0, rest.find_first_of(" \t\r\n"))) + "'";
  }

 private:
  void skip_blanks() {
    while (at_ < bytes_.size() &&
           (bytes_[at_] == ' ' || bytes_[at_] == '\t' || bytes_[at_] == '\r'))
      ++at_;
  }
  std::optional<double> next_word(Number type) {
    skip_blanks();
    begin_ = at_;
    while (at_ < bytes_.size() && static_cast<unsigned char>(bytes_[at_]) > ' ') ++at_;
    std::string_view word = bytes_.substr(begin_, at_ - begin_);
    if (word.starts_with('+')) word.remove_prefix(1);  // from_chars knows none
    const auto parsed = [&](auto value) -> std::optional<double> {
      const char* end = word.data() + word.size();
      const auto result = std::from_chars(word.data(), end, value);
      if (result.ec != std::errc{} || result.ptr != end) return std::nullopt;
      return static_cast<double>(value);
    };
    return is_whole(type) ? parsed(std::int64_t{}) : parsed(double{});
  }
  template <class T>
  double take() {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if ((encoding_ == Encoding::kBigEndian) == (std::endian::native == std::endian::little)) {
      std::ranges::reverse(raw);
    }
    at_ += sizeof(T);
    return static_cast<double>(std::bit_cast<T>(raw));
  }
  std::optional<double> next_binary(Number type) {
    if (bytes_.size() - at_ < bytes_of(type)) return std::nullopt;
    switch (type) {
      case Number::kInt8:
        return take<std::int8_t>();
      case Number::kUint8:
        return take<std::uint8_t>();
      case Number::kInt16:
        return take<std::int16_t>();
      case Number::kUint16:
        return take<std::uint16_t>();
      case Number::kInt32:
        return take<std::int32_t>();
      case Number::kUint32:
        return take<std::uint32_t>();
      case Number::kFloat:
        return take<float>();
      case Number::kDouble:
        return take<double>();
    }
    return std::nullopt;
  }

  std::string_view bytes_;
  std::size_t at_, begin_ = 0;  // begin_: of the last word
  Encoding encoding_;
};

void walk_row(const std::string& path, const Element& element, std::uint64_t row,
              const PlyHeader& header, PlyBody& body) {
  const std::string place = element.name + " " + std::to_string(row);
  const auto ends = [&]() -> InputError {
    return {path, place, body.found(), std::to_string(element.rows) + " rows as the header says"};
  };
  for (const Property& property : element.properties) {
    std::uint64_t count = 1;
    if (property.count) {
      const auto length = body.next(*property.count);
      if (!length) throw ends();
      if (!(*length >= 0.0 && *length <= 4294967295.0)) {
        throw InputError(path, place, std::to_string(*length) + " entries", "a length of a list");
      }
      count = static_cast<std::uint64_t>(*length);
    }
    if (!property.vertex_index) {
      if (!body.skip(property.value, count)) throw ends();
      continue;
    }
    check_corners(path, place, count);
    for (std::uint64_t c = 0; c < count; ++c) {
      const auto index = body.next(property.value);
      if (!index) throw ends();
      if (!(*index >= 0.0 && *index < static_cast<double>(header.vertices))) {
        throw InputError(path, place, "vertex " + std::to_string(static_cast<std::int64_t>(*index)),
                         "an index below " + std::to_string(header.vertices));
      }
    }
  }
  if (!body.end_row()) throw InputError(path, place, body.found(), "the end of the row");
}

}  // namespace

void check_stl(const std::string& path, const InputLimits& limits) {
  constexpr std::uint64_t kHeader = 84, kTriangle = 50;
  const std::uint64_t bytes = std::filesystem::file_size(path);
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path, "", "no readable file", "a mesh");
  std::array<char, 1024> begin{};
  in.read(begin.data(), begin.size());
  const auto held = static_cast<std::size_t>(in.gcount());
  std::uint32_t count = 0;  // little endian in the file, as on every machine of ours
  if (held >= kHeader) std::memcpy(&count, begin.data() + 80, sizeof(count));
  if (held >= kHeader && bytes == kHeader + kTriangle * count) {
    // The library knows another word for it.
    if (count == 0) throw InputError(path, "", "0 triangles", "at least 4");
    refuse_beyond(path, "triangle count", count, limits);
    return;
  }

  const std::string_view head(begin.data(), held);
  const auto word = head.find_first_not_of(" \t\r\n");
  const bool text = word != std::string_view::npos && head.substr(word).starts_with("solid") &&
                    head.find('\0') == std::string_view::npos;
  if (!text) {
    if (held < kHeader) {
      throw InputError(path, "", std::to_string(bytes) + " bytes", "at least 84 of an STL file");
    }
    throw InputError(path, "triangle count",
                     std::to_string(count) + " in a file of " + std::to_string(bytes) + " bytes",
                     std::to_string(kHeader + kTriangle * count) + " bytes for them");
  }
  check_bytes(path, limits);
  constexpr std::uint64_t kTail = 1024;
  in.clear();
  in.seekg(static_cast<std::streamoff>(bytes - std::min(bytes, kTail)));
  std::string tail(std::min(bytes, kTail), '\0');
  in.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  if (tail.find("endsolid") == std::string::npos) {
    throw InputError(path, "end", "no endsolid", "a whole text STL file");
  }
}

void check_obj(const std::string& path, const InputLimits& limits) {
  check_bytes(path, limits);
  const std::string bytes = read_all(path);
  check_text(path, bytes);
  std::uint64_t line = 1, triangles = 0, parts = 0;
  for (std::size_t at = 0; at < bytes.size(); ++line) {
    const std::uint64_t first_line = line;
    const char kind = bytes[at];
    // A line goes on where it ends in a backslash.
    std::uint64_t words = 0;
    bool blank = true;
    for (; at < bytes.size() && bytes[at] != '\n'; ++at) {
      if (bytes[at] == '\\' && at + 1 < bytes.size() && bytes[at + 1] == '\n') ++at, ++line;
      const bool was_blank = std::exchange(blank, static_cast<unsigned char>(bytes[at]) <= ' ');
      if (was_blank && !blank) ++words;
    }
    ++at;
    const std::string place = "line " + std::to_string(first_line);
    if (kind == 'f') {
      const std::uint64_t corners = words - 1;
      check_corners(path, place, corners);
      triangles += corners - 2;
      refuse_beyond(path, place, triangles, limits);
    } else if (kind == 'o' || kind == 'g' || kind == 'u') {
      if (++parts <= kMaxParts) continue;
      throw InputError(path, place, "more than " + std::to_string(kMaxParts) + " parts",
                       "fewer objects, groups and materials");
    }
  }
}

void check_ply(const std::string& path, const InputLimits& limits) {
  check_bytes(path, limits);
  const std::string bytes = read_all(path);
  const PlyHeader header = read_ply_header(path, bytes);
  PlyBody body(bytes, header);
  for (const Element& element : header.elements) {
    // Rows of nothing would be walked for ever.
    if (element.properties.empty() && element.rows > 0) {
      throw InputError(path, "header", "element " + element.name + " without properties",
                       "at least one");
    }
    if (element.name == "face") refuse_beyond(path, "header", element.rows, limits);
    for (std::uint64_t row = 0; row < element.rows; ++row) {
      walk_row(path, element, row, header, body);
    }
  }
}

}  // namespace sulcus
