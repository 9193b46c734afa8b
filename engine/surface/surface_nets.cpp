#include "engine/surface/surface_nets.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "engine/volume/grid.hpp"

namespace sulcus {
namespace {

constexpr int kAxisBit[3] = {1, 2, 4};

/// The corner of a cell at the lower end of an edge.
constexpr int edge_corner(int edge) {
  const int axis = edge / 4;
  return (edge & 1) * kAxisBit[(axis + 1) % 3] + (edge >> 1 & 1) * kAxisBit[(axis + 2) % 3];
}

/// Edge of a cell between two neighbouring corners.
constexpr int edge_between(int a, int b) {
  const int difference = a ^ b;
  const int axis = difference == 1 ? 0 : difference == 2 ? 1 : 2;
  const int low = a & b;
  return 4 * axis + ((low & kAxisBit[(axis + 1) % 3]) != 0 ? 1 : 0) +
         ((low & kAxisBit[(axis + 2) % 3]) != 0 ? 2 : 0);
}

/// On a face whose corners alternate, two curves separate the inside corners from each other, or,
/// with `join`, the outside ones. Both cells at the face decide alike, so the mesh closes.
constexpr NetsCase make_case(int code, bool join) {
  int group[12] = {};
  bool crossed[12] = {};
  for (int e = 0; e < 12; ++e) {
    group[e] = e;
    const int low = edge_corner(e);
    crossed[e] = (code >> low & 1) != (code >> (low | kAxisBit[e / 4]) & 1);
  }
  auto unite = [&](int a, int b) {
    const int from = group[a];
    const int to = group[b];
    for (int& g : group) g = g == from ? to : g;
  };
  bool alternating[6] = {};
  int face_edges[6][4] = {};
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const int base = face % 2 * kAxisBit[axis];
    const int u = kAxisBit[(axis + 1) % 3];
    const int w = kAxisBit[(axis + 2) % 3];
    const int corner[4] = {base, base | u, base | u | w, base | w};
    int count = 0;
    int found[4] = {};
    for (int i = 0; i < 4; ++i) {
      face_edges[face][i] = edge_between(corner[i], corner[(i + 1) % 4]);
      if (crossed[face_edges[face][i]]) found[count++] = face_edges[face][i];
    }
    if (count == 2) unite(found[0], found[1]);
    if (count != 4) continue;
    alternating[face] = true;
    for (int i = 0; i < 4; ++i) {
      const bool inside = (code >> corner[i] & 1) != 0;
      if (inside != join) unite(face_edges[face][(i + 3) % 4], face_edges[face][i]);
    }
  }
  NetsCase result;
  int number[12] = {};
  for (int& n : number) n = -1;
  for (int e = 0; e < 12; ++e) {
    result.vertex_of_edge[e] = -1;
    if (!crossed[e]) continue;
    if (number[group[e]] < 0) number[group[e]] = result.vertices++;
    result.vertex_of_edge[e] = static_cast<std::int8_t>(number[group[e]]);
  }
  for (int face = 0; face < 6; ++face) {
    if (!alternating[face]) continue;
    bool same = true;
    for (int e : face_edges[face]) {
      same = same && result.vertex_of_edge[e] == result.vertex_of_edge[face_edges[face][0]];
    }
    if (same) result.pinched_face = static_cast<std::int8_t>(face);
  }
  return result;
}

constexpr std::array<std::array<NetsCase, 256>, 2> make_cases() {
  std::array<std::array<NetsCase, 256>, 2> cases{};
  for (int join = 0; join < 2; ++join) {
    for (int code = 0; code < 256; ++code) cases[join][code] = make_case(code, join != 0);
  }
  return cases;
}

constexpr std::array<std::array<NetsCase, 256>, 2> kCases = make_cases();

/// One block being meshed.
class BlockMesher {
 public:
  BlockMesher(const NetsBlock& block, float level, NetsScratch& scratch, NetsMesh& mesh)
      : block_(block),
        level_(level),
        scratch_(scratch),
        mesh_(mesh),
        step_{1, block.dims.x(), std::ptrdiff_t{block.dims.x()} * block.dims.y()} {}

  /// Finds the code of each cell whose corners lie in the block, those of the border among them:
  /// the rule for pinched faces looks there. What stands at the end of a row, where there is no
  /// cell, is never read. Says whether the surface may pass through any.
  bool find_codes() {
    const std::size_t count = block_.values.size();
    const auto row = static_cast<std::size_t>(step_[1]), slice = static_cast<std::size_t>(step_[2]);
    scratch_.codes.resize(count);
    const float* const values = block_.values.data();
    std::uint8_t* const codes = scratch_.codes.data();
    const float level = level_;
    std::uint8_t any = 0, all = 1;
    for (std::size_t i = 0; i < count; ++i) {
      codes[i] = values[i] > level ? 1 : 0;
      any |= codes[i];
      all &= codes[i];
    }
    if (any == all) return false;
    // In place: what a code is made of stands at it and behind it.
    for (std::size_t i = 0; i + slice + row + 1 < count; ++i) {
      const std::uint8_t* const low = codes + i;
      const std::uint8_t* const high = low + slice;
      codes[i] = static_cast<std::uint8_t>(low[0] | low[1] << 1 | low[row] << 2 |
                                           low[row + 1] << 3 | high[0] << 4 | high[1] << 5 |
                                           high[row] << 6 | high[row + 1] << 7);
    }
    return true;
  }

  void add_vertices() {
    scratch_.first_vertex.resize(block_.values.size());
    for_each_crossed(block_.begin - Cell::Ones(),
                     [&](const Cell& c, std::ptrdiff_t cell) { add_vertices_of(c, cell); });
  }

  void add_quads() {
    for_each_crossed(block_.begin, [&](const Cell&, std::ptrdiff_t cell) {
      const int code = scratch_.codes[cell];
      for (int axis = 0; axis < 3; ++axis) {
        const bool low_inside = (code & 1) != 0;
        if (low_inside != ((code >> kAxisBit[axis] & 1) != 0)) add_quad(cell, axis, low_inside);
      }
    });
  }

 private:
  std::ptrdiff_t offset_of(const Cell& c) const {
    return (c.x() - block_.first.x()) * step_[0] + (c.y() - block_.first.y()) * step_[1] +
           (c.z() - block_.first.z()) * step_[2];
  }

  /// Calls `visit(c, its offset)` for the cells from `first` to before the block's end that the
  /// surface passes through, x fastest.
  template <class Visit>
  void for_each_crossed(const Cell& first, const Visit& visit) const {
    constexpr int kAtOnce = sizeof(std::uint64_t);
    const int length = block_.end.x() - first.x();
    for (int z = first.z(); z < block_.end.z(); ++z) {
      for (int y = first.y(); y < block_.end.y(); ++y) {
        const std::ptrdiff_t row = offset_of({first.x(), y, z});
        const std::uint8_t* const codes = scratch_.codes.data() + row;
        for (int x = 0; x < length; ++x) {
          std::uint64_t next = 1;
          if (x + kAtOnce <= length) std::memcpy(&next, codes + x, sizeof next);
          if (next == 0 || next == ~std::uint64_t{0}) {
            x += kAtOnce - 1;
          } else if (codes[x] != 0 && codes[x] != 255) {
            visit(Cell(first.x() + x, y, z), row + x);
          }
        }
      }
    }
  }

  /// Where one curve crosses a face twice on both its sides, four quads would share a mesh edge.
  /// Joining instead of separating there splits the curves on both sides [Wenger 2013].
  const NetsCase& case_of(std::ptrdiff_t cell) const {
    const NetsCase& plain = kCases[0][scratch_.codes[cell]];
    if (plain.pinched_face < 0) return plain;
    const int axis = plain.pinched_face / 2;
    const int side = plain.pinched_face % 2;
    const std::ptrdiff_t beyond = cell + (side != 0 ? step_[axis] : -step_[axis]);
    const NetsCase& other = kCases[0][scratch_.codes[beyond]];
    return other.pinched_face == (plain.pinched_face ^ 1) ? kCases[1][scratch_.codes[cell]] : plain;
  }

  /// Each vertex is the mean of its curve's crossings with the cell's edges.
  void add_vertices_of(const Cell& c, std::ptrdiff_t cell) {
    const float* const values = block_.values.data();
    const NetsCase& shape = case_of(cell);
    Eigen::Vector3f sum[4];
    float crossings[4] = {};
    for (Eigen::Vector3f& s : sum) s.setZero();
    for (int e = 0; e < 12; ++e) {
      const int part = shape.vertex_of_edge[e];
      if (part < 0) continue;
      const int axis = e / 4;
      const int corner = edge_corner(e);
      const std::ptrdiff_t low = cell + (corner & 1) * step_[0] + (corner >> 1 & 1) * step_[1] +
                                 (corner >> 2 & 1) * step_[2];
      const float a = values[low];
      const float b = values[low + step_[axis]];
      Eigen::Vector3f p(static_cast<float>(corner & 1), static_cast<float>(corner >> 1 & 1),
                        static_cast<float>(corner >> 2 & 1));
      p[axis] = (level_ - a) / (b - a);
      sum[part] += p;
      crossings[part] += 1.0f;
    }
    scratch_.first_vertex[cell] = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (int part = 0; part < shape.vertices; ++part) {
      mesh_.vertices.push_back({c, static_cast<std::uint8_t>(part), sum[part] / crossings[part]});
    }
  }

  /// The quad round the edge of `cell` along an axis, through the four cells that share it.
  void add_quad(std::ptrdiff_t cell, int axis, bool low_inside) {
    const std::ptrdiff_t u = step_[(axis + 1) % 3];
    const std::ptrdiff_t w = step_[(axis + 2) % 3];
    const auto vertex = [&](int du, int dw) {
      const std::ptrdiff_t c = cell - du * u - dw * w;
      return scratch_.first_vertex[c] +
             static_cast<std::uint32_t>(case_of(c).vertex_of_edge[4 * axis + du + 2 * dw]);
    };
    std::array<std::uint32_t, 4> quad{vertex(1, 1), vertex(0, 1), vertex(0, 0), vertex(1, 0)};
    if (!low_inside) std::swap(quad[1], quad[3]);
    mesh_.quads.push_back(quad);
  }

  const NetsBlock& block_;
  float level_;
  NetsScratch& scratch_;
  NetsMesh& mesh_;
  std::ptrdiff_t step_[3];
};

}  // namespace

void surface_nets(const NetsBlock& block, float level, NetsScratch& scratch, NetsMesh& mesh) {
  mesh.vertices.clear();
  mesh.quads.clear();
  BlockMesher mesher(block, level, scratch, mesh);
  if (!mesher.find_codes()) return;
  mesher.add_vertices();
  mesher.add_quads();
}

std::array<std::array<std::uint32_t, 3>, 2> split_quad(const std::array<std::uint32_t, 4>& quad,
                                                       const Eigen::Vector3f& a,
                                                       const Eigen::Vector3f& b,
                                                       const Eigen::Vector3f& c,
                                                       const Eigen::Vector3f& d) {
  if ((a - c).squaredNorm() <= (b - d).squaredNorm()) {
    return {{{quad[0], quad[1], quad[2]}, {quad[0], quad[2], quad[3]}}};
  }
  return {{{quad[0], quad[1], quad[3]}, {quad[1], quad[2], quad[3]}}};
}

}  // namespace sulcus
