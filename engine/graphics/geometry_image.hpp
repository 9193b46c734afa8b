#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sulcus {

/// What a pixel shows.
struct ShownObject {
  enum class Kind : std::uint8_t { kNothing, kBurr, kHandpiece, kSurface, kSectionFace, kPiece };
  Kind kind = Kind::kNothing;
  std::size_t index =
      0;  // of the body, 0 the workpiece; of the piece, in the order of their adding

  static ShownObject surface(std::size_t body) { return {Kind::kSurface, body}; }
  static ShownObject section_face(std::size_t body) { return {Kind::kSectionFace, body}; }
  static ShownObject piece(std::size_t piece) { return {Kind::kPiece, piece}; }
  /// As a number, above 0 but for nothing, and back. The index is below 2^24.
  int code() const { return static_cast<int>(kind) | static_cast<int>(index << 3); }
  static ShownObject of(std::uint32_t code) { return {Kind(code & 7u), code >> 3}; }
  bool operator==(const ShownObject&) const = default;
};

/// What a picture shows, and where: without light, with no pixel a mixture of several. A pixel is
/// what its middle meets. Rows from the top.
struct GeometryImage {
  int width = 0, height = 0;  // pixels
  // m, from the eye to the surface along the optical axis, not along the ray; 0 where nothing is.
  std::vector<float> depth_m;
  // Unit, outward, as the surface is shaded by: camera space, x right, y down, z into the picture;
  // zero where nothing is.
  std::vector<std::array<float, 3>> normal_camera;
  std::vector<std::uint32_t> objects;  // ShownObject::code

  ShownObject object(std::size_t pixel) const { return ShownObject::of(objects[pixel]); }
  bool operator==(const GeometryImage&) const = default;
};

}  // namespace sulcus
