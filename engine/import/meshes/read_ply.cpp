#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/import/meshes/mesh_builder.hpp"
#include "engine/import/meshes/mesh_readers.hpp"
#include "engine/import/meshes/mesh_text.hpp"
#include "engine/import/meshes/ply_header.hpp"

namespace sulcus {
namespace {

/// Goes through the numbers after the header, one after another.
class PlyRows {
 public:
  PlyRows(std::string_view contents, const PlyHeader& header)
      : contents_(contents),
        at_(header.bytes),
        encoding_(header.encoding),
        text_(contents, header.bytes, header.lines + 1) {}

  /// To the first line of a text that holds anything.
  void begin_row() {
    if (is_text() && text_.at_line_end()) text_.next_line();
  }
  /// The next number of the row; nothing where there is none of its type.
  std::optional<double> next(PlyNumber type) {
    if (!is_text()) return next_binary(type);
    word_ = text_.word_of_line();
    if (!is_whole(type)) return parse_number(word_);
    const auto number = parse_whole_number(word_);
    return number ? std::optional(static_cast<double>(*number)) : std::nullopt;
  }
  /// Skips `count` numbers of one type.
  bool skip(PlyNumber type, std::uint64_t count) {
    if (is_text()) {
      for (; count > 0; --count) {
        word_ = text_.word_of_line();
        if (word_.empty()) return false;
      }
      return true;
    }
    const std::size_t each = bytes_of(type);
    if (count > (contents_.size() - at_) / each) return false;
    at_ += each * count;
    return true;
  }
  /// Whether the row ends here: a text's at the end of its line.
  bool end_row() {
    if (!is_text() || text_.at_line_end()) return true;
    word_ = text_.word_of_line();
    return false;
  }
  /// Whether nothing but padding is left.
  bool at_end() {
    if (is_text()) {
      if (text_.at_line_end() && !text_.next_line()) return true;
      word_ = text_.word_of_line();
      return false;
    }
    return contents_.find_first_not_of(std::string_view("\0 \t\r\n", 5), at_) == contents_.npos;
  }
  /// What is there instead of what was asked for last.
  std::string found() const {
    if (is_text()) return text_.found(word_);
    const std::size_t left = contents_.size() - at_;
    return left < 8 ? "the end of the file" : std::to_string(left) + " bytes";
  }

 private:
  bool is_text() const { return encoding_ == PlyEncoding::kText; }

  template <class T>
  double take() {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), contents_.data() + at_, sizeof(T));
    if ((encoding_ == PlyEncoding::kBigEndian) == (std::endian::native == std::endian::little)) {
      std::ranges::reverse(raw);
    }
    at_ += sizeof(T);
    return static_cast<double>(std::bit_cast<T>(raw));
  }
  std::optional<double> next_binary(PlyNumber type) {
    if (contents_.size() - at_ < bytes_of(type)) return std::nullopt;
    switch (type) {
      case PlyNumber::kInt8:
        return take<std::int8_t>();
      case PlyNumber::kUint8:
        return take<std::uint8_t>();
      case PlyNumber::kInt16:
        return take<std::int16_t>();
      case PlyNumber::kUint16:
        return take<std::uint16_t>();
      case PlyNumber::kInt32:
        return take<std::int32_t>();
      case PlyNumber::kUint32:
        return take<std::uint32_t>();
      case PlyNumber::kFloat:
        return take<float>();
      case PlyNumber::kDouble:
        return take<double>();
    }
    return std::nullopt;
  }

  std::string_view contents_;
  std::size_t at_;  // of a binary file
  PlyEncoding encoding_;
  MeshText text_;
  std::string_view word_;
};

class PlyReader {
 public:
  PlyReader(const std::string& path, const InputLimits& limits, std::string_view contents)
      : path_(path),
        limits_(limits),
        header_(read_ply_header(path, contents)),
        rows_(contents, header_) {}

  IndexedFaces read() {
    find_what_is_read();
    for (const PlyElement& element : header_.elements) read_rows(element);
    if (!rows_.at_end()) {
      throw InputError(path_, "end", rows_.found() + " behind the last row of the header",
                       "none: a count or the file is wrong");
    }
    return std::move(faces_);
  }

 private:
  void find_what_is_read() {
    const PlyElement* vertex = header_.find("vertex");
    if (!vertex) throw InputError(path_, "header", "no element vertex", "a mesh");
    vertices_ = vertex->rows;
    const std::uint64_t most = 3 * limits_.triangles();
    if (vertices_ > most) {
      throw InputError(path_, "header", std::to_string(vertices_) + " vertices",
                       "at most " + std::to_string(most) + " (--limit-gib)");
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto place = vertex->find(std::string_view("xyz").substr(axis, 1));
      if (!place || vertex->properties[*place].count) {
        throw InputError(path_, "header", "vertices without x, y and z", "a number for each");
      }
      place_property_[axis] = *place;
    }
    const PlyElement* face = header_.find("face");
    const PlyElement* strips = header_.find("tristrips");
    if (!face && !strips) throw InputError(path_, "header", "no element face", "a mesh");
    if (face) {
      MeshBuilder::check_triangles(path_, "header", face->rows, limits_);
      find_indices(*face);
    }
    if (strips) find_indices(*strips);
  }

  void find_indices(const PlyElement& element) const {
    const auto property = indices_of(element);
    if (!property || !element.properties[*property].count) {
      throw InputError(path_, "header", "element " + element.name + " without vertex_indices",
                       "a list of them");
    }
    if (!is_whole(element.properties[*property].value)) {
      throw InputError(path_, "header", "indices that are no whole numbers", "int or uint");
    }
  }

  static std::optional<std::size_t> indices_of(const PlyElement& element) {
    const auto property = element.find("vertex_indices");
    return property ? property : element.find("vertex_index");
  }

  void read_rows(const PlyElement& element) {
    constexpr std::size_t kNone = ~std::size_t{0};
    const bool vertex = element.name == "vertex", face = element.name == "face";
    const bool strip = element.name == "tristrips";
    const std::size_t indices = face || strip ? indices_of(element).value_or(kNone) : kNone;
    for (std::uint64_t row = 0; row < element.rows; ++row) {
      rows_.begin_row();
      if (vertex) faces_.places_mm.emplace_back();
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        const std::uint64_t count = property.count ? read_length(element, row, *property.count) : 1;
        const auto axis = std::ranges::find(place_property_, p) - place_property_.begin();
        if (vertex && axis < 3) {
          const auto number = rows_.next(property.value);
          if (!number) throw cut_short(element, row);
          faces_.places_mm.back()[axis] = *number;
        } else if (p == indices && face) {
          read_face(element, row, property.value, count);
        } else if (p == indices) {
          read_strip(element, row, property.value, count);
        } else if (!rows_.skip(property.value, count)) {
          throw cut_short(element, row);
        }
      }
      if (!rows_.end_row()) {
        throw InputError(path_, place(element, row), rows_.found(), "the end of the row");
      }
    }
  }

  static std::string place(const PlyElement& element, std::uint64_t row) {
    return element.name + " " + std::to_string(row);
  }
  InputError cut_short(const PlyElement& element, std::uint64_t row) const {
    return {path_, place(element, row), rows_.found(),
            std::to_string(element.rows) + " rows as the header says"};
  }

  std::uint64_t read_length(const PlyElement& element, std::uint64_t row, PlyNumber type) {
    const auto length = rows_.next(type);
    if (!length) throw cut_short(element, row);
    if (!(*length >= 0.0 && *length <= 4294967295.0)) {
      throw InputError(path_, place(element, row), std::to_string(*length) + " entries",
                       "a length of a list");
    }
    return static_cast<std::uint64_t>(*length);
  }

  void count_triangles(const PlyElement& element, std::uint64_t row, std::uint64_t more) {
    triangles_ += more;
    if (triangles_ <= limits_.triangles()) return;
    MeshBuilder::check_triangles(path_, place(element, row), triangles_, limits_);
  }

  std::int64_t read_index(const PlyElement& element, std::uint64_t row, PlyNumber type,
                          std::int64_t least) {
    const auto number = rows_.next(type);
    if (!number) throw cut_short(element, row);
    if (*number >= static_cast<double>(least) && *number < static_cast<double>(vertices_)) {
      return static_cast<std::int64_t>(*number);
    }
    std::string found = std::to_string(*number);
    throw InputError(path_, place(element, row), "vertex " + found.substr(0, found.find('.')),
                     "an index below " + std::to_string(vertices_));
  }

  void read_face(const PlyElement& element, std::uint64_t row, PlyNumber type,
                 std::uint64_t count) {
    if (count < 3 || count > MeshBuilder::kMaxCorners) {
      MeshBuilder::check_corners(path_, place(element, row), count);
    }
    count_triangles(element, row, count - 2);
    faces_.begin_face();
    for (std::uint64_t c = 0; c < count; ++c) {
      faces_.corners.push_back(static_cast<std::uint32_t>(read_index(element, row, type, 0)));
    }
  }

  /// Every corner from the third on makes a triangle with the two before it; every other one of
  /// them is turned round.
  void read_strip(const PlyElement& element, std::uint64_t row, PlyNumber type,
                  std::uint64_t count) {
    std::array<std::uint32_t, 2> before{};
    std::uint64_t held = 0;  // corners of the strip so far
    for (std::uint64_t c = 0; c < count; ++c) {
      const std::int64_t index = read_index(element, row, type, -1);
      if (index < 0) {
        held = 0;
        continue;
      }
      const auto corner = static_cast<std::uint32_t>(index);
      if (held >= 2) {
        count_triangles(element, row, 1);
        faces_.begin_face();
        const bool round = held % 2 == 1;
        faces_.corners.insert(faces_.corners.end(), {before[round], before[!round], corner});
      }
      before = {before[1], corner};
      ++held;
    }
  }

  const std::string& path_;
  const InputLimits& limits_;
  PlyHeader header_;
  PlyRows rows_;
  IndexedFaces faces_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
  std::array<std::size_t, 3> place_property_{};  // of x, y, z among those of a vertex
};

}  // namespace

TriangleMesh read_ply(const std::string& path, const InputLimits& limits) {
  const std::string contents = read_mesh_bytes(path, limits);
  return build_mesh(path, PlyReader(path, limits, contents).read());
}

}  // namespace sulcus
