#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/import/meshes/mesh_builder.hpp"
#include "engine/import/meshes/mesh_readers.hpp"
#include "engine/import/meshes/mesh_text.hpp"

namespace sulcus {
namespace {

// Of Wavefront's specification, version 3.0, with what it supersedes.
constexpr auto kNoSurface = std::to_array<std::string_view>(
    {"vn",   "vt",       "vp",     "p",          "l",        "o",     "g",     "s",
     "mg",   "usemtl",   "mtllib", "usemap",     "maplib",   "bevel", "lod",   "c_interp",
     "trim", "d_interp", "cstype", "deg",        "bmat",     "step",  "curv",  "curv2",
     "parm", "hole",     "scrv",   "sp",         "end",      "con",   "ctech", "stech",
     "res",  "cdc",      "bzc",    "shadow_obj", "trace_obj"});
constexpr auto kUnreadSurface =
    std::to_array<std::string_view>({"surf", "bsp", "bzp", "cdp", "call", "csh"});

class ObjReader {
 public:
  ObjReader(const std::string& path, const InputLimits& limits, std::string_view text)
      : path_(path), limits_(limits), text_(text) {}

  IndexedFaces read() {
    for (bool more = !text_.at_line_end() || text_.next_line(); more; more = text_.next_line()) {
      place_ = text_.place();
      read_statement();
    }
    if (highest_ >= static_cast<std::int64_t>(faces_.places_mm.size())) {
      throw InputError(path_, highest_place_, "vertex " + std::to_string(highest_ + 1),
                       at_most_count());
    }
    return std::move(faces_);
  }

 private:
  /// The next word of the statement, without comments; empty at its end.
  std::string_view word() {
    for (;;) {
      std::string_view word = text_.word_of_line();
      if (const auto comment = word.find('#'); comment != word.npos) {
        text_.skip_line();
        return word.substr(0, comment);
      }
      if (!word.ends_with('\\') || !text_.at_line_end()) return word;
      word.remove_suffix(1);
      if (!text_.end_line() || !word.empty()) return word;
    }
  }

  void read_statement() {
    const std::string_view kind = word();
    if (kind.empty()) return;
    if (kind == "v") {
      read_vertex();
    } else if (kind == "f" || kind == "fo") {  // fo: its older name
      read_face();
    } else if (std::ranges::find(kNoSurface, kind) != kNoSurface.end()) {
      while (!word().empty()) {
      }
    } else if (std::ranges::find(kUnreadSurface, kind) != kUnreadSurface.end()) {
      throw InputError(path_, place_, "'" + std::string(kind) + "'", "a surface of polygons (f)");
    } else {
      throw InputError(path_, place_, "'" + std::string(kind) + "'", "a statement of OBJ");
    }
  }

  void read_vertex() {
    numbers_.clear();
    for (std::string_view next = word(); !next.empty(); next = word()) {
      const std::optional<double> number = parse_number(next);
      if (!number || numbers_.size() == 8) {
        throw InputError(path_, place_, text_.found(next),
                         number ? "8 numbers at most" : "a number");
      }
      numbers_.push_back(*number);
    }
    // x y z, w or not, and no colour, a grey one or red, green, blue, with alpha or not.
    const std::size_t count = numbers_.size();
    if (count != 3 && count != 4 && count < 6) {
      throw InputError(path_, place_, "a vertex of " + std::to_string(count) + " numbers",
                       "3, or 4 to 8 with a weight and a colour");
    }
    if (count == 4 && numbers_[3] != 1.0) {
      throw InputError(path_, place_, "a weight of " + std::to_string(numbers_[3]),
                       "1, or none: it has no meaning for polygons");
    }
    const Eigen::Vector3d place_mm(numbers_[0], numbers_[1], numbers_[2]);
    if (!MeshBuilder::is_usable(place_mm)) throw MeshBuilder::unusable(path_, place_, place_mm);
    const std::uint64_t most =
        std::min<std::uint64_t>(3 * limits_.triangles(), std::numeric_limits<std::int32_t>::max());
    if (faces_.places_mm.size() == most) {
      throw InputError(path_, place_, "more than " + std::to_string(most) + " vertices",
                       "fewer (--limit-gib)");
    }
    faces_.places_mm.push_back(place_mm);
  }

  void read_face() {
    faces_.begin_face();
    std::uint64_t corners = 0;
    for (std::string_view next = word(); !next.empty(); next = word()) {
      if (++corners <= MeshBuilder::kMaxCorners) faces_.corners.push_back(read_corner(next));
    }
    MeshBuilder::check_corners(path_, place_, corners);
    triangles_ += corners - 2;
    MeshBuilder::check_triangles(path_, place_, triangles_, limits_);
  }

  /// The vertex of v, v/vt, v//vn or v/vt/vn.
  std::uint32_t read_corner(std::string_view word) {
    const std::string_view vertex = word.substr(0, word.find('/'));
    const std::optional<std::int64_t> number = parse_whole_number(vertex);
    if (!number || !are_indices(word.substr(vertex.size()))) {
      throw InputError(path_, place_, text_.found(word), "a corner: v, v/vt, v//vn or v/vt/vn");
    }
    const auto count = static_cast<std::int64_t>(faces_.places_mm.size());
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
    if (*number == 0 || *number < -count || *number > kMost) {
      throw InputError(path_, place_, "vertex " + std::to_string(*number), at_most_count());
    }
    const std::int64_t index = *number > 0 ? *number - 1 : count + *number;
    if (index > highest_) {  // it may still come
      highest_ = index;
      highest_place_ = place_;
    }
    return static_cast<std::uint32_t>(index);
  }

  /// Of a texture and a normal, each of which may be absent.
  static bool are_indices(std::string_view rest) {
    for (int index = 0; index < 2 && rest.starts_with('/'); ++index) {
      rest.remove_prefix(1);
      const std::string_view number = rest.substr(0, rest.find('/'));
      if (!number.empty() && !parse_whole_number(number)) return false;
      rest.remove_prefix(number.size());
    }
    return rest.empty();
  }

  std::string at_most_count() const {
    const std::string count = std::to_string(faces_.places_mm.size());
    return "1 to " + count + " or -1 to -" + count;
  }

  const std::string& path_;
  const InputLimits& limits_;
  MeshText text_;
  std::string place_;  // of the statement
  IndexedFaces faces_;
  std::vector<double> numbers_;
  std::uint64_t triangles_ = 0;
  std::int64_t highest_ = -1;  // index of a vertex
  std::string highest_place_;
};

}  // namespace

TriangleMesh read_obj(const std::string& path, const InputLimits& limits) {
  const std::string contents = read_mesh_bytes(path, limits);
  return build_mesh(path, ObjReader(path, limits, contents).read());
}

}  // namespace sulcus
