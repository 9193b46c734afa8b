#include "engine/graphics/drawn_surface.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

namespace sulcus {
namespace {

// What the narrowest of the three normals of a vertex is taken from: cells of 2 voxels, blurred to
// a standard deviation of about 3. It keeps edges; the wide ones (WideDensity) take away the
// terraces that binary voxels make of gentle slopes. (Cells of 8 voxels would be cheaper, but their
// lattice shows.)
constexpr int kNearLevel = 1, kNearBlur = 4;
// Voxels from a voxel to the farthest vertex whose colour or cut it can change.
constexpr int kShapeReach = 6;
// The wider of two normals holds up to the first angle between them, the narrower one from the
// second on. Terraces tilt the narrow normal by up to 4 degrees; the change is drawn out, or they
// would show as one normal taking turns with the other.
struct Change {
  float cosine_wide, cosine_near;
};
constexpr Change kNearToMiddle{0.96f, 0.82f};    // 16 to 35 degrees
constexpr Change kMiddleToWide{0.995f, 0.966f};  // 6 to 15 degrees
// More triangles than this cost a software rasteriser more than 30 ms a frame.
constexpr double kTriangles = 0.6e6;

/// Exposed voxel faces inside leaves, scaled for those between leaves.
double estimated_faces(const VoxelModel& model) {
  constexpr std::uint64_t kNotLastColumn = 0x7F7F7F7F7F7F7F7Fu;
  std::uint64_t faces = 0;
  for (const LeafBits& leaf : model.leaves) {
    for (int k = 0; k < kLeafEdge; ++k) {
      const std::uint64_t w = leaf.words[k];
      if (w == 0 && (k == 7 || leaf.words[k + 1] == 0)) continue;
      faces += std::popcount((w ^ w >> 1) & kNotLastColumn);
      faces += std::popcount((w ^ w >> 8) & 0x00FFFFFFFFFFFFFFu);
      if (k < 7) faces += std::popcount(w ^ leaf.words[k + 1]);
    }
  }
  return static_cast<double>(faces) * 8.0 / 7.0;
}

/// Log2 of the edge in voxels of the finest cells of which a tooth draws fluently.
int fluent_level(const VoxelModel& model) {
  const double triangles = 2.0 * estimated_faces(model);
  return triangles <= kTriangles ? 0 : triangles / 4.0 <= kTriangles ? 1 : 2;
}

/// Rising, each once.
void sort_out(std::vector<std::uint32_t>& leaves) {
  std::sort(leaves.begin(), leaves.end());
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
}

/// A point of index space in the lattice of cells of 2^level voxels.
Eigen::Vector3f lattice_from_index(const Eigen::Vector3f& p_index, int level) {
  const float edge = static_cast<float>(1 << level);
  return (p_index + Eigen::Vector3f::Constant(0.5f)) / edge - Eigen::Vector3f::Constant(0.5f);
}
Eigen::Vector3f index_from_lattice(const Eigen::Vector3f& p_lattice, int level) {
  const float edge = static_cast<float>(1 << level);
  return (p_lattice + Eigen::Vector3f::Constant(0.5f)) * edge - Eigen::Vector3f::Constant(0.5f);
}

/// Samples a block that serves every point within `margin` voxels of [low, high) once it has been
/// blurred by `radius` in all.
void prepare(const VoxelModel& model, const Density& density, const Eigen::Vector3i& low,
             const Eigen::Vector3i& high, int margin, int level, int radius, DensityBlock& block) {
  const int edge = 1 << level;
  Eigen::Vector3i first;
  Eigen::Vector3i last;
  for (int a = 0; a < 3; ++a) {
    first[a] = (low[a] - margin) / edge - 3 - radius;  // 3: the quotient is rounded towards zero
    last[a] = (high[a] + margin) / edge + 3 + radius;
  }
  block.reshape(first, last - first + Eigen::Vector3i::Ones());
  density.sample(model, level, block);
}

Eigen::Vector3f blend(const Eigen::Vector3f& near, const Eigen::Vector3f& wide,
                      const Change& change) {
  const float t =
      std::clamp((near.dot(wide) - change.cosine_near) / (change.cosine_wide - change.cosine_near),
                 0.0f, 1.0f);
  const Eigen::Vector3f sum = near + t * t * (3.0f - 2.0f * t) * (wide - near);
  const float length = sum.norm();
  // No gradient at all in the very middle of a thin symmetrical part.
  return length > 1e-6f ? Eigen::Vector3f(sum / length) : Eigen::Vector3f::UnitZ();
}

Cell rounded(const Eigen::Vector3f& p) {
  return {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())),
          static_cast<int>(std::lround(p.z()))};
}

/// Linear RGB from light to dark, early to late; in between every step is darker than the one
/// before it, so that it reads in grey as well.
Eigen::Vector3f colour_of_time(float part) {
  static const std::array<Eigen::Vector3f, 5> kSteps{
      Eigen::Vector3f(0.96f, 0.90f, 0.30f), Eigen::Vector3f(0.90f, 0.47f, 0.10f),
      Eigen::Vector3f(0.62f, 0.10f, 0.15f), Eigen::Vector3f(0.25f, 0.02f, 0.25f),
      Eigen::Vector3f(0.03f, 0.01f, 0.12f)};
  const float at = std::clamp(part, 0.0f, 1.0f) * static_cast<float>(kSteps.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), kSteps.size() - 2);
  return kSteps[low] + (at - static_cast<float>(low)) * (kSteps[low + 1] - kSteps[low]);
}

}  // namespace

DrawnSurface::DrawnSurface(VoxelModel model, std::vector<TissueLook> looks, int cell_voxels,
                           LeafMap removed)
    : model_(std::move(model)),
      looks_(std::move(looks)),
      density_(model_),
      wide_(model_, density_),
      lattices_(lattices(model_, cell_voxels)),
      removed_(std::move(removed)) {
  if (looks_.empty()) throw std::invalid_argument("a drawn surface needs the look of a tissue");
}

std::array<DrawnSurface::Lattice, 2> DrawnSurface::lattices(const VoxelModel& model,
                                                            int cell_voxels) {
  const int level =
      cell_voxels != 0 ? std::countr_zero(static_cast<unsigned>(cell_voxels)) : fluent_level(model);
  return {Lattice(level, model.grid.cells), Lattice(level + 1, model.grid.cells)};
}

DrawnSurface::Lattice::Lattice(int cell_level, const Eigen::Vector3i& cells)
    : level(cell_level), brick_voxels(cell_level >= 2 ? 64 : 32) {
  bricks = (cells + Eigen::Vector3i::Constant(brick_voxels - 1)) / brick_voxels;
  changed.assign(bricks.prod(), kShape);
}

void DrawnSurface::remove(std::span<const std::uint32_t> voxels, double time_s) {
  change(voxels, false, static_cast<float>(time_s));
}

void DrawnSurface::restore(std::span<const std::uint32_t> voxels) { change(voxels, true, 0.0f); }

void DrawnSurface::change(std::span<const std::uint32_t> voxels, bool solid, float time_s) {
  std::vector<std::uint32_t> leaves;
  for (const std::uint32_t voxel : voxels) {
    const Cell c = model_.grid.cell_of_linear(voxel);
    if (solid ? !removed(c) : !model_.solid(c)) continue;
    model_.set(c, solid);
    const std::uint32_t leaf = model_.grid.leaf_of(c);
    removed_[leaf].words[leaf_word(c.z())] ^= std::uint64_t{1} << leaf_bit(c.x(), c.y());
    if (time_span_s_ > 0.0) {
      const int place = 64 * leaf_word(c.z()) + leaf_bit(c.x(), c.y());
      removed_at_s_[leaf][static_cast<std::size_t>(place)] = time_s;
    }
    if (leaves.empty() || leaf != leaves.back()) leaves.push_back(leaf);
    for (Lattice& l : lattices_) {
      // Vertices lie up to two cells beyond their brick.
      const int edge = 1 << l.level;
      l.mark(c, WideDensity::kReach + 2 * edge, kNormals);
      l.mark(c, kShapeReach + 4 * edge, kShape);
    }
  }
  sort_out(leaves);
  for (const std::uint32_t leaf : leaves) density_.update(model_, leaf);
  changed_leaves_.insert(changed_leaves_.end(), leaves.begin(), leaves.end());
  stale_leaves_.insert(stale_leaves_.end(), leaves.begin(), leaves.end());
}

void DrawnSurface::Lattice::mark(const Cell& c, int reach, Redraw redraw) {
  const Eigen::Vector3i low = (c - Cell::Constant(reach)).cwiseMax(0) / brick_voxels;
  const Eigen::Vector3i high =
      ((c + Cell::Constant(reach)) / brick_voxels).cwiseMin(bricks - Cell::Ones());
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        std::uint8_t& brick = changed[x + bricks.x() * (y + bricks.y() * z)];
        brick = std::max<std::uint8_t>(brick, redraw);
      }
    }
  }
}

std::vector<int> DrawnSurface::take_changed(std::size_t later, Detail detail) {
  sort_out(stale_leaves_);
  wide_.update(model_, density_, stale_leaves_);
  stale_leaves_.clear();
  Lattice& l = lattices_[static_cast<std::size_t>(detail)];
  std::vector<int> bricks;
  const std::size_t count = l.changed.size(), first = l.first_later;
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t b = (first + n) % count;
    if (l.changed[b] == kNone || (l.changed[b] == kNormals && later == 0)) continue;
    if (l.changed[b] == kNormals) {
      --later;
      l.first_later = (b + 1) % count;
    }
    bricks.push_back(static_cast<int>(b));
    l.changed[b] = kNone;
  }
  std::sort(bricks.begin(), bricks.end());
  return bricks;
}

std::vector<std::uint32_t> DrawnSurface::take_changed_leaves() {
  std::vector<std::uint32_t> leaves = std::exchange(changed_leaves_, {});
  sort_out(leaves);
  return leaves;
}

LeafBits DrawnSurface::solid_at_start(std::uint32_t leaf) const {
  LeafBits bits = model_.leaves[leaf];
  const auto found = removed_.find(leaf);
  if (found == removed_.end()) return bits;
  for (int k = 0; k < kLeafEdge; ++k) bits.words[k] |= found->second.words[k];
  return bits;
}

bool DrawnSurface::may_have_surface(const Eigen::Vector3i& low_voxel,
                                    const Eigen::Vector3i& high_voxel) const {
  const Eigen::Vector3i low = low_voxel.cwiseMax(0) / kLeafEdge;
  const Eigen::Vector3i high =
      (high_voxel.cwiseMin(model_.grid.cells) - Eigen::Vector3i::Ones()) / kLeafEdge;
  const bool at_border =
      (low_voxel.array() < 0).any() || (high_voxel.array() > model_.grid.cells.array()).any();
  bool empty = at_border;
  bool full = false;
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        for (std::uint64_t w : model_.leaves[model_.grid.leaf_of(Cell(x, y, z) * 8)].words) {
          empty = empty || w != ~std::uint64_t{0};
          full = full || w != 0;
        }
        if (empty && full) return true;
      }
    }
  }
  return false;
}

bool DrawnSurface::removed(const Cell& c) const {
  if (!model_.grid.contains(c)) return false;
  const auto found = removed_.find(model_.grid.leaf_of(c));
  return found != removed_.end() &&
         (found->second.words[leaf_word(c.z())] >> leaf_bit(c.x(), c.y()) & 1u) != 0;
}

float DrawnSurface::mean_time_s(const Eigen::Vector3f& p_index,
                                const Eigen::Vector3f& normal) const {
  const Cell outside = rounded(p_index + 1.5f * normal);
  float sum_s = 0.0f;
  int count = 0;
  for (int n = 0; n < 27; ++n) {
    const Cell c = outside + Cell(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1) * 2;
    if (!removed(c)) continue;
    const int place = 64 * leaf_word(c.z()) + leaf_bit(c.x(), c.y());
    sum_s += removed_at_s_.at(model_.grid.leaf_of(c))[static_cast<std::size_t>(place)];
    ++count;
  }
  return count > 0 ? sum_s / static_cast<float>(count) : 0.0f;
}

std::array<std::uint8_t, 4> DrawnSurface::colour_at(const Eigen::Vector3f& p_index,
                                                    const Eigen::Vector3f& normal,
                                                    bool was_cut) const {
  // Binomial weights over 27 voxels, 2 apart, round a point just inside: a border between tissues
  // is then as wide as the triangles and shows no teeth.
  Eigen::Vector3f colour = Eigen::Vector3f::Zero();
  float weight = 0.0f;
  auto add = [&](const Cell& c, float w) {
    const auto& look = looks_[std::min<std::size_t>(model_.tissue(c), looks_.size() - 1)];
    colour += w * Eigen::Vector3f(look.colour[0], look.colour[1], look.colour[2]);
    weight += w;
  };
  const Cell inside = rounded(p_index - 1.8f * normal);
  for (int n = 0; n < 27; ++n) {
    const Cell d(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    const Cell c = inside + 2 * d;
    if (model_.solid(c)) add(c, 1.0f / static_cast<float>(1 << d.cwiseAbs().sum()));
  }
  if (weight == 0.0f) add(inside.cwiseMax(0).cwiseMin(model_.grid.cells - Cell::Ones()), 1.0f);
  float cut = 0.0f;
  if (was_cut) {
    const Cell outside = rounded(p_index + 1.5f * normal);
    int empty = 0;
    int gone = 0;
    for (int n = 0; n < 27; ++n) {
      const Cell c = outside + Cell(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1) * 2;
      if (model_.solid(c)) continue;
      ++empty;
      gone += removed(c) ? 1 : 0;
    }
    if (empty > 0) cut = static_cast<float>(gone) / static_cast<float>(empty);
  }
  if (time_span_s_ > 0.0 && cut > 0.0f) {
    const float part = mean_time_s(p_index, normal) / static_cast<float>(time_span_s_);
    colour = (1.0f - cut) * colour / weight + cut * colour_of_time(part);
    weight = 1.0f;
  }
  std::array<std::uint8_t, 4> packed{};
  for (int i = 0; i < 3; ++i) {
    const float encoded = std::sqrt(std::clamp(colour[i] / weight, 0.0f, 1.0f));
    packed[i] = static_cast<std::uint8_t>(std::lround(255.0f * encoded));
  }
  packed[3] = static_cast<std::uint8_t>(std::lround(255.0f * cut));
  return packed;
}

void DrawnSurface::mesh(int brick, Scratch& scratch, DrawnMesh& out, Detail detail) const {
  out.vertices.clear();
  out.indices.clear();
  const auto& [level, brick_voxels, bricks, changed, first_later] = lattice(detail);
  const Eigen::Vector3i at(brick % bricks.x(), brick / bricks.x() % bricks.y(),
                           brick / bricks.x() / bricks.y());
  const Eigen::Vector3i low = at * brick_voxels;
  const Eigen::Vector3i high =
      (low + Eigen::Vector3i::Constant(brick_voxels)).cwiseMin(model_.grid.cells);
  const int edge = 1 << level;
  const int margin = 3 * edge;
  if (!may_have_surface(low - Eigen::Vector3i::Constant(margin),
                        high + Eigen::Vector3i::Constant(margin))) {
    return;
  }

  // The shape. The first brick along an axis also takes the lattice edges that enter the grid.
  constexpr int kShapeBlur = 1;
  NetsBlock& field = scratch.field;
  for (int a = 0; a < 3; ++a) {
    field.begin[a] = at[a] == 0 ? -1 : low[a] / edge;
    field.end[a] = high[a] / edge;
  }
  DensityBlock block;
  block.values.swap(field.values);
  block.reshape(field.begin - Eigen::Vector3i::Constant(2 + kShapeBlur),
                field.end - field.begin + Eigen::Vector3i::Constant(4 + 2 * kShapeBlur));
  density_.sample(model_, level, block);
  blur(block, kShapeBlur, scratch.blur);
  field.first = block.first;
  field.dims = block.dims;
  field.values.swap(block.values);
  surface_nets(field, 0.5f, scratch.nets, scratch.mesh);
  if (scratch.mesh.quads.empty()) return;

  prepare(model_, density_, low, high, 2 * edge, kNearLevel, kNearBlur, scratch.near);
  blur(scratch.near, kNearBlur, scratch.blur);
  bool was_cut = false;
  if (!removed_.empty()) {
    // As far as `colour_at` looks from a vertex beyond the brick.
    const Eigen::Vector3i far = Eigen::Vector3i::Constant(edge + 8);
    const Eigen::Vector3i from = (low - far).cwiseMax(0) / kLeafEdge;
    const Eigen::Vector3i to = (high + far).cwiseMin(model_.grid.cells - Cell::Ones()) / kLeafEdge;
    for (int z = from.z(); z <= to.z() && !was_cut; ++z) {
      for (int y = from.y(); y <= to.y() && !was_cut; ++y) {
        for (int x = from.x(); x <= to.x() && !was_cut; ++x) {
          was_cut = removed_.contains(model_.grid.leaf_of(Cell(x, y, z) * kLeafEdge));
        }
      }
    }
  }

  out.vertices.reserve(scratch.mesh.vertices.size());
  for (const NetsVertex& vertex : scratch.mesh.vertices) {
    const Eigen::Vector3f p_index =
        index_from_lattice(vertex.cell.cast<float>() + vertex.offset, level);
    // Outward: down the density.
    const WideDensity::Gradients far = wide_.gradients(p_index);
    const Eigen::Vector3f wide =
        blend(-far.middle.stableNormalized(), -far.wide.stableNormalized(), kMiddleToWide);
    const DensityAt near = spline(scratch.near, lattice_from_index(p_index, kNearLevel));
    const Eigen::Vector3f normal = blend(-near.gradient.stableNormalized(), wide, kNearToMiddle);
    const Eigen::Vector3d p_world = model_.grid.world_from_index(p_index.cast<double>());
    DrawnVertex drawn{};
    for (int a = 0; a < 3; ++a) {
      drawn.position_m[a] = static_cast<float>(p_world[a]);
      drawn.normal[a] = static_cast<std::int16_t>(std::lround(32767.0f * normal[a]));
    }
    drawn.colour_cut = colour_at(p_index, normal, was_cut);
    out.vertices.push_back(drawn);
  }
  out.indices.reserve(6 * scratch.mesh.quads.size());
  for (const auto& quad : scratch.mesh.quads) {
    Eigen::Vector3f p[4];
    for (int i = 0; i < 4; ++i) {
      const NetsVertex& vertex = scratch.mesh.vertices[quad[i]];
      p[i] = vertex.cell.cast<float>() + vertex.offset;
    }
    for (const auto& triangle : split_quad(quad, p[0], p[1], p[2], p[3])) {
      out.indices.insert(out.indices.end(), triangle.begin(), triangle.end());
    }
  }
}

std::size_t DrawnSurface::memory_bytes() const {
  return model_.leaves.capacity() * sizeof(LeafBits) + density_.memory_bytes() +
         wide_.memory_bytes() + removed_.size() * (sizeof(LeafBits) + 3 * sizeof(void*));
}

std::vector<Eigen::AlignedBox3d> solid_slabs(const VoxelModel& model) {
  std::vector<Eigen::AlignedBox3d> slabs;
  const Eigen::Vector3i leaves = model.grid.leaf_dims();
  const std::uint32_t plane = static_cast<std::uint32_t>(leaves.x() * leaves.y());
  for (int k = 0; k < leaves.z(); ++k) {
    Eigen::AlignedBox3d slab;
    for (std::uint32_t l = 0; l < plane; ++l) {
      const std::uint32_t leaf = l + plane * static_cast<std::uint32_t>(k);
      const Cell origin = model.grid.leaf_origin(leaf);
      std::uint64_t any = 0;  // over z: the slab is as thick as a leaf
      for (std::uint64_t word : model.leaves[leaf].words) any |= word;
      for (std::uint64_t rest = any; rest != 0; rest &= rest - 1) {
        const int bit = std::countr_zero(rest);
        const Eigen::Vector3d low =
            (origin + Cell(bit & 7, bit >> 3, 0)).cast<double>() - Eigen::Vector3d::Constant(0.5);
        slab.extend(model.grid.world_from_index(low));
        slab.extend(model.grid.world_from_index(low + Eigen::Vector3d(1, 1, kLeafEdge)));
      }
    }
    if (!slab.isEmpty()) slabs.push_back(slab);
  }
  return slabs;
}

}  // namespace sulcus
