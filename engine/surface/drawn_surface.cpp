#include "engine/surface/drawn_surface.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

#include "engine/surface/column_surface.hpp"

namespace sulcus {
namespace {

// What the narrowest of the three normals of a vertex is taken from: cells of 2 voxels, blurred to
// a standard deviation of about 3. It keeps edges; the wide ones (WideDensity) take away the
// terraces that binary voxels make of gentle slopes. (Cells of 8 voxels would be cheaper, but their
// lattice shows.)
constexpr int kNearLevel = 1, kNearBlur = 4;
// Voxels from a voxel to the farthest point whose narrow normal it can change: the blur, 1.5 cells
// of spline, and half a cell.
constexpr int kNearReach = (kNearBlur + 2) << kNearLevel;
// Voxels from a voxel to the farthest vertex whose colour or cut it can change.
constexpr int kShapeReach = 6;
static_assert(kColumnReach <= kShapeReach);
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

void append_triangles(const NetsMesh& mesh, std::vector<std::uint32_t>& indices) {
  indices.reserve(6 * mesh.quads.size());
  for (const auto& quad : mesh.quads) {
    Eigen::Vector3f p[4];
    for (int i = 0; i < 4; ++i) {
      const NetsVertex& vertex = mesh.vertices[quad[i]];
      p[i] = vertex.cell.cast<float>() + vertex.offset;
    }
    for (const auto& triangle : split_quad(quad, p[0], p[1], p[2], p[3])) {
      indices.insert(indices.end(), triangle.begin(), triangle.end());
    }
  }
}

}  // namespace

DrawnSurface::DrawnSurface(VoxelModel model, std::vector<TissueLook> looks, int cell_voxels,
                           LeafMap removed)
    : model_(std::move(model)),
      colour_(std::move(looks)),
      density_(model_),
      wide_(model_.fills ? std::nullopt
                         : std::optional<WideDensity>(std::in_place, model_, density_)),
      lattices_(lattices(model_, cell_voxels)),
      removed_(std::move(removed)) {}

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
  change(voxels, Occupancy::kEmpty, static_cast<float>(time_s));
}

void DrawnSurface::restore(std::span<const std::uint32_t> voxels) {
  change(voxels, Occupancy::kSolid, 0.0f);
}

void DrawnSurface::change(std::span<const std::uint32_t> voxels, Occupancy now, float time_s) {
  std::vector<std::uint32_t> leaves;
  for (const std::uint32_t voxel : voxels) {
    const Cell c = model_.grid.cell_of_linear(voxel);
    if (!change(c, now, time_s)) continue;
    const std::uint32_t leaf = model_.grid.leaf_of(c);
    if (leaves.empty() || leaf != leaves.back()) leaves.push_back(leaf);
    mark_changed(c);
  }
  take_in(std::move(leaves));
}

void DrawnSurface::set_levels(std::span<const VoxelLevel> levels, double time_s) {
  std::vector<std::uint32_t> leaves;
  for (const auto& [voxel, level] : levels) {
    const Cell c = model_.grid.cell_of_linear(voxel);
    const Occupancy now = level == 0 ? Occupancy::kEmpty : Occupancy::kSolid;
    const bool turned = change(c, now, static_cast<float>(time_s));
    const bool filled = level != 0 && fill(c, level);
    if (!turned && !filled) continue;
    const std::uint32_t leaf = model_.grid.leaf_of(c);
    if (leaves.empty() || leaf != leaves.back()) leaves.push_back(leaf);
    mark_changed(c);
  }
  take_in(std::move(leaves));
}

/// Removes a voxel or takes that back; false where there is nothing to do. Its level stays, for
/// when it comes back and for the piece that it is of.
bool DrawnSurface::change(const Cell& c, Occupancy now, float time_s) {
  const bool solid = now == Occupancy::kSolid;
  if (solid ? !contains(removed_, model_.grid, c) : !model_.solid(c)) return false;
  model_.set(c, solid);
  const std::uint32_t leaf = model_.grid.leaf_of(c);
  solid ? removed_[leaf].reset(leaf_place(c)) : removed_[leaf].set(leaf_place(c));
  colour_.note_removed(model_.grid, c, time_s);
  return true;
}

/// Gives a solid voxel a level, above 0; false where it has that already, or is not solid.
bool DrawnSurface::fill(const Cell& c, FillLevel level) {
  if (!model_.fills || !model_.solid(c) || model_.level(c) == level) return false;
  const std::uint32_t leaf = model_.grid.leaf_of(c);
  if (!model_.fills->has_room()) {
    model_.fills->reserve(64 + static_cast<std::uint32_t>(model_.fills->pages().size()) / 2);
  }
  // Those that are gone from a leaf without levels were full.
  model_.fills->set(leaf, leaf_place(c), level, solid_at_start(leaf));
  return true;
}

FillLevel DrawnSurface::last_level(const Cell& c) const {
  return model_.fills ? model_.fills->level(model_.grid.leaf_of(c), leaf_place(c)) : kFullLevel;
}

void DrawnSurface::mark_changed(const Cell& c) {
  for (Lattice& l : lattices_) {
    // Vertices lie up to two cells beyond their brick.
    const int edge = 1 << l.level;
    // To where columns have the surface a vertex goes by less than a cell.
    const int moved = model_.fills ? edge : 0;
    const int lit = wide_ ? WideDensity::kReach : kNearReach + moved;
    l.mark(c, lit + 2 * edge, kNormals);
    l.mark(c, kShapeReach + moved + 4 * edge, kShape);
  }
}

/// After the voxels of these leaves have changed.
void DrawnSurface::take_in(std::vector<std::uint32_t> leaves) {
  sort_out(leaves);
  for (const std::uint32_t leaf : leaves) density_.update(model_, leaf);
  changed_leaves_.insert(changed_leaves_.end(), leaves.begin(), leaves.end());
  stale_leaves_.insert(stale_leaves_.end(), leaves.begin(), leaves.end());
}

void DrawnSurface::colour_by_tissue() {
  if (!colour_.scale()) return;
  for (Lattice& l : lattices_) std::ranges::fill(l.changed, kShape);
  colour_.by_tissue();
}

void DrawnSurface::colour_by_values(const ColourScale& scale, VoxelValues values) {
  const bool all = !colour_.values() || colour_.scale() != scale;
  if (all) {
    for (Lattice& l : lattices_) std::ranges::fill(l.changed, kShape);
  } else {
    const auto mark_others = [this](const VoxelValues& these, const VoxelValues& those) {
      for (const auto& [leaf, block] : these.blocks()) {
        const auto other = those.blocks().find(leaf);
        if (other != those.blocks().end() &&
            std::memcmp(&block, &other->second, sizeof(block)) == 0) {
          continue;
        }
        const Cell middle = model_.grid.leaf_origin(leaf) + Cell::Constant(kLeafEdge / 2);
        for (Lattice& l : lattices_) {
          l.mark(middle, kLeafEdge / 2 + kShapeReach + 4 * (1 << l.level), kShape);
        }
      }
    };
    mark_others(values, *colour_.values());
    mark_others(*colour_.values(), values);
  }
  colour_.by_values(scale, std::move(values));
}

void DrawnSurface::Lattice::mark(const Cell& c, int reach, Redraw redraw) {
  const Eigen::Vector3i low = (c - Cell::Constant(reach)).cwiseMax(0) / brick_voxels;
  const Eigen::Vector3i high =
      ((c + Cell::Constant(reach)) / brick_voxels).cwiseMin(bricks - Cell::Ones());
  for_each_cell(low, high + Cell::Ones(), [&](const Cell& at) {
    std::uint8_t& brick = changed[at.x() + bricks.x() * (at.y() + bricks.y() * at.z())];
    brick = std::max<std::uint8_t>(brick, redraw);
  });
}

std::vector<int> DrawnSurface::take_changed(std::size_t later, Detail detail) {
  sort_out(stale_leaves_);
  if (wide_) wide_->update(model_, density_, stale_leaves_);
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
  return bits |= found->second;
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
  return any_cell(low, high + Cell::Ones(), [&](const Cell& at) {
    const std::uint32_t leaf = model_.grid.leaf_of(at * kLeafEdge);
    if (model_.fills && model_.fills->page(leaf)) return true;
    for (const std::uint64_t w : model_.leaves[leaf].words) {
      empty = empty || w != ~std::uint64_t{0};
      full = full || w != 0;
    }
    return empty && full;
  });
}

bool DrawnSurface::has_removals(const Eigen::Vector3i& low_voxel,
                                const Eigen::Vector3i& high_voxel) const {
  if (removed_.empty()) return false;
  const Cell low = low_voxel.cwiseMax(0) / kLeafEdge;
  const Cell high = high_voxel.cwiseMin(model_.grid.cells - Cell::Ones()) / kLeafEdge;
  return any_cell(low, high + Cell::Ones(), [&](const Cell& at) {
    return removed_.contains(model_.grid.leaf_of(at * kLeafEdge));
  });
}

void DrawnSurface::mesh(int brick, Scratch& scratch, DrawnMesh& out, Detail detail) const {
  out.vertices.clear();
  out.indices.clear();
  const BrickPlace place = place_of(brick, detail);
  const Cell margin = Cell::Constant(3 * place.edge());
  if (!may_have_surface(place.low - margin, place.high + margin)) return;
  mesh_shape(place, scratch);
  if (scratch.mesh.quads.empty()) return;
  prepare(model_, density_, place.low, place.high, 2 * place.edge(), kNearLevel, kNearBlur,
          scratch.near);
  blur(scratch.near, kNearBlur, scratch.blur);
  // As far as its colour looks from a vertex beyond the brick.
  const Cell far = Cell::Constant(place.edge() + 8);
  const bool was_cut = has_removals(place.low - far, place.high + far);
  out.vertices.reserve(scratch.mesh.vertices.size());
  for (const NetsVertex& vertex : scratch.mesh.vertices) {
    const Eigen::Vector3f p_index =
        index_from_lattice(vertex.cell.cast<float>() + vertex.offset, place.level);
    out.vertices.push_back(drawn_vertex(p_index, scratch.near, was_cut));
  }
  append_triangles(scratch.mesh, out.indices);
}

DrawnSurface::BrickPlace DrawnSurface::place_of(int brick, Detail detail) const {
  const Lattice& l = lattice(detail);
  BrickPlace place;
  place.level = l.level;
  place.at = Cell(brick % l.bricks.x(), brick / l.bricks.x() % l.bricks.y(),
                  brick / l.bricks.x() / l.bricks.y());
  place.low = place.at * l.brick_voxels;
  place.high = (place.low + Cell::Constant(l.brick_voxels)).cwiseMin(model_.grid.cells);
  return place;
}

void DrawnSurface::mesh_shape(const BrickPlace& place, Scratch& scratch) const {
  // Fractions have no staircase to blur, and keep their edges.
  const int shape_blur = model_.fills ? 0 : 1;
  NetsBlock& field = scratch.field;
  for (int a = 0; a < 3; ++a) {
    // The first brick along an axis also takes the lattice edges that enter the grid.
    field.begin[a] = place.at[a] == 0 ? -1 : place.low[a] / place.edge();
    field.end[a] = place.high[a] / place.edge();
  }
  DensityBlock block;
  block.values.swap(field.values);
  block.reshape(field.begin - Eigen::Vector3i::Constant(2 + shape_blur),
                field.end - field.begin + Eigen::Vector3i::Constant(4 + 2 * shape_blur));
  density_.sample(model_, place.level, block);
  if (shape_blur > 0) blur(block, shape_blur, scratch.blur);
  field.first = block.first;
  field.dims = block.dims;
  field.values.swap(block.values);
  surface_nets(field, 0.5f, scratch.nets, scratch.mesh);
  if (model_.fills) move_to_columns(model_, place.level, field, scratch.mesh);
}

DrawnVertex DrawnSurface::drawn_vertex(const Eigen::Vector3f& p_index, const DensityBlock& near,
                                       bool was_cut) const {
  // Outward: down the density.
  const DensityAt at = spline(near, lattice_from_index(p_index, kNearLevel));
  Eigen::Vector3f normal = -at.gradient.stableNormalized();
  if (wide_) {
    const WideDensity::Gradients far = wide_->gradients(p_index);
    const Eigen::Vector3f wide =
        blend(-far.middle.stableNormalized(), -far.wide.stableNormalized(), kMiddleToWide);
    normal = blend(normal, wide, kNearToMiddle);
  } else if (normal.isZero()) {
    normal = Eigen::Vector3f::UnitZ();  // in the very middle of a thin symmetrical part
  }
  const Eigen::Vector3d p_world = model_.grid.world_from_index(p_index.cast<double>());
  DrawnVertex drawn{};
  for (int a = 0; a < 3; ++a) {
    drawn.position_m[a] = static_cast<float>(p_world[a]);
    drawn.normal[a] = static_cast<std::int16_t>(std::lround(32767.0f * normal[a]));
  }
  const SurfaceColour::Seen seen = colour_.at(model_, removed_, p_index, normal, was_cut);
  drawn.colour_cut = seen.colour_cut;
  drawn.normal[3] = seen.unlit ? std::int16_t{32767} : std::int16_t{0};
  return drawn;
}

std::size_t DrawnSurface::memory_bytes() const {
  return model_.leaves.bytes() + (model_.fills ? model_.fills->memory_bytes() : 0) +
         density_.memory_bytes() + (wide_ ? wide_->memory_bytes() : 0) +
         lattices_[0].changed.capacity() + lattices_[1].changed.capacity() +
         removed_.size() * (sizeof(LeafBits) + 3 * sizeof(void*));
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
