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
#include <vector>

#include "engine/core/error.hpp"

namespace sulcus {
namespace {

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
      }
      property.value = number_type(path, type);
      line >> name;
      property.vertex_index = header.elements.back().name == "face" && property.count &&
                              (name == "vertex_indices" || name == "vertex_index");
      header.elements.back().properties.push_back(property);
    } else if (word == "end_header") {
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

  /// The next number as an integer (a fraction is cut off); nothing where the file ends.
  std::optional<double> next(Number type) {
    return encoding_ == Encoding::kText ? next_word() : next_binary(type);
  }
  /// Passes over `count` numbers of one type.
  bool skip(Number type, std::uint64_t count) {
    if (encoding_ == Encoding::kText) {
      for (; count > 0; --count) {
        if (!next_word()) return false;
      }
      return true;
    }
    const std::size_t each = bytes_of(type);
    if (count > (bytes_.size() - at_) / each) return false;
    at_ += each * count;
    return true;
  }

 private:
  std::optional<double> next_word() {
    while (at_ < bytes_.size() && static_cast<unsigned char>(bytes_[at_]) <= ' ') ++at_;
    if (at_ < bytes_.size() && bytes_[at_] == '+') ++at_;  // from_chars knows none
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && static_cast<unsigned char>(bytes_[at_]) > ' ') ++at_;
    double value = 0.0;
    const auto result = std::from_chars(bytes_.data() + begin, bytes_.data() + at_, value);
    if (result.ec != std::errc{}) return std::nullopt;
    return value;
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
  std::size_t at_;
  Encoding encoding_;
};

void walk_row(const std::string& path, const Element& element, std::uint64_t row,
              const PlyHeader& header, PlyBody& body) {
  const auto ends = [&]() -> InputError {
    return {path, element.name + " " + std::to_string(row), "the end of the file",
            std::to_string(element.rows) + " rows as the header says"};
  };
  for (const Property& property : element.properties) {
    std::uint64_t count = 1;
    if (property.count) {
      const auto length = body.next(*property.count);
      if (!length) throw ends();
      if (!(*length >= 0.0 && *length <= 4294967295.0)) {
        throw InputError(path, element.name + " " + std::to_string(row),
                         std::to_string(*length) + " entries", "a length of a list");
      }
      count = static_cast<std::uint64_t>(*length);
    }
    if (!property.vertex_index) {
      if (!body.skip(property.value, count)) throw ends();
      continue;
    }
    for (std::uint64_t c = 0; c < count; ++c) {
      const auto index = body.next(property.value);
      if (!index) throw ends();
      if (!(*index >= 0.0 && *index < static_cast<double>(header.vertices))) {
        throw InputError(path, "face " + std::to_string(row),
                         "vertex " + std::to_string(static_cast<std::int64_t>(*index)),
                         "an index below " + std::to_string(header.vertices));
      }
    }
  }
}

}  // namespace

void check_stl(const std::string& path) {
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
  constexpr std::uint64_t kTail = 1024;
  in.clear();
  in.seekg(static_cast<std::streamoff>(bytes - std::min(bytes, kTail)));
  std::string tail(std::min(bytes, kTail), '\0');
  in.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  if (tail.find("endsolid") == std::string::npos) {
    throw InputError(path, "end", "no endsolid", "a whole text STL file");
  }
}

void check_ply(const std::string& path) {
  const std::string bytes = read_all(path);
  const PlyHeader header = read_ply_header(path, bytes);
  PlyBody body(bytes, header);
  for (const Element& element : header.elements) {
    // Rows of nothing would be walked for ever.
    if (element.properties.empty()) continue;
    for (std::uint64_t row = 0; row < element.rows; ++row) {
      walk_row(path, element, row, header, body);
    }
  }
}

}  // namespace sulcus
