#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sulcus {

enum class PlyEncoding { kText, kLittleEndian, kBigEndian };
enum class PlyNumber { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::size_t bytes_of(PlyNumber type);
bool is_whole(PlyNumber type);

struct PlyProperty {
  std::string name;
  std::optional<PlyNumber> count;  // of a list
  PlyNumber value = PlyNumber::kFloat;
};

struct PlyElement {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<PlyProperty> properties;

  /// Where a property is; nothing where there is none of this name.
  std::optional<std::size_t> find(std::string_view name) const;
};

/// What a PLY file says of itself [Turk, The PLY Polygon File Format, 1994].
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;    // up to the first row
  std::uint64_t lines = 0;  // as many

  const PlyElement* find(std::string_view name) const;
};

/// Reads it, with types by their old and new names and comments wherever they please. All lines
/// end as the first one does, \n (with \r before it or not) or \r: of a binary file the byte behind
/// the header may be either.
/// @throws InputError: not a header, an element or property twice, rows of no property, more rows
/// than the file has bytes for.
PlyHeader read_ply_header(const std::string& path, std::string_view contents);

}  // namespace sulcus
