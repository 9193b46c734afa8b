#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/import/meshes/mesh_builder.hpp"
#include "engine/import/meshes/mesh_readers.hpp"
#include "engine/import/meshes/mesh_text.hpp"

namespace sulcus {
namespace {

constexpr std::uint64_t kStlHeader = 84, kStlTriangle = 50;

bool is_solid_text(std::string_view head) {
  MeshText text(head);
  return lower_case(std::string(text.word()).substr(0, 5)) == "solid" &&
         head.find('\0') == head.npos;
}

/// Bytes behind the last counted triangle; one buffer's worth at most, or all.
void check_tail(const std::string& path, std::ifstream& in, std::uint64_t bytes) {
  if (bytes < kStlTriangle) return;
  std::array<char, 65536> tail{};
  in.read(tail.data(), tail.size());
  const std::string_view held(tail.data(), static_cast<std::size_t>(in.gcount()));
  const bool padding =
      bytes <= tail.size() && held.find_first_not_of(std::string_view("\0 \t\r\n", 5)) == held.npos;
  if (padding) return;
  throw InputError(path, "end", std::to_string(bytes) + " bytes behind the counted triangles",
                   "none: the count or the file is wrong");
}

TriangleMesh read_binary(const std::string& path, std::ifstream& in, std::uint32_t count,
                         std::uint64_t bytes) {
  in.clear();
  in.seekg(kStlHeader);
  MeshBuilder builder;
  std::vector<char> block(1000 * kStlTriangle);
  for (std::uint64_t done = 0; done < count;) {
    const std::uint64_t now = std::min<std::uint64_t>(count - done, 1000);
    in.read(block.data(), static_cast<std::streamsize>(now * kStlTriangle));
    if (static_cast<std::uint64_t>(in.gcount()) != now * kStlTriangle) {
      throw InputError(path, "triangle " + std::to_string(done), "the end of the file",
                       std::to_string(count) + " triangles");
    }
    for (std::uint64_t t = 0; t < now; ++t, ++done) {
      std::array<float, 9> corners;  // behind the normal; little endian, as every machine of ours
      std::memcpy(corners.data(), block.data() + t * kStlTriangle + 12, sizeof corners);
      std::array<std::uint32_t, 3> face;
      for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::Vector3d place_mm(corners[3 * c], corners[3 * c + 1], corners[3 * c + 2]);
        if (!MeshBuilder::is_usable(place_mm)) {
          throw MeshBuilder::unusable(path, "triangle " + std::to_string(done), place_mm);
        }
        face[c] = builder.vertex(place_mm);
      }
      builder.add_face(face);
    }
  }
  check_tail(path, in, bytes - kStlHeader - kStlTriangle * count);
  return std::move(builder).finish(path);
}

class StlTextReader {
 public:
  StlTextReader(const std::string& path, const InputLimits& limits, std::string_view text)
      : path_(path), limits_(limits), text_(text) {}

  TriangleMesh read() {
    while (next() == "solid") read_solid();
    if (!at_end_) refuse("solid, or the end of the file");
    return std::move(builder_).finish(path_);
  }

 private:
  /// The next word in lower case.
  const std::string& next() {
    found_ = text_.word();
    at_end_ = found_.empty();
    word_ = lower_case(std::string(found_));
    return word_;
  }
  [[noreturn]] void refuse(const std::string& expected) const {
    throw InputError(path_, text_.place(), text_.found(found_), expected);
  }
  /// Takes the rest of "endfacet", say, which may be two words.
  bool ends(const std::string& what) {
    if (word_ == "end" + what) return true;
    if (word_ != "end") return false;
    if (next() != what) refuse(what);
    return true;
  }

  void read_solid() {
    text_.skip_line();  // its name
    while (next() == "facet") read_facet();
    if (!ends("solid")) refuse("facet or endsolid");
    text_.skip_line();
  }

  void read_facet() {
    const std::string place = text_.place();
    if (next() == "normal") {
      for (int n = 0; n < 3; ++n) next();
      next();
    }
    if (word_ != "outer") refuse("outer loop");
    if (next() != "loop") refuse("loop");
    face_.clear();
    std::uint64_t corners = 0;
    while (next() == "vertex") {
      const std::uint32_t vertex = read_vertex();
      if (++corners <= MeshBuilder::kMaxCorners) face_.push_back(vertex);
    }
    if (!ends("loop")) refuse("vertex or endloop");
    next();
    if (!ends("facet")) refuse("endfacet");
    MeshBuilder::check_corners(path_, place, corners);
    triangles_ += corners - 2;
    MeshBuilder::check_triangles(path_, place, triangles_, limits_);
    builder_.add_face(face_);
  }

  std::uint32_t read_vertex() {
    Eigen::Vector3d place_mm;
    for (double& x : place_mm) {
      const auto number = parse_number(next());
      if (!number) refuse("a number");
      x = *number;
    }
    if (!MeshBuilder::is_usable(place_mm)) {
      throw MeshBuilder::unusable(path_, text_.place(), place_mm);
    }
    return builder_.vertex(place_mm);
  }

  const std::string& path_;
  const InputLimits& limits_;
  MeshText text_;
  std::string_view found_;
  std::string word_;
  bool at_end_ = false;
  MeshBuilder builder_;
  std::vector<std::uint32_t> face_;
  std::uint64_t triangles_ = 0;
};

}  // namespace

TriangleMesh read_stl(const std::string& path, const InputLimits& limits) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path, "", "no readable file", "a mesh");
  const std::uint64_t bytes = std::filesystem::file_size(path);
  std::array<char, 1024> begin{};
  in.read(begin.data(), begin.size());
  const auto held = static_cast<std::size_t>(in.gcount());
  std::uint32_t count = 0;
  if (held >= kStlHeader) std::memcpy(&count, begin.data() + 80, sizeof count);
  const std::uint64_t asked = kStlHeader + kStlTriangle * count;
  if (bytes != asked && is_solid_text({begin.data(), held})) {
    const std::string contents = read_mesh_bytes(path, limits);
    return StlTextReader(path, limits, contents).read();
  }
  if (held < kStlHeader) {
    throw InputError(path, "", std::to_string(bytes) + " bytes without \"solid\"",
                     "a text STL file, or at least 84 bytes of a binary one");
  }
  if (bytes < asked) {
    throw InputError(path, "triangle count",
                     std::to_string(count) + " in a file of " + std::to_string(bytes) + " bytes",
                     std::to_string(asked) + " bytes for them");
  }
  MeshBuilder::check_triangles(path, "triangle count", count, limits);
  return read_binary(path, in, count, bytes);
}

}  // namespace sulcus
