#include "engine/import/meshes/ply_header.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/import/meshes/mesh_text.hpp"

namespace sulcus {
namespace {

constexpr std::array<std::pair<std::string_view, PlyNumber>, 16> kTypes = {{
    {"char", PlyNumber::kInt8},
    {"int8", PlyNumber::kInt8},
    {"uchar", PlyNumber::kUint8},
    {"uint8", PlyNumber::kUint8},
    {"short", PlyNumber::kInt16},
    {"int16", PlyNumber::kInt16},
    {"ushort", PlyNumber::kUint16},
    {"uint16", PlyNumber::kUint16},
    {"int", PlyNumber::kInt32},
    {"int32", PlyNumber::kInt32},
    {"uint", PlyNumber::kUint32},
    {"uint32", PlyNumber::kUint32},
    {"float", PlyNumber::kFloat},
    {"float32", PlyNumber::kFloat},
    {"double", PlyNumber::kDouble},
    {"float64", PlyNumber::kDouble},
}};

class PlyHeaderReader {
 public:
  PlyHeaderReader(const std::string& path, std::string_view contents)
      : path_(path), contents_(contents) {}

  PlyHeader read() {
    rest_ = without_byte_order_mark(contents_);
    const auto first_end = rest_.find_first_of("\r\n");
    const bool returns = first_end != rest_.npos && rest_[first_end] == '\r' &&
                         !rest_.substr(first_end).starts_with("\r\n");
    line_end_ = returns ? '\r' : '\n';
    if (!next_line() || words_ != std::vector<std::string_view>{"ply"}) {
      throw InputError(path_, "line 1", "no \"ply\"", "a PLY file");
    }
    bool format = false;
    while (next_line()) {
      if (words_.empty()) continue;
      const std::string_view word = words_.front();
      if (word == "comment" || word == "obj_info") continue;
      if (line_.find('\r') != line_.npos) refuse("lines that end as the first one");
      if (word == "format") {
        read_format();
        format = true;
      } else if (word == "element") {
        read_element();
      } else if (word == "property") {
        read_property();
      } else if (word == "end_header") {
        if (!format) throw InputError(path_, place(), "no format", "ascii or binary before it");
        header_.bytes = contents_.size() - rest_.size();
        check_lengths();
        return std::move(header_);
      } else {
        refuse("a line of a PLY header");
      }
    }
    throw InputError(path_, "header", "no end_header", "a PLY file");
  }

 private:
  std::string place() const { return "line " + std::to_string(header_.lines); }

  [[noreturn]] void refuse(const std::string& expected) const {
    throw InputError(path_, place(), "\"" + line_ + "\"", expected);
  }

  /// Only lines that end: what is cut short may end in another word.
  bool next_line() {
    const auto end = rest_.find(line_end_);
    if (end == rest_.npos) return false;
    line_ = rest_.substr(0, end);
    if (line_.ends_with('\r')) line_.pop_back();
    rest_.remove_prefix(end + 1);
    ++header_.lines;
    words_.clear();
    MeshText text(line_);
    for (std::string_view word = text.word_of_line(); !word.empty(); word = text.word_of_line()) {
      words_.push_back(word);
    }
    return true;
  }

  void read_format() {
    if (words_.size() == 3 && words_[1] == "ascii") {
      header_.encoding = PlyEncoding::kText;
    } else if (words_.size() == 3 && words_[1] == "binary_little_endian") {
      header_.encoding = PlyEncoding::kLittleEndian;
    } else if (words_.size() == 3 && words_[1] == "binary_big_endian") {
      header_.encoding = PlyEncoding::kBigEndian;
    } else {
      refuse("format, ascii, binary_little_endian or binary_big_endian, and 1.0");
    }
  }

  void read_element() {
    const auto rows = words_.size() == 3 ? parse_whole_number(words_[2]) : std::nullopt;
    if (!rows || *rows < 0) refuse("element NAME COUNT");
    if (header_.find(words_[1])) {
      throw InputError(path_, place(), "element " + std::string(words_[1]) + " twice", "it once");
    }
    header_.elements.push_back({std::string(words_[1]), static_cast<std::uint64_t>(*rows), {}});
  }

  void read_property() {
    if (header_.elements.empty()) refuse("an element before it");
    const bool list = words_.size() > 1 && words_[1] == "list";
    if (words_.size() != (list ? 5u : 3u)) refuse("property TYPE NAME or list TYPE TYPE NAME");
    PlyProperty property;
    property.name = words_.back();
    property.value = type_of(words_[words_.size() - 2]);
    if (list) {
      property.count = type_of(words_[2]);
      if (!is_whole(*property.count)) {
        throw InputError(path_, place(), "lists of " + std::string(words_[2]) + " lengths",
                         "whole numbers");
      }
    }
    PlyElement& element = header_.elements.back();
    if (element.find(property.name)) {
      throw InputError(path_, place(), "property " + property.name + " twice", "it once");
    }
    element.properties.push_back(std::move(property));
  }

  PlyNumber type_of(std::string_view name) const {
    const auto* const found =
        std::ranges::find(kTypes, name, [](const auto& t) { return t.first; });
    if (found != kTypes.end()) return found->second;
    throw InputError(path_, place(), "type \"" + std::string(name) + "\"", "a PLY type");
  }

  /// Against rows that the file cannot hold, before anybody takes memory for them.
  void check_lengths() const {
    std::uint64_t left = rest_.size() + 1;  // a text's last line may be without an end
    for (const PlyElement& element : header_.elements) {
      if (element.rows == 0) continue;
      std::uint64_t least = 0;  // bytes of a row
      for (const PlyProperty& property : element.properties) {
        const bool text = header_.encoding == PlyEncoding::kText;
        least += text ? 2 : bytes_of(property.count.value_or(property.value));
      }
      if (least == 0) {
        throw InputError(path_, "header", "element " + element.name + " without properties",
                         "at least one");
      }
      if (element.rows > left / least) {
        throw InputError(path_, "header",
                         std::to_string(element.rows) + " rows of element " + element.name +
                             " in a file of " + std::to_string(contents_.size()) + " bytes",
                         "no more than it can hold");
      }
      left -= element.rows * least;
    }
  }

  const std::string& path_;
  std::string_view contents_, rest_;
  char line_end_ = '\n';
  std::string line_;
  std::vector<std::string_view> words_;  // of line_
  PlyHeader header_;
};

}  // namespace

std::size_t bytes_of(PlyNumber type) {
  constexpr std::array<std::size_t, 8> kBytes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

bool is_whole(PlyNumber type) { return type != PlyNumber::kFloat && type != PlyNumber::kDouble; }

std::optional<std::size_t> PlyElement::find(std::string_view wanted) const {
  for (std::size_t p = 0; p < properties.size(); ++p) {
    if (properties[p].name == wanted) return p;
  }
  return std::nullopt;
}

const PlyElement* PlyHeader::find(std::string_view name) const {
  const auto found = std::ranges::find(elements, name, &PlyElement::name);
  return found == elements.end() ? nullptr : &*found;
}

PlyHeader read_ply_header(const std::string& path, std::string_view contents) {
  return PlyHeaderReader(path, contents).read();
}

}  // namespace sulcus
